//! The drive that the figures of real recordings are made on.

use std::path::{Path, PathBuf};

use anyhow::Result;
use evigrid_replay::{Layout, datasets};

use crate::job::Job;

/// The drive that is wanted first; the paper's own two are 2011_09_28_drive_0038 and _0045.
pub const WANTED: &str = "2011_09_26_drive_0013";

/// A KITTI raw drive that is there.
#[derive(Debug, Clone)]
pub struct Drive {
    pub dir: PathBuf,
    /// Frames to use, as in `run.frames`.
    pub frames: String,
}

/// The wanted drive, else another that the project knows, else the first in the archive's layout.
pub fn find(job: &Job<'_, '_>) -> Result<Option<Drive>> {
    let mut known: Vec<_> = datasets()?.into_iter().filter(|d| d.layout == Layout::KITTI_RAW).collect();
    known.sort_by_key(|d| d.id != WANTED);
    for data in known {
        let dir = data.dir_below(&job.folders.data);
        if dir.join("image_00/data").is_dir() {
            let frames = format!("{}..{}", data.frames.start, data.frames.end);
            return Ok(Some(Drive { dir, frames }));
        }
    }
    let days = folders(&job.folders.data.join("kitti_raw"));
    let drives = days.iter().flat_map(|day| folders(day));
    let drive = drives.into_iter().find(|dir| dir.to_string_lossy().ends_with("_sync"));
    Ok(drive.map(|dir| Drive { dir, frames: "..".into() }))
}

/// Finds the drive, or fails with the message that it is missing.
pub fn require(job: &Job<'_, '_>) -> Result<Drive> {
    find(job)?.ok_or_else(|| job.missing(WANTED))
}

/// The folders in a folder, sorted; none if it cannot be read.
fn folders(dir: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}
