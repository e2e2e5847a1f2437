use anyhow::Result;
use evigrid_eval::{RealClock, data_root};
use evigrid_reproduce::{Folders, Tools, reproduce};

use crate::args::ReproduceArgs;
use crate::output::{note, tell};
use crate::recorder::open_recorder;

/// `evigrid reproduce`.
pub fn reproduce_all(args: &ReproduceArgs) -> Result<()> {
    let folders = Folders { data: args.data.clone().unwrap_or_else(data_root), out: args.out.clone() };
    let mut names: Vec<String> = if args.names.is_empty() {
        evigrid_reproduce::GROUPS.iter().map(|group| group.name.to_owned()).collect()
    } else {
        args.names.clone()
    };
    // What is not listed goes first: a mistyped name is then found before the work on the others.
    names.sort_by_key(|name| is_listed(name));
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

/// Whether a name is that of a group, or of an item that its group lists.
fn is_listed(name: &str) -> bool {
    let (group, item) = name.split_once('/').map_or((name, None), |(group, item)| (group, Some(item)));
    let known = evigrid_reproduce::GROUPS.iter().find(|known| known.name == group);
    known.is_some_and(|known| item.is_none_or(|item| known.items().contains(&item)))
}
