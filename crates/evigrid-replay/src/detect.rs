//! Data sets of any layout: the list of all layouts, and how the layout of a folder is told.

use std::path::Path;

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::check_folder::Inspection;
use crate::folder::resolve;
use crate::text::Fault;
use crate::{CheckReport, Layout, ReplayError, Sequence};

impl Layout {
    /// All layouts. Of several that fit a folder, the first counts.
    pub const ALL: [Self; 3] = [Self::KITTI_RAW, Self::KITTI_ODOMETRY, Self::MIDDLEBURY];

    /// The layout of a folder, told by what only this layout has. An incomplete folder is recognised, too.
    ///
    /// # Errors
    /// If the folder does not exist, or no layout fits; the message lists what each of them wants.
    pub fn of(dir: &Path) -> Result<Self, ReplayError> {
        resolve(dir)?;
        Self::ALL.into_iter().find(|layout| (layout.0.fits)(dir)).ok_or_else(|| {
            let wanted = Self::ALL.map(|layout| format!("{layout} ({})", layout.wants()));
            Fault::new("data set", format!("one of {}", wanted.join("; ")), "none of them").of(dir)
        })
    }
}

impl<'de> Deserialize<'de> for Layout {
    /// Takes the name of a layout.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::ALL.into_iter().find(|layout| layout.name() == name).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            D::Error::custom(format!("unknown layout `{name}`, expected one of {known}"))
        })
    }
}

/// Opens a recording of any layout.
///
/// # Errors
/// If no layout fits, or something that every frame needs is missing or wrong.
pub fn open(dir: &Path) -> Result<Box<dyn Sequence>, ReplayError> {
    Layout::of(dir)?.open(dir)
}

/// Looks through a data set: what its layout wants, what is there, which frames lack what.
///
/// It is cheap on every frame (a file's presence, an image's header and end, a scan's length, a packet's
/// numbers), and goes on after a problem.
pub fn check(dir: &Path) -> CheckReport {
    match Layout::of(dir) {
        Ok(layout) => layout.check(dir),
        Err(error) => {
            let mut inspection = Inspection::new(dir);
            inspection.problem(&error);
            inspection.report
        }
    }
}

#[cfg(test)]
mod check_tests;
#[cfg(test)]
mod tests;
