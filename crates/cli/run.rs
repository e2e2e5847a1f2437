use std::path::PathBuf;

use anyhow::Result;
use evigrid_eval::{
    Observer, Plan, RealClock, ResultsFolder, RunResult, SweepPlan, TableWriter, evaluate, markdown_summary,
};
use serde_json::json;

use crate::args::RunArgs;
use crate::output::print;
use crate::progress::Progress;
use crate::sweep::run_plan;

/// `evigrid run`.
pub fn run(args: &RunArgs) -> Result<()> {
    let mut config = args.input.config()?;
    if !args.methods.is_empty() {
        config.run.methods.clone_from(&args.methods);
    }
    if !args.sweeps.is_empty() {
        return run_plan(SweepPlan::around(config, &args.sweeps)?, args.out.clone());
    }
    let plan = Plan::new(config)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(&plan.info.dataset));
    let (folder, left_over) = ResultsFolder::open(&out)?;
    if !left_over.is_empty() {
        let names = left_over.join(", ");
        log::warn!("an earlier run in {} did not finish; removed what it left: {names}", out.display());
    }

    let mut progress = Progress::default();
    let mut recorder = recorder(&plan, &folder)?;
    let mut tables = TableWriter::create(&folder, &plan.info, build())?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut progress];
    if let Some(recorder) = &mut recorder {
        observers.push(recorder.as_mut());
    }
    observers.push(&mut tables);
    let result = evaluate(&plan, &RealClock::default(), &folder, &mut observers)?;

    print(&format!("{}\n{}\n", markdown_summary(&plan.info, &result), speed(&result)))?;
    print(&format!("Results: {}\n", out.display()))?;
    if recorder.is_some() {
        print(&format!("Recording: rerun {}\n", out.join("recording.rrd").display()))?;
    }
    Ok(())
}

#[cfg(feature = "rerun")]
fn recorder(plan: &Plan, folder: &ResultsFolder) -> Result<Option<Box<dyn Observer>>> {
    if !plan.info.config.output.recording {
        return Ok(None);
    }
    Ok(Some(Box::new(evigrid_record::Recorder::create(folder.dir().join("recording.rrd"))?)))
}

#[cfg(not(feature = "rerun"))]
fn recorder(plan: &Plan, _: &ResultsFolder) -> Result<Option<Box<dyn Observer>>> {
    if plan.info.config.output.recording {
        log::warn!("built without the feature `rerun`: no recording is written");
    }
    Ok(None)
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

/// What run.json says of the build and the machine.
pub fn build() -> serde_json::Value {
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("EVIGRID_COMMIT"),
        "profile": if cfg!(debug_assertions) { "debug" } else { "release" },
        "rerun": cfg!(feature = "rerun"),
        "os": std::env::consts::OS,
        "arch": std::env::consts::ARCH,
        "cpu": cpu.map_or("", |(_, name)| name.trim()),
        "threads": std::thread::available_parallelism().map_or(0, usize::from),
    })
}
