use std::fmt;
use std::path::Path;

use serde::Deserialize;

use crate::folder::resolve;
use crate::text::Fault;
use crate::{KittiOdometry, KittiRaw, MiddleburyPair, ReplayError, Sequence, middlebury};

/// How the files of a data set are arranged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// [`KittiRaw`].
    KittiRaw,
    /// [`KittiOdometry`].
    KittiOdometry,
    /// [`MiddleburyPair`].
    Middlebury,
}

impl Layout {
    /// All layouts.
    pub const ALL: [Self; 3] = [Self::KittiRaw, Self::KittiOdometry, Self::Middlebury];

    /// Name as it stands in tables and in `datasets/*.toml`.
    pub fn name(self) -> &'static str {
        match self {
            Self::KittiRaw => "kitti-raw",
            Self::KittiOdometry => "kitti-odometry",
            Self::Middlebury => "middlebury",
        }
    }

    /// What a folder of this layout holds.
    pub fn wants(self) -> &'static str {
        match self {
            Self::KittiRaw => {
                "image_00, image_01, oxts, optionally velodyne_points; calib_cam_to_cam.txt, \
                 calib_velo_to_cam.txt and calib_imu_to_velo.txt in the parent folder"
            }
            Self::KittiOdometry => {
                "image_0, image_1, calib.txt, times.txt, optionally velodyne and velodyne_origins; poses.txt or ../../poses/NN.txt"
            }
            Self::Middlebury => {
                "left.png and right.png, or im2.png and im6.png, or im0.png and im1.png, optionally calib.txt"
            }
        }
    }

    /// The layout of a folder, told by what only this layout has, so that an incomplete folder is recognised too.
    ///
    /// # Errors
    /// If the folder does not exist, or no layout fits; the message lists what each of them wants.
    pub fn of(dir: &Path) -> Result<Self, ReplayError> {
        resolve(dir)?;
        let fits = |layout: &Self| match layout {
            Self::KittiRaw => dir.join("image_00").is_dir() || dir.join("oxts").is_dir(),
            Self::KittiOdometry => dir.join("image_0").is_dir() || dir.join("times.txt").is_file(),
            Self::Middlebury => middlebury::pair_paths(dir).is_some(),
        };
        Self::ALL.into_iter().find(fits).ok_or_else(|| {
            let wanted = Self::ALL.map(|layout| format!("{layout} ({})", layout.wants()));
            Fault::new("data set", format!("one of {}", wanted.join("; ")), "none of them").of(dir)
        })
    }

    /// Opens a folder of this layout.
    ///
    /// # Errors
    /// If something that every frame needs is missing or wrong.
    pub fn open(self, dir: &Path) -> Result<Box<dyn Sequence>, ReplayError> {
        Ok(match self {
            Self::KittiRaw => Box::new(KittiRaw::open(dir)?),
            Self::KittiOdometry => Box::new(KittiOdometry::open(dir)?),
            Self::Middlebury => Box::new(MiddleburyPair::open(dir)?),
        })
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Opens a recording of any layout.
///
/// # Errors
/// If no layout fits, or something that every frame needs is missing or wrong.
pub fn open(dir: &Path) -> Result<Box<dyn Sequence>, ReplayError> {
    Layout::of(dir)?.open(dir)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures;

    #[test]
    fn each_layout_is_recognised() {
        let raw = fixtures::kitti_raw(2);
        assert_eq!(open(&raw.dir).unwrap().info().layout, "kitti-raw");
        let odometry = fixtures::kitti_odometry(2);
        assert_eq!(open(&odometry.dir).unwrap().info().layout, "kitti-odometry");
        let pair = tempfile::tempdir().unwrap();
        for name in ["left.png", "right.png"] {
            fixtures::write_png(&pair.path().join(name), fixtures::gradient(4, 3));
        }
        assert_eq!(open(pair.path()).unwrap().info().layout, "middlebury");
    }

    #[test]
    fn an_unknown_folder_is_told_what_each_layout_wants() {
        let dir = tempfile::tempdir().unwrap();
        let error = open(dir.path()).map(|_| ()).unwrap_err().to_string();
        assert!(error.starts_with("data set: expected one of kitti-raw (image_00, "), "{error}");
        assert!(
            error.contains("kitti-odometry (image_0") && error.contains("middlebury (left.png"),
            "{error}"
        );
        assert!(error.ends_with(&format!("found none of them: {}", dir.path().display())), "{error}");
        assert!(!error.contains('\n'));
        let error = open(Path::new("/nowhere/at/all")).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.starts_with("cannot read data set: ") && error.ends_with(": /nowhere/at/all"),
            "{error}"
        );
    }
}
