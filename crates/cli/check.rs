use std::process::ExitCode;

use anyhow::Result;
use evigrid_eval::Method;

use crate::args::CheckArgs;
use crate::output::print;

/// `evigrid check`: exit code 1 if nothing can be run on the data set.
pub fn check(args: &CheckArgs) -> Result<ExitCode> {
    let report = evigrid_replay::check(&args.dir);
    print(&format!("{report}\n"))?;
    let usable = report.usable();
    for method in Method::ALL {
        let verdict = if usable { "can run" } else { "cannot run" };
        print(&format!("{:<20} {verdict} (needs {})\n", method.name(), method.needs()))?;
    }
    let scored = match report.laser_frames {
        0 => "no laser scans: maps are not scored".to_owned(),
        n => format!("maps are scored against {n} laser scans"),
    };
    print(&format!("{scored}\n"))?;
    Ok(if usable { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
