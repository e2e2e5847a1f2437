use std::path::PathBuf;

use anyhow::Result;
use evigrid_eval::{Observer, RealClock, data_root};
use evigrid_reproduce::{Folders, Tools, reproduce};

use crate::args::ReproduceArgs;
use crate::output::print;

/// `evigrid reproduce`.
pub fn reproduce_all(args: &ReproduceArgs) -> Result<()> {
    let folders = Folders { data: args.data.clone().unwrap_or_else(data_root), out: args.out.clone() };
    let names = if args.names.is_empty() {
        evigrid_reproduce::GROUPS.map(str::to_owned).to_vec()
    } else {
        args.names.clone()
    };
    let clock = RealClock::default();
    for name in &names {
        let mut report = |step: &str| eprintln!("{name}: {step}");
        let mut tools = Tools { report: &mut report, clock: &clock, recorder: &recorder };
        for file in reproduce(name, &folders, &mut tools)? {
            print(&format!("{}\n", file.display()))?;
        }
    }
    Ok(())
}

#[cfg(feature = "rerun")]
fn recorder(path: PathBuf) -> Result<Option<Box<dyn Observer>>> {
    Ok(Some(Box::new(evigrid_record::Recorder::create(path)?)))
}

#[cfg(not(feature = "rerun"))]
fn recorder(path: PathBuf) -> Result<Option<Box<dyn Observer>>> {
    log::warn!("built without the feature `rerun`: no recording is written to {}", path.display());
    Ok(None)
}
