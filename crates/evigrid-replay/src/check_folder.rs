use std::path::{Path, PathBuf};

use crate::check::{CheckItem, CheckReport, ItemState};
use crate::folder::FrameFiles;
use crate::image_size::ImageSize;
use crate::laser_file::check_scan;
use crate::text::{Fault, KeyValues, read_text};
use crate::{FrameRanges, ReplayError, SequenceInfo, png};

/// A key of a calibration file.
pub(crate) struct CalibrationKey {
    name: &'static str,
    /// How many numbers it holds.
    numbers: usize,
}

impl CalibrationKey {
    /// The key of this name, which holds so many numbers.
    pub const fn new(name: &'static str, numbers: usize) -> Self {
        Self { name, numbers }
    }
}

/// A look through one data set. Each layout tells it what to look for; the findings gather in the report.
pub(crate) struct Inspection {
    pub dir: PathBuf,
    pub report: CheckReport,
    /// Size that every image must have, once it is known.
    size: Option<ImageSize>,
}

impl Inspection {
    /// An inspection that has found nothing yet.
    pub fn new(dir: &Path) -> Self {
        let report = CheckReport {
            dir: dir.to_owned(),
            layout: None,
            id: String::new(),
            rig: None,
            rig_is_assumed: false,
            mounting: None,
            frame_count: 0,
            stereo_frames: 0,
            laser_frames: 0,
            items: Vec::new(),
            problems: Vec::new(),
        };
        Self { dir: dir.to_owned(), report, size: None }
    }

    /// Notes what the recording says of itself.
    pub fn opened(&mut self, info: &SequenceInfo) {
        self.report.id.clone_from(&info.id);
        self.report.rig = Some(info.rig);
        self.report.mounting = info.mounting;
        self.size = Some(ImageSize { width: info.rig.width, height: info.rig.height });
    }

    /// Looks at the images of a stereo recording; the left ones tell how many frames there are.
    pub fn stereo(&mut self, left: FrameFiles, right: FrameFiles) {
        let count = left.frame_count(&self.dir).or_else(|_| right.frame_count(&self.dir));
        self.report.frame_count = count.unwrap_or(0);
        let good_left = self.images("left images", "left image", left);
        let good_right = self.images("right images", "right image", right);
        self.report.stereo_frames = good_left.iter().filter(|frame| good_right.contains(frame)).count();
    }

    /// Looks at the laser scans, which a frame may lack.
    pub fn laser(&mut self, files: FrameFiles) {
        let good = self.files("laser scans", files, ItemState::Optional, |_, path| check_scan(path));
        self.report.laser_frames = good.len();
    }

    /// Looks at one calibration file and the keys that it must hold.
    pub fn calibration(&mut self, path: &Path, separator: char, keys: &[CalibrationKey]) {
        let name = file_name(path);
        let expected = keys.iter().map(|key| key.name).collect::<Vec<_>>().join(" ");
        let text = match read_text("calibration", path) {
            Ok(text) => text,
            Err(error) => {
                self.problem(&error);
                return self.item(&name, &expected, "no file", ItemState::Missing);
            }
        };
        let table = KeyValues::parse(&text, separator);
        let mut good = 0;
        for key in keys {
            match table.number_list(key.name, key.numbers) {
                Ok(_) => good += 1,
                Err(fault) => self.problem(&fault.of(path)),
            }
        }
        let state = if good == keys.len() { ItemState::Ok } else { ItemState::Faulty };
        self.item(&name, &expected, &format!("{good} of {} keys", keys.len()), state);
    }

