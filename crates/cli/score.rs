use std::path::Path;

use anyhow::{Result, bail};
use evigrid_eval::{Plan, RealClock, score_map_file};
use evigrid_grid::LayerKind;
use evigrid_metrics::{SafetyCase, SafetyReference, Scores};
use evigrid_results::{
    MethodResult, check_same_cells, is_label_file, markdown_summary, markdown_table, read_labels, read_map,
};

use crate::args::ScoreArgs;
use crate::output::print;

/// `evigrid score`.
pub fn score(args: &ScoreArgs) -> Result<()> {
    if let Some(truth) = &args.truth {
        return score_labels(&args.map, truth);
    }
    let input = &args.input;
    if is_label_file(&args.map) {
        bail!(
            "map {}: expected --truth with the true labels of a map of safety labels \
             (truth.safety.npz of a run, or safety_map.png of a written world), found none",
            args.map.display()
        );
    }
    if input.dataset.is_none() && input.config.is_none() {
        bail!(
            "score: expected --dataset with the recording that the map was made from (or --config that names it)"
        );
    }
    let map = read_map(&args.map)?;
    let plan = Plan::new(args.input.config()?)?;
    let scored = score_map_file(&plan, &map, &map_name(&args.map), &RealClock::default());
    let (result, outside) = scored.map_err(|e| e.context(where_from(args)))?;
    print(&markdown_summary(&plan.job.info, &result))?;
    if outside > 0 {
        print(&format!("\n{outside} voxels of the map lie outside the grid and are not scored.\n"))?;
    }
    Ok(())
}

/// Scores a map of safety labels against true ones on the same cells, all of them.
fn score_labels(map: &Path, truth: &Path) -> Result<()> {
    let (found, true_labels) = (read_labels(map)?, read_labels(truth)?);
    check_same_cells((&found, map), (&true_labels, truth))?;
    let case = SafetyCase::new(&found, &SafetyReference::new(true_labels), None);
    let scores = vec![Scores::safety(&case)];
    let result = MethodResult { method: map_name(map), scores, safety: None, plan: None };
    print(&markdown_table(&[result], LayerKind::Safety))
}

fn map_name(map: &Path) -> String {
    map.file_stem().unwrap_or(Path::new("map").as_os_str()).to_string_lossy().into_owned()
}

fn where_from(args: &ScoreArgs) -> String {
    format!("map {}", args.map.display())
}
