use anyhow::Result;
use evigrid_eval::data_root;
use evigrid_reproduce::{Folders, reproduce};

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
    for name in &names {
        for file in reproduce(name, &folders, &mut |step| eprintln!("{name}: {step}"))? {
            print(&format!("{}\n", file.display()))?;
        }
    }
    Ok(())
}