    /// Looks at a file with one line per frame, whose lines `count` parses and counts.
    pub fn lines(&mut self, name: &'static str, path: &Path, count: impl Fn(&str) -> Result<usize, Fault>) {
        let expected = format!("{} lines", self.report.frame_count);
        let text = match read_text(name, path) {
            Ok(text) => text,
            Err(error) => {
                self.problem(&error);
                return self.item(name, &expected, "no file", ItemState::Missing);
            }
        };
        match count(&text) {
            Ok(lines) => {
                let missing: FrameRanges = (lines..self.report.frame_count).collect();
                let state = if missing.is_empty() { ItemState::Ok } else { ItemState::Missing };
                let item = CheckItem::new(name, &expected, &format!("{lines} lines"), state);
                self.report.items.push(CheckItem { missing, ..item });
            }
            Err(fault) => {
                self.problem(&fault.of(path));
                self.item(name, &expected, "unreadable", ItemState::Faulty);
            }
        }
    }

    /// Looks at one file per frame, each with `check`, which is given the frame's number and the file. Gives
    /// the frames whose file is good. `if_missing` is the verdict if some frames lack their file.
    pub fn files(
        &mut self,
        name: &str,
        files: FrameFiles,
        if_missing: ItemState,
        mut check: impl FnMut(usize, &Path) -> Result<(), ReplayError>,
    ) -> Vec<usize> {
        let present = files.numbers(&self.dir).unwrap_or_else(|error| {
            self.problem(&error);
            Default::default()
        });
        let frames = 0..self.report.frame_count;
        let missing: FrameRanges = frames.clone().filter(|frame| !present.contains(frame)).collect();
        let (mut good, mut faulty) = (Vec::new(), Vec::new());
        for frame in frames.filter(|frame| present.contains(frame)) {
            match check(frame, &files.path(&self.dir, frame)) {
                Ok(()) => good.push(frame),
                Err(error) => {
                    self.problem(&error);
                    faulty.push(frame);
                }
            }
        }
        let state = match (faulty.is_empty(), missing.is_empty()) {
            (false, _) => ItemState::Faulty,
            (true, false) => if_missing,
            (true, true) => ItemState::Ok,
        };
        let expected = format!("{} files {}", self.report.frame_count, files.pattern());
        let found = format!("{} files", good.len() + faulty.len());
        let item = CheckItem::new(name, &expected, &found, state);
        self.report.items.push(CheckItem { missing, faulty: faulty.into_iter().collect(), ..item });
        good
    }

    fn images(&mut self, name: &str, what: &'static str, files: FrameFiles) -> Vec<usize> {
        let mut size = self.size;
        let good = self
            .files(name, files, ItemState::Missing, |frame, path| check_image(what, frame, path, &mut size));
        self.size = size;
        good
    }

    /// Looks at the only image of its kind; tells whether it is good.
    pub fn image(&mut self, what: &'static str, path: &Path) -> bool {
        let (found, state) = match check_image(what, 0, path, &mut self.size) {
            Ok(()) => ("one file", ItemState::Ok),
            Err(error) => {
                self.problem(&error);
                if path.exists() { ("one file", ItemState::Faulty) } else { ("none", ItemState::Missing) }
            }
        };
        self.item(what, &file_name(path), found, state);
        state == ItemState::Ok
    }

    /// Notes a thing that no single frame lacks.
    pub fn item(&mut self, name: &str, expected: &str, found: &str, state: ItemState) {
        self.report.items.push(CheckItem::new(name, expected, found, state));
    }

    /// Notes a problem, unless it is already known.
    pub fn problem(&mut self, error: &ReplayError) {
        let line = error.to_string();
        if !self.report.problems.contains(&line) {
            self.report.problems.push(line);
        }
    }
}

/// Looks at an image's header and end. Where no calibration tells the size, the first image does.
fn check_image(
    what: &'static str,
    index: usize,
    path: &Path,
    size: &mut Option<ImageSize>,
) -> Result<(), ReplayError> {
    let found = png::inspect(path)?;
    let expected = *size.get_or_insert(found);
    found.require(what, expected).map_err(|source| ReplayError::Frame {
        index,
        source,
        path: path.to_owned(),
    })
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
