use anyhow::{Result, bail};
use evigrid_core::View;
use evigrid_grid::{Layer, LogOddsGrid, MapError, MapperFamily};
use evigrid_methods::Family;
use evigrid_results::{MapFile, RunResult};

use crate::pass::{Entrant, Order, Pass};
use crate::{Clock, Plan};

/// Scores a map that somebody else's mapper made, against the truth of the plan's frames. Also returned: how
/// many voxels of the file lie outside the grid (they are not scored).
///
/// # Errors
/// If the map does not lie on the plan's grid, a frame cannot be read, or there is no truth at all.
pub fn score_map_file(
    plan: &Plan,
    map: &MapFile,
    name: &str,
    clock: &dyn Clock,
) -> Result<(RunResult, usize)> {
    let (grid, outside) = map.onto_grid(&plan.job.info.spec)?;
    let family = Family { members: vec![0], mapper: Box::new(Ended(grid)) };
    let entrant = Entrant { job: &plan.job, method: 0 };
    let mut pass = Pass::ended(&plan.recording, entrant, family)?;
    pass.drive(&plan.recording, clock, Order::SideBySide, &mut |_, _| Ok(()))?;
    if pass.truth(0).voxels().is_none() {
        bail!("{}: expected laser scans to score against, found none", plan.job.info.dataset);
    }
    let mut method = pass.method_result(0, &pass.layers(0));
    name.clone_into(&mut method.method);
    Ok((pass.run_result(0, vec![method]), outside))
}

/// A mapper that has already ended: no frame changes its map.
struct Ended(LogOddsGrid);

impl MapperFamily for Ended {
    fn integrate(&mut self, _: &View<'_>) -> Result<(), MapError> {
        Ok(())
    }

    fn layers(&self, _: usize) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.0)]
    }
}
