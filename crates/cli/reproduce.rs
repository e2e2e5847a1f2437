use anyhow::Result;
use evigrid_eval::{RealClock, data_root};
use evigrid_reproduce::{Folders, Tools, reproduce};

use crate::args::ReproduceArgs;
use crate::output::{note, tell};
use crate::recorder::open_recorder;

/// `evigrid reproduce`.
pub fn reproduce_all(args: &ReproduceArgs) -> Result<()> {
    let folders = Folders { data: args.data.clone().unwrap_or_else(data_root), out: args.out.clone() };
    let names = if args.names.is_empty() {
        evigrid_reproduce::GROUPS.iter().map(|group| group.name.to_owned()).collect()
    } else {
        args.names.clone()
    };
    let clock = RealClock::default();
    for name in &names {
        let mut report = |step: &str| note(&format!("{name}: {step}"));
        let mut tools = Tools { report: &mut report, clock: &clock, recorder: &open_recorder };
        for file in reproduce(name, &folders, &mut tools)? {
            tell(&format!("{}\n", file.display()));
        }
    }
    Ok(())
}
