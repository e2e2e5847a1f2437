use std::path::Path;

use anyhow::{Result, bail};
use evigrid_eval::{Plan, RealClock, score_map_file};
use evigrid_results::{markdown_summary, read_map};

use crate::args::ScoreArgs;
use crate::output::print;

/// `evigrid score`.
pub fn score(args: &ScoreArgs) -> Result<()> {
    let input = &args.input;
    if input.dataset.is_none() && input.config.is_none() {
        bail!(
            "score: expected --dataset with the recording that the map was made from (or --config that names it)"
        );
    }
    let map = read_map(&args.map)?;
    let plan = Plan::new(args.input.config()?)?;
    let name = args.map.file_stem().unwrap_or(Path::new("map").as_os_str()).to_string_lossy();
    let scored = score_map_file(&plan, &map, &name, &RealClock::default());
    let (result, outside) = scored.map_err(|e| e.context(where_from(args)))?;
    print(&markdown_summary(&plan.job.info, &result))?;
    if outside > 0 {
        print(&format!("\n{outside} voxels of the map lie outside the grid and are not scored.\n"))?;
    }
    Ok(())
}

fn where_from(args: &ScoreArgs) -> String {
    format!("map {}", args.map.display())
}
