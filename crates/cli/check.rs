use std::process::ExitCode;

use anyhow::Result;
use evigrid_methods::Methods;

use crate::args::CheckArgs;
use crate::output::print;

/// `evigrid check`: exit code 1 if nothing can be run on the data set.
pub fn check(args: &CheckArgs) -> Result<ExitCode> {
    let report = evigrid_replay::check(&args.dir);
    print(&format!("{report}\n"))?;
    let usable = report.usable();
    for method in Methods::default().iter() {
        let lacks_mounting = method.needs.mounting && report.mounting.is_none();
        let verdict = match (usable, lacks_mounting) {
            (false, _) => "cannot run",
            (true, true) => "can run with --set input.mounting=[height_m, pitch_deg]",
            (true, false) => "can run",
        };
        print(&format!("{:<20} {verdict} (needs {})\n", method.name, method.needs))?;
    }
    let scored = match report.laser_frames {
        0 => "no laser scans: maps are not scored".to_owned(),
        n => format!("maps are scored against {n} laser scans"),
    };
    print(&format!("{scored}\n"))?;
    Ok(if usable { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
