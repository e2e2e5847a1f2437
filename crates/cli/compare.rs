use std::process::ExitCode;

use anyhow::Result;
use evigrid_eval::Config;
use evigrid_results::CompareOptions;

use crate::args::CompareArgs;
use crate::output::print;

/// `evigrid compare`: exit code 1 if something got worse.
pub fn compare(args: &CompareArgs) -> Result<ExitCode> {
    let options = CompareOptions { rules: args.tolerances.clone(), timing: args.timing };
    let comparison =
        evigrid_results::compare(&args.base, &args.new, &options, &Config::default().to_json()?)?;
    print(&comparison.to_text(args.all))?;
    Ok(if comparison.is_worse() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}
