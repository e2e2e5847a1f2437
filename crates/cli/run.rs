use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Result;
use evigrid_eval::{Observer, Plan, RealClock, TableWriter, evaluate};
use evigrid_results::{RECORDING, ResultsFolder, RunResult, markdown_summary};

use crate::args::RunArgs;
use crate::build_info::build_info;
use crate::output::tell;
use crate::progress::Progress;
use crate::recorder::open_recorder;

/// `evigrid run`.
pub fn run(args: &RunArgs) -> Result<()> {
    let plan = Plan::new(args.config()?)?;
    if let Some(unseen_m) = plan.unseen_m() {
        let largest = plan.job.config.stereo.min_disparity + plan.job.config.stereo.disparities - 1;
        log::warn!(
            "stereo.disparities: the largest, {largest} px, is {unseen_m:.1} m away; what is nearer stays unknown"
        );
    }
    let info = &plan.job.info;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(&info.dataset));
    let (folder, left_over) = ResultsFolder::open(&out)?;
    if !left_over.is_empty() {
        let names = left_over.join(", ");
        log::warn!("an earlier run in {} did not finish; removed what it left: {names}", out.display());
    }

    let mut progress = Progress::default();
    let path = folder.dir().join(RECORDING);
    let mut recorder = if plan.job.config.output.recording { open_recorder(path)? } else { None };
    let mut tables = TableWriter::create(&folder, info, build_info())?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut progress];
    if let Some(recorder) = &mut recorder {
        observers.push(recorder.as_mut());
    }
    observers.push(&mut tables);
    let result = evaluate(&plan, &RealClock::default(), &folder, &mut observers)?;

    let mut text = format!("{}\n{}\n", markdown_summary(info, &result), speed(&result));
    let _ = writeln!(text, "Results: {}", out.display());
    if recorder.is_some() {
        let _ = writeln!(text, "Recording: rerun {}", out.join(RECORDING).display());
    }
    tell(&text);
    Ok(())
}

/// One line on how fast the run was; the stages' times are means over the frames.
fn speed(result: &RunResult) -> String {
    let frames = result.frames as f64;
    let stages: Vec<_> =
        result.stage_totals.iter().map(|(stage, total)| format!("{stage} {:.1}", total / frames)).collect();
    format!(
        "{:.1} frames per second; ms per frame: {} (reading runs beside the rest).",
        frames / (result.wall_ms / 1e3),
        stages.join(", ")
    )
}
