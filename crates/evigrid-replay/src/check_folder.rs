use std::path::{Path, PathBuf};

use crate::check::{CheckItem, CheckReport, ItemState};
use crate::folder::{FrameFiles, resolve};
use crate::frame_parts::require_size;
use crate::laser_file::{check_origins, check_scan};
use crate::text::{Fault, KeyValues, read_text};
use crate::{FrameRanges, Layout, ReplayError, kitti_odometry, kitti_raw, middlebury, png, poses, stamps};

/// Looks through a data set: what its layout wants, what is there, which frames lack what. Cheap on every frame (a
/// file's presence, an image's header and end, a scan's length, a packet's numbers), and it goes on after a problem.
pub fn check(dir: &Path) -> CheckReport {
    let mut inspection = Inspection::new(dir);
    match Layout::of(dir) {
        Ok(layout) => inspection.layout(layout),
        Err(error) => inspection.problem(&error),
    }
    inspection.report
}

/// What a file of one frame is looked at for.
#[derive(Clone, Copy)]
enum Kind {
    Image(&'static str),
    Packet,
    Scan,
    /// The files of the scans that they belong to.
    Origins(FrameFiles),
}

struct Inspection {
    dir: PathBuf,
    size: Option<(usize, usize)>,
    report: CheckReport,
}

impl Inspection {
    fn new(dir: &Path) -> Self {
        let report = CheckReport {
            dir: dir.to_owned(),
            layout: None,
            id: String::new(),
            rig: None,
            rig_is_assumed: false,
            frame_count: 0,
            stereo_frames: 0,
            laser_frames: 0,
            items: Vec::new(),
            problems: Vec::new(),
        };
        Self { dir: dir.to_owned(), size: None, report }
    }

    fn layout(&mut self, layout: Layout) {
        self.report.layout = Some(layout);
        let opened = layout.open(&self.dir);
        if let Ok(sequence) = &opened {
            let info = sequence.info();
            self.report.id.clone_from(&info.id);
            self.report.rig = Some(info.rig);
            self.size = Some((info.rig.width, info.rig.height));
        }
        match layout {
            Layout::KittiRaw => self.kitti_raw(),
            Layout::KittiOdometry => self.kitti_odometry(),
            Layout::Middlebury => self.middlebury(),
        }
        // Whatever kept the recording from opening is among the problems, even if no item shows it.
        if let Err(error) = opened {
            self.problem(&error);
        }
    }

    fn kitti_raw(&mut self) {
        use kitti_raw::{CALIBRATION, LASER, LEFT, OXTS, RIGHT, STAMPS};
        let day = resolve(&self.dir).ok().and_then(|dir| dir.parent().map(Path::to_owned));
        for (file, keys) in CALIBRATION {
            self.calibration(&day.clone().unwrap_or_default().join(file), ':', keys);
        }
        self.stereo(LEFT, RIGHT);
        self.lines("time stamps", &self.dir.join(STAMPS), |text| stamps::parse_dates(text).map(|s| s.len()));
        self.files("GPS/IMU packets", OXTS, Kind::Packet);
        self.laser(LASER);
    }

    fn kitti_odometry(&mut self) {
        use kitti_odometry::{CALIBRATION, LASER, LEFT, ORIGINS, RIGHT, STAMPS, poses_path};
        let has_laser = self.dir.join(LASER.folder).is_dir();
        let keys: &[(&str, usize)] =
            if has_laser { &[("P0", 12), ("P1", 12), ("Tr", 12)] } else { &[("P0", 12), ("P1", 12)] };
        self.calibration(&self.dir.join(CALIBRATION), ':', keys);
        self.stereo(LEFT, RIGHT);
        self.lines("times", &self.dir.join(STAMPS), |text| stamps::parse_seconds(text).map(|s| s.len()));
        let resolved = resolve(&self.dir).unwrap_or_else(|_| self.dir.clone());
        let poses = poses_path(&self.dir, &resolved);
        self.lines("poses", &poses, |text| poses::parse_poses(text).map(|p| p.len()));
        self.laser(LASER);
        // The benchmark has none.
        if self.dir.join(ORIGINS.folder).is_dir() {
            self.files("laser origins", ORIGINS, Kind::Origins(LASER));
        }
    }

    fn middlebury(&mut self) {
        self.report.frame_count = 1;
        let path = self.dir.join(middlebury::CALIBRATION);
        let published = path.is_file();
        self.report.rig_is_assumed = !published;
        if published {
            self.calibration(&path, '=', &[("doffs", 1), ("baseline", 1), ("width", 1), ("height", 1)]);
        } else {
            self.item(middlebury::CALIBRATION, "one file", "none", ItemState::Optional);
        }
        let Some((left, right)) = middlebury::pair_paths(&self.dir) else { return };
        let good =
            [("left image", left), ("right image", right)].map(|(what, path)| self.single(what, &path));
        self.report.stereo_frames = usize::from(good == [true, true]);
    }

