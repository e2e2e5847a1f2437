//! Folders with one numbered file per frame.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::ReplayError;
use crate::text::Fault;

/// Frame numbers from here on are refused: a stray file name must not make a recording endless.
const MOST_FRAMES: usize = 1_000_000;

/// One file per frame, named by its number: `image_00/data/0000000017.png`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameFiles {
    /// Below the recording.
    pub folder: &'static str,
    pub digits: usize,
    pub extension: &'static str,
}

impl FrameFiles {
    /// The file of a frame.
    pub fn path(&self, dir: &Path, index: usize) -> PathBuf {
        let name = format!("{index:0digits$}.{}", self.extension, digits = self.digits);
        dir.join(self.folder).join(name)
    }

    /// How the files are named, for a reader.
    pub fn pattern(&self) -> String {
        format!("{}/{}.{}", self.folder, "N".repeat(self.digits), self.extension)
    }

    /// The frames that have a file. None if there is no such folder.
    pub fn numbers(&self, dir: &Path) -> Result<BTreeSet<usize>, ReplayError> {
        let folder = dir.join(self.folder);
        let failed = |source| ReplayError::Io { what: "folder", path: folder.clone(), source };
        let entries = match fs::read_dir(&folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeSet::new()),
            entries => entries.map_err(failed)?,
        };
        let mut numbers = BTreeSet::new();
        for entry in entries {
            let name = entry.map_err(failed)?.file_name();
            numbers.extend(name.to_str().and_then(|name| self.number(name)));
        }
        match numbers.last() {
            Some(&last) if last >= MOST_FRAMES => {
                let expected = format!("fewer than {MOST_FRAMES}");
                Err(Fault::new("frame number", expected, last.to_string()).of(&self.path(dir, last)))
            }
            _ => Ok(numbers),
        }
    }

    /// The frame that a file name stands for.
    fn number(&self, name: &str) -> Option<usize> {
        let digits = name.strip_suffix(self.extension)?.strip_suffix('.')?;
        let plain = digits.len() == self.digits && digits.bytes().all(|b| b.is_ascii_digit());
        if plain { digits.parse().ok() } else { None }
    }

    /// Frames of a recording: one more than the highest number, so that a gap shows as a missing frame.
    pub fn frame_count(&self, dir: &Path) -> Result<usize, ReplayError> {
        match self.numbers(dir)?.last() {
            Some(last) => Ok(last + 1),
            None => Err(Fault::new("left images", format!("files {}", self.pattern()), "none")
                .of(&dir.join(self.folder))),
        }
    }
}

/// A folder's full path: `.` and links have neither a name nor the right parent.
pub(crate) fn resolve(dir: &Path) -> Result<PathBuf, ReplayError> {
    fs::canonicalize(dir).map_err(|source| ReplayError::Io { what: "data set", path: dir.to_owned(), source })
}

/// A folder's own name.
pub(crate) fn folder_name(resolved: &Path) -> String {
    resolved.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const FILES: FrameFiles = FrameFiles { folder: "image_0", digits: 6, extension: "png" };

    #[test]
    fn only_files_of_the_pattern_count() {
        let dir = tempfile::tempdir().unwrap();
        assert!(FILES.numbers(dir.path()).unwrap().is_empty());
        let folder = dir.path().join("image_0");
        fs::create_dir(&folder).unwrap();
        for name in
            ["000003.png", "000010.png", "00004.png", "000005.jpg", "+00006.png", "000007png", "x.png"]
        {
            fs::write(folder.join(name), "").unwrap();
        }
        assert_eq!(FILES.numbers(dir.path()).unwrap().into_iter().collect::<Vec<_>>(), [3, 10]);
        assert_eq!(FILES.frame_count(dir.path()).unwrap(), 11);
        assert_eq!(FILES.path(dir.path(), 3), folder.join("000003.png"));
    }

    #[test]
    fn stray_numbers_do_not_make_a_recording_endless() {
        let dir = tempfile::tempdir().unwrap();
        let files = FrameFiles { digits: 10, ..FILES };
        fs::create_dir(dir.path().join("image_0")).unwrap();
        fs::write(files.path(dir.path(), 9_999_999_999), "").unwrap();
        let error = files.frame_count(dir.path()).unwrap_err().to_string();
        assert!(
            error.starts_with("frame number: expected fewer than 1000000, found 9999999999: "),
            "{error}"
        );
    }

    #[test]
    fn a_recording_without_images_says_so() {
        let error = FILES.frame_count(Path::new("/nowhere")).unwrap_err().to_string();
        assert_eq!(error, "left images: expected files image_0/NNNNNN.png, found none: /nowhere/image_0");
    }
}
