use std::ops::Range;
use std::path::{Path, PathBuf};

use evigrid_core::StereoRig;
use serde::Deserialize;

use crate::text::Fault;
use crate::{Layout, ReplayError};

/// The files of `datasets/` with their names.
const FILES: [(&str, &str); 4] = [
    ("datasets/2011_09_26_drive_0013.toml", include_str!("../../../datasets/2011_09_26_drive_0013.toml")),
    ("datasets/2011_09_28_drive_0038.toml", include_str!("../../../datasets/2011_09_28_drive_0038.toml")),
    ("datasets/2011_09_28_drive_0045.toml", include_str!("../../../datasets/2011_09_28_drive_0045.toml")),
    ("datasets/middlebury-cones.toml", include_str!("../../../datasets/middlebury-cones.toml")),
];

/// A recording that the project knows by name: a file of `datasets/`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetInfo {
    /// Name of the recording, as for `--dataset`.
    pub id: String,
    /// One line that says what is seen.
    pub title: String,
    /// Makers of the recording, and where it is described.
    pub origin: String,
    /// Terms of use.
    pub licence: String,
    /// Arrangement of the recording's files.
    pub layout: Layout,
    /// Folder of the recording below the data root.
    pub dir: PathBuf,
    /// Folder below the data root in which the archives are unpacked.
    pub unpack_into: PathBuf,
    /// Archives to download.
    pub files: Vec<DatasetFile>,
    /// Files and folders that must be there once the archives are unpacked, relative to `dir`.
    pub expect: Vec<PathBuf>,
    /// Frames that published figures use.
    pub frames: Range<usize>,
    /// Rig of the recording, to compare with that of the files.
    #[serde(with = "Rig")]
    pub rig: StereoRig,
    /// Whether the rig is assumed, because none is published.
    pub rig_is_assumed: bool,
    /// Use of the recording in this project.
    pub note: String,
}

/// An archive of a data set.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetFile {
    /// Public address.
    pub url: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, remote = "StereoRig")]
struct Rig {
    width: usize,
    height: usize,
    focal_px: f64,
    centre_x_px: f64,
    centre_y_px: f64,
    baseline_m: f64,
}

impl DatasetInfo {
    /// Folder of the recording below a data root.
    pub fn dir_below(&self, data_root: &Path) -> PathBuf {
        data_root.join(&self.dir)
    }
}

/// All recordings that the project knows by name, ordered by name.
///
/// # Errors
/// If a file of `datasets/` is not what it should be: a mistake of the project, found by its tests.
pub fn datasets() -> Result<Vec<DatasetInfo>, ReplayError> {
    FILES.iter().map(|(path, text)| parse(text).map_err(|fault| fault.of(Path::new(path)))).collect()
}

/// The recording of a name, if the project knows it.
///
/// # Errors
/// If a file of `datasets/` is not what it should be.
pub fn find_dataset(name: &str) -> Result<Option<DatasetInfo>, ReplayError> {
    Ok(datasets()?.into_iter().find(|dataset| dataset.id == name))
}

fn parse(text: &str) -> Result<DatasetInfo, Fault> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
        Fault::new("data set", "a description of a data set", error.message().replace('\n', " "))
            .on_line(line)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn all_files_are_read_and_named_after_their_id() {
        let all = datasets().unwrap();
        for (dataset, (path, _)) in all.iter().zip(FILES) {
            assert_eq!(path, format!("datasets/{}.toml", dataset.id));
            assert!(dataset.dir.starts_with(&dataset.unpack_into) && dataset.dir.is_relative(), "{path}");
            assert!(!dataset.frames.is_empty() && dataset.rig.checked().is_ok(), "{path}");
            assert!(
                dataset.files.iter().all(|f| f.url.starts_with("https://") && f.url.ends_with(".zip")),
                "{path}"
            );
            assert!(!dataset.expect.is_empty(), "{path}");
        }
        assert!(all.is_sorted_by_key(|dataset| dataset.id.clone()));
        // Every description in the folder is built in.
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../datasets");
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        assert_eq!(paths.filter(|path| path.extension().is_some_and(|e| e == "toml")).count(), FILES.len());
    }

    #[test]
    fn names_resolve_below_a_data_root() {
        let drive = find_dataset("2011_09_26_drive_0013").unwrap().unwrap();
        let expected = "/data/kitti_raw/2011_09_26/2011_09_26_drive_0013_sync";
        assert_eq!(drive.dir_below(Path::new("/data")), Path::new(expected));
        assert_eq!(find_dataset("2011_09_26_drive_0014").unwrap(), None);
    }

    #[test]
    fn unknown_layouts_are_refused_with_their_line() {
        let (_, text) = FILES[0];
        let fault = parse(&text.replace("\"kitti-raw\"", "\"kitti_raw\"")).unwrap_err();
        let message = fault.of(Path::new("d.toml")).to_string();
        assert!(message.contains("unknown layout `kitti_raw`, expected one of "), "{message}");
        assert!(message.contains("kitti-raw, kitti-odometry"), "{message}");
        assert!(message.ends_with("d.toml:5"), "{message}");
    }

    #[test]
    fn unknown_keys_are_refused_with_their_line() {
        let (_, text) = FILES[0];
        let fault = parse(&text.replace("licence =", "license =")).unwrap_err();
        let message = fault.of(Path::new("d.toml")).to_string();
        assert!(message.contains("license") && message.ends_with("d.toml:4"), "{message}");
    }
}
