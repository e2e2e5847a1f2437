use std::path::PathBuf;

use anyhow::{Context, Result};
use evigrid_eval::{RealClock, Sweep, SweepPlan, run_sweep};

use crate::args::{RunArgs, SweepArgs};
use crate::build_info::build_info;
use crate::output::tell;
use crate::progress::SweepProgress;

/// `evigrid sweep`.
pub fn sweep(args: &SweepArgs) -> Result<()> {
    run_plan(SweepPlan::read(&args.plan)?, args.out.clone())
}

/// `evigrid run` with `--sweep`: a sweep around the run.
pub fn around(args: &RunArgs) -> Result<()> {
    run_plan(SweepPlan::around(args.config()?, &args.sweeps)?, args.out.clone())
}

/// A sweep into the folder `out`, by default one with its name.
fn run_plan(plan: SweepPlan, out: Option<PathBuf>) -> Result<()> {
    let sweep = Sweep::new(plan)?;
    let out = out.unwrap_or_else(|| PathBuf::from("out").join(format!("sweep-{}", sweep.name())));
    let mut progress = SweepProgress::default();
    run_sweep(&sweep, &out, &build_info(), &RealClock::default(), &mut |step| progress.show(step, &out))?;
    drop(progress);
    let page = out.join("sweep.md");
    let text = std::fs::read_to_string(&page).with_context(|| format!("cannot read {}", page.display()))?;
    tell(&format!("{text}\nResults: {}\n", out.display()));
    Ok(())
}
