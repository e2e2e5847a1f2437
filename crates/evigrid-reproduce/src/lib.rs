//! Figures and tables, each as data and picture, made again by one command: `evigrid reproduce GROUP[/ITEM]`.
//!
//! A group is a folder of the output; it has one module here.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod andert;
mod brandao;
mod cells;
mod chart;
mod cubes;
mod difficulty;
mod drive;
mod image_view;
mod job;
mod journey;
mod murarka;
mod perrollaz;
mod picture;
mod profile;
mod recording;
mod safety_maps;
mod souza;
mod stopwatch;
mod table;
mod worlds;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use evigrid_core::name_hint;
use evigrid_eval::{Clock, Observer};

use crate::job::{Make, make_items};

/// Where data is read from and results are written to.
#[derive(Debug, Clone)]
pub struct Folders {
    /// The data sets' root.
    pub data: PathBuf,
    /// The results' root; every group gets a folder there.
    pub out: PathBuf,
}

/// Tools that the command lends, so that nothing here knows of terminals, the machine's
/// clock or the recording's format.
pub struct Tools<'a> {
    /// Is told what is being done.
    pub report: &'a mut dyn FnMut(&str),
    /// Where measured times come from.
    pub clock: &'a dyn Clock,
    /// Opens what records a run into a file; `None` if the program cannot record.
    pub recorder: &'a dyn Fn(PathBuf) -> Result<Option<Box<dyn Observer>>>,
}

/// A folder of the output, with everything that is made into it.
#[derive(Clone, Copy)]
pub struct Group {
    /// Name of the group and of its folder.
    pub name: &'static str,
    items: Items,
}

/// The items of a group.
#[derive(Clone, Copy)]
enum Items {
    /// Items that are made one by one, by name, in the order in which they are made.
    Listed(&'static [(&'static str, Make)]),
    /// Items that are made together: their names, and the function that makes one of them or all.
    Together {
        names: fn() -> Vec<&'static str>,
        make: fn(Option<&str>, &Folders, &mut Tools<'_>) -> Result<Vec<PathBuf>>,
    },
}

impl Group {
    /// Names of the items, in the order in which they are made.
    pub fn items(&self) -> Vec<&'static str> {
        match self.items {
            Items::Listed(items) => items.iter().map(|(name, _)| *name).collect(),
            Items::Together { names, .. } => names(),
        }
    }

    /// Makes one item, or all of them.
    fn make(&self, item: Option<&str>, folders: &Folders, tools: &mut Tools<'_>) -> Result<Vec<PathBuf>> {
        match self.items {
            Items::Listed(items) => make_items(self.name, items, item, folders, tools),
            Items::Together { make, .. } => make(item, folders, tools),
        }
    }
}

impl std::fmt::Debug for Group {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Group").field("name", &self.name).finish_non_exhaustive()
    }
}

/// All groups: the one list.
pub const GROUPS: &[Group] =
    &[worlds::GROUP, andert::GROUP, souza::GROUP, brandao::GROUP, murarka::GROUP, perrollaz::GROUP];

/// Makes everything of a group, or one item of it (`GROUP/ITEM`), and names the files it wrote.
///
/// # Errors
/// If there is no such group or item, something cannot be read or written, or the data of the one item that
/// was asked for are not there. Of a whole group such items are left out, and it is said which.
pub fn reproduce(name: &str, folders: &Folders, tools: &mut Tools<'_>) -> Result<Vec<PathBuf>> {
    let (group, item) = match name.split_once('/') {
        Some((group, item)) => (group, Some(item)),
        None => (name, None),
    };
    match GROUPS.iter().find(|known| known.name == group) {
        Some(known) => known.make(item, folders, tools),
        None => {
            bail!("reproduce: unknown group `{group}`{}", name_hint(group, GROUPS.iter().map(|g| g.name)))
        }
    }
}

/// Writes a whole file under a temporary name and renames it.
fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let at_path = |e: std::io::Error| anyhow::anyhow!("cannot write {}: {e}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(at_path)?;
    }
    let temporary = path.with_extension("part");
    std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path)).map_err(|e| {
        // Nothing more can be done if the leftover cannot be removed either.
        let _ = std::fs::remove_file(&temporary);
        at_path(e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_eval::RealClock;

    fn make(name: &str, folders: &Folders, report: &mut dyn FnMut(&str)) -> Result<Vec<PathBuf>> {
        let clock = RealClock::default();
        reproduce(name, folders, &mut Tools { report, clock: &clock, recorder: &|_| Ok(None) })
    }

    #[test]
    fn a_world_of_ones_own_gets_a_picture_of_three_panels() {
        let out = tempfile::tempdir().unwrap();
        let folders = Folders { data: out.path().to_owned(), out: out.path().to_owned() };
        let world = concat!(env!("CARGO_MANIFEST_DIR"), "/../evigrid-synth/tests/box.toml");
        let mut said = String::new();
        let files = make(&format!("worlds/{world}"), &folders, &mut |step| said.push_str(step)).unwrap();
        assert_eq!(files, [out.path().join("worlds/box.jpg")]);
        let picture = image::open(&files[0]).unwrap();
        // Three images of 160 x 96 scaled to a width of 480, two gaps of 6.
        assert_eq!((picture.width(), picture.height()), (3 * 480 + 2 * 6, 288));
        assert!(said.contains("| `box` | 160x96, f 120 px, b 0.4 m | 3 |"), "{said}");
        // Nothing else lies beside it.
        assert_eq!(std::fs::read_dir(out.path().join("worlds")).unwrap().count(), 1);
    }

    #[test]
    fn unknown_names_get_the_nearest_one() {
        let folders = Folders { data: PathBuf::new(), out: PathBuf::new() };
        for (name, expected) in
            [("wolds", "mean `worlds`"), ("worlds/bar", "mean `bars`"), ("brandao/fig11", "mean `fig10`")]
        {
            let error = make(name, &folders, &mut |_| {}).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
