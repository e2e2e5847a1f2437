use std::process::ExitCode;

use anyhow::Result;
use evigrid_eval::CompareOptions;

use crate::args::CompareArgs;
use crate::output::print;

/// `evigrid compare`: exit code 1 if something got worse.
pub fn compare(args: &CompareArgs) -> Result<ExitCode> {
    let options = CompareOptions { rules: args.tolerances.clone(), timing: args.timing };
    let comparison = evigrid_eval::compare(&args.base, &args.new, &options)?;
    print(&comparison.to_text(args.all))?;
    Ok(if comparison.is_worse() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}
