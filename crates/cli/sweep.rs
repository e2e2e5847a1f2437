use std::path::PathBuf;

use anyhow::Result;
use evigrid_eval::{RealClock, Sweep, SweepPlan, run_sweep};

use crate::args::SweepArgs;
use crate::output::print;
use crate::progress::SweepProgress;
use crate::run::build;

/// `evigrid sweep`.
pub fn sweep(args: &SweepArgs) -> Result<()> {
    run_plan(SweepPlan::read(&args.plan)?, args.out.clone())
}

/// A sweep into the folder `out`, by default one with its name.
pub fn run_plan(plan: SweepPlan, out: Option<PathBuf>) -> Result<()> {
    let sweep = Sweep::new(plan)?;
    let out = out.unwrap_or_else(|| PathBuf::from("out").join(format!("sweep-{}", sweep.name())));
    let mut progress = SweepProgress::default();
    run_sweep(&sweep, &out, &build(), &RealClock::default(), &mut |step| progress.show(step, &out))?;
    drop(progress);
    print(&std::fs::read_to_string(out.join("sweep.md"))?)?;
    print(&format!("\nResults: {}\n", out.display()))
}
