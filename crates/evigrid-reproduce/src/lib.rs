//! Figures and tables, each as data and picture, made again by one command: `evigrid reproduce GROUP[/ITEM]`.
//!
//! A group is a folder of the output; it has one module here.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod difficulty;
mod picture;
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
    std::fs::write(&temporary, bytes).map_err(at_path)?;
    std::fs::rename(&temporary, path).map_err(at_path)
}
