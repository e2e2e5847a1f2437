//! Figures and tables, each as data and picture, made again by one command: `evigrid reproduce GROUP[/ITEM]`.
//!
//! A group is a folder of the output; it has one module here.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod difficulty;
mod picture;
mod safety_maps;
mod worlds;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use evigrid_core::name_hint;

/// Where data is read from and results are written to.
#[derive(Debug, Clone)]
pub struct Folders {
    /// The data sets' root.
    pub data: PathBuf,
    /// The results' root; every group gets a folder there.
    pub out: PathBuf,
}

/// The groups there are.
pub const GROUPS: [&str; 1] = ["worlds"];

/// Makes everything of a group, or one item of it (`GROUP/ITEM`), and names the files it wrote. `report` is told what
/// is being done.
///
/// # Errors
/// If there is no such group or item, or something cannot be read or written.
pub fn reproduce(name: &str, folders: &Folders, report: &mut dyn FnMut(&str)) -> Result<Vec<PathBuf>> {
    let (group, item) = match name.split_once('/') {
        Some((group, item)) => (group, Some(item)),
        None => (name, None),
    };
    match group {
        "worlds" => worlds::reproduce(item, folders, report),
        _ => bail!("reproduce: unknown group `{group}`{}", name_hint(group, GROUPS)),
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

    #[test]
    fn a_world_of_ones_own_gets_a_picture_of_three_panels() {
        let out = tempfile::tempdir().unwrap();
        let folders = Folders { data: out.path().to_owned(), out: out.path().to_owned() };
        let world = concat!(env!("CARGO_MANIFEST_DIR"), "/../evigrid-synth/tests/box.toml");
        let mut said = String::new();
        let files = reproduce(&format!("worlds/{world}"), &folders, &mut |step| said.push_str(step)).unwrap();
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
        for (name, expected) in [("wolds", "mean `worlds`"), ("worlds/bar", "mean `bars`")] {
            let error = reproduce(name, &folders, &mut |_| {}).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
