use anyhow::{Context, Result};

use crate::ground_truth::GroundTruth;
use crate::prefetch::read_ahead;
use crate::{Clock, MapFile, MethodResult, Plan};

/// Scores a map that somebody else's mapper made, against the laser scans of the plan's frames. Also returned: how
/// many voxels of the file lie outside the grid (they are not scored), and the frames without a scan.
///
/// # Errors
/// If the map does not lie on the plan's grid, a frame cannot be read, or there is no laser scan at all.
pub fn score_map_file(
    plan: &Plan,
    map: &MapFile,
    name: &str,
    clock: &dyn Clock,
) -> Result<(MethodResult, usize, Vec<usize>)> {
    let (grid, outside) = map.onto_grid(&plan.info.spec)?;
    let mut truth = GroundTruth::new(plan.info.spec, plan.info.config.truth)?;
    std::thread::scope(|scope| -> Result<()> {
        let frames = read_ahead(scope, plan.sequence.as_ref(), &plan.info.frames, plan.map_from_world, clock);
        for read in frames {
            truth.add(&read?.0);
        }
        Ok(())
    })?;
    let reference = truth.reference().with_context(|| {
        format!("{}: expected laser scans to score against, found none", plan.info.dataset)
    })?;
    let tolerances = &plan.info.config.score.tolerances_m;
    let result = MethodResult::of(name, &grid, Some(&reference), tolerances);
    Ok((result, outside, truth.without_laser().to_vec()))
}