    fn stereo(&mut self, left: FrameFiles, right: FrameFiles) {
        let count = left.frame_count(&self.dir).or_else(|_| right.frame_count(&self.dir));
        self.report.frame_count = count.unwrap_or(0);
        let good = [("left images", left, "left image"), ("right images", right, "right image")]
            .map(|(name, files, what)| self.files(name, files, Kind::Image(what)));
        let [good_left, good_right] = good;
        self.report.stereo_frames = good_left.iter().filter(|frame| good_right.contains(frame)).count();
    }

    fn laser(&mut self, files: FrameFiles) {
        self.report.laser_frames = self.files("laser scans", files, Kind::Scan).len();
    }

    /// One calibration file and the keys it must hold.
    fn calibration(&mut self, path: &Path, separator: char, keys: &[(&str, usize)]) {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let expected = keys.iter().map(|(key, _)| *key).collect::<Vec<_>>().join(" ");
        let text = match read_text("calibration", path) {
            Ok(text) => text,
            Err(error) => {
                self.problem(&error);
                return self.item(&name, &expected, "no file", ItemState::Missing);
            }
        };
        let table = KeyValues::parse(&text, separator);
        let mut good = 0;
        for (key, count) in keys {
            match table.number_list(key, *count) {
                Ok(_) => good += 1,
                Err(fault) => self.problem(&fault.of(path)),
            }
        }
        let state = if good == keys.len() { ItemState::Ok } else { ItemState::Faulty };
        self.item(&name, &expected, &format!("{good} of {} keys", keys.len()), state);
    }

    /// A file with one line per frame.
    fn lines(&mut self, name: &'static str, path: &Path, count: impl Fn(&str) -> Result<usize, Fault>) {
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
                self.frame_item(
                    name,
                    &expected,
                    &format!("{lines} lines"),
                    state,
                    [missing, Default::default()],
                );
            }
            Err(fault) => {
                self.problem(&fault.of(path));
                self.item(name, &expected, "unreadable", ItemState::Faulty);
            }
        }
    }

    /// One file per frame; gives the frames whose file is good.
    fn files(&mut self, name: &str, files: FrameFiles, kind: Kind) -> Vec<usize> {
        let present = files.numbers(&self.dir).unwrap_or_else(|error| {
            self.problem(&error);
            Default::default()
        });
        let frames = 0..self.report.frame_count;
        let missing: FrameRanges = frames.clone().filter(|frame| !present.contains(frame)).collect();
        let (mut good, mut faulty) = (Vec::new(), Vec::new());
        for frame in frames.filter(|frame| present.contains(frame)) {
            match self.file(frame, &files.path(&self.dir, frame), kind) {
                Ok(()) => good.push(frame),
                Err(error) => {
                    self.problem(&error);
                    faulty.push(frame);
                }
            }
        }
        let state = match (faulty.is_empty(), missing.is_empty(), kind) {
            (false, _, _) => ItemState::Faulty,
            (true, false, Kind::Scan | Kind::Origins(_)) => ItemState::Optional,
            (true, false, _) => ItemState::Missing,
            (true, true, _) => ItemState::Ok,
        };
        let expected = format!("{} files {}", self.report.frame_count, files.pattern());
        let found = format!("{} files", good.len() + faulty.len());
        self.frame_item(name, &expected, &found, state, [missing, faulty.into_iter().collect()]);
        good
    }

    fn file(&mut self, frame: usize, path: &Path, kind: Kind) -> Result<(), ReplayError> {
        match kind {
            Kind::Image(what) => self.image(what, frame, path),
            Kind::Packet => kitti_raw::read_packet(path).map(|_| ()),
            Kind::Scan => check_scan(path),
            Kind::Origins(scans) => check_origins(path, &scans.path(&self.dir, frame)),
        }
    }

    /// An image's header and end. Where no calibration tells the size, the first image does.
    fn image(&mut self, what: &'static str, index: usize, path: &Path) -> Result<(), ReplayError> {
        let size = png::inspect(path)?;
        let expected = *self.size.get_or_insert(size);
        require_size(what, expected, size).map_err(|source| ReplayError::Frame {
            index,
            source,
            path: path.to_owned(),
        })
    }

    /// The only image of its kind; tells whether it is good.
    fn single(&mut self, what: &'static str, path: &Path) -> bool {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let (found, state) = match self.image(what, 0, path) {
            Ok(()) => ("one file", ItemState::Ok),
            Err(error) => {
                self.problem(&error);
                if path.exists() { ("one file", ItemState::Faulty) } else { ("none", ItemState::Missing) }
            }
        };
        self.item(what, &name, found, state);
        state == ItemState::Ok
    }

    fn item(&mut self, name: &str, expected: &str, found: &str, state: ItemState) {
        self.frame_item(name, expected, found, state, Default::default());
    }

    fn frame_item(
        &mut self,
        name: &str,
        expected: &str,
        found: &str,
        state: ItemState,
        [missing, faulty]: [FrameRanges; 2],
    ) {
        let [name, expected, found] = [name, expected, found].map(str::to_owned);
        self.report.items.push(CheckItem { name, expected, found, state, missing, faulty });
    }

    fn problem(&mut self, error: &ReplayError) {
        let line = error.to_string();
        if !self.report.problems.contains(&line) {
            self.report.problems.push(line);
        }
    }
}

#[cfg(test)]
mod tests;
