//! KITTI odometry sequences (Geiger et al., "Are we ready for autonomous driving?", CVPR 2012). The synthetic
//! worlds are written in this layout as well.

use std::path::{Path, PathBuf};

use evigrid_core::{Frame, LaserScan, Pose};

use crate::calibration::{ProjectionMatrix, RectifiedPair, level_pose, pose_from_matrix, rectified_pair};
use crate::check_folder::{CalibrationKey, Inspection};
use crate::folder::{FrameFiles, folder_name, resolve};
use crate::frame_parts::{FrameParts, ScanFiles, require_frame};
use crate::image_size::ImageSize;
use crate::laser_file::check_origins;
use crate::layout::LayoutSpec;
use crate::png;
use crate::poses::parse_poses;
use crate::stamps::parse_seconds;
use crate::text::{Fault, KeyValues, read_text};
use crate::{ItemState, Layout, ReplayError, Sequence, SequenceInfo};

const LEFT: FrameFiles = FrameFiles { folder: "image_0", digits: 6, extension: "png" };
const RIGHT: FrameFiles = FrameFiles { folder: "image_1", ..LEFT };
const LASER: FrameFiles = FrameFiles { folder: "velodyne", digits: 6, extension: "bin" };
const ORIGINS: FrameFiles = FrameFiles { folder: "velodyne_origins", ..LASER };
const CALIBRATION: &str = "calib.txt";
const STAMPS: &str = "times.txt";
/// Keys of the two cameras, then of the laser.
const KEYS: [CalibrationKey; 3] =
    [CalibrationKey::new("P0", 12), CalibrationKey::new("P1", 12), CalibrationKey::new("Tr", 12)];

impl Layout {
    /// Layout of a [`KittiOdometry`] sequence.
    pub const KITTI_ODOMETRY: Self = Self(&LayoutSpec {
        name: "kitti-odometry",
        wants: "image_0, image_1, calib.txt, times.txt, optionally velodyne and velodyne_origins; \
                poses.txt or ../../poses/NN.txt",
        fits: |dir| dir.join("image_0").is_dir() || dir.join("times.txt").is_file(),
        open: |dir| Ok(Box::new(KittiOdometry::open(dir)?)),
        check,
    });
}

/// A sequence of the KITTI odometry benchmark: grey stereo pair, poses, Velodyne.
///
/// Beyond the benchmark, a scan whose rays did not all start at the laser's origin may have a file in
/// `velodyne_origins` that says where they did, in the order of its points.
///
/// The poses carry no gravity: the frame that `poses.txt` is given in, which is the first left camera of a
/// whole sequence, is taken to be a level camera. The world is that camera's x forward, y left, z up, metres.
#[derive(Debug)]
pub struct KittiOdometry {
    dir: PathBuf,
    info: SequenceInfo,
    stamps_ns: Vec<i64>,
    /// Poses of the frame that the projections start from.
    world_from_rectified: Vec<Pose>,
    calibration: Calibration,
}

impl KittiOdometry {
    /// Opens a sequence folder: `calib.txt`, `times.txt`, `image_0`, `image_1`, optionally `velodyne` and
    /// `velodyne_origins`, and the poses in `poses.txt` or, as the benchmark packs them, in
    /// `../../poses/NN.txt`. The image size is that of the first left image.
    ///
    /// # Errors
    /// If one of these is missing or wrong, if there are fewer times or poses than frames, or if there are
    /// scans but no `Tr` in the calibration.
    pub fn open(dir: &Path) -> Result<Self, ReplayError> {
        let resolved = resolve(dir)?;
        let frame_count = LEFT.frame_count(dir)?;
        let calibration = read_calibration(dir)?;
        let stamps_path = dir.join(STAMPS);
        let stamps_ns = parse_seconds(&read_text("times", &stamps_path)?).map_err(|f| f.of(&stamps_path))?;
        require_lines("times", stamps_ns.len(), frame_count, &stamps_path)?;
        let poses_path = poses_path(dir, &resolved);
        let poses = parse_poses(&read_text("poses", &poses_path)?).map_err(|f| f.of(&poses_path))?;
        require_lines("poses", poses.len(), frame_count, &poses_path)?;
        Ok(Self {
            dir: dir.to_owned(),
            info: SequenceInfo {
                id: id(&folder_name(&resolved)),
                layout: Layout::KITTI_ODOMETRY.name(),
                rig: calibration.pair.rig,
                // The layout does not tell, and synthetic worlds are written in it too.
                mounting: None,
                frame_count,
            },
            stamps_ns,
            world_from_rectified: poses.iter().map(|pose| level_pose() * pose).collect(),
            calibration,
        })
    }

    fn world_from_rectified(&self, index: usize) -> Result<Pose, ReplayError> {
        require_frame(&self.info, &self.dir, index)?;
        Ok(self.world_from_rectified[index])
    }
}

impl KittiOdometry {
    /// The places of the parts of a frame.
    fn parts(&self, index: usize, map_from_world: &Pose) -> Result<FrameParts, ReplayError> {
        let map_from_rectified = map_from_world * self.world_from_rectified(index)?;
        let laser = self.calibration.rectified_from_laser;
        Ok(FrameParts {
            index,
            stamp_ns: self.stamps_ns[index],
            left: LEFT.path(&self.dir, index),
            right: RIGHT.path(&self.dir, index),
            map_from_left: map_from_rectified * self.calibration.pair.left_from_rectified.inverse(),
            laser: laser.map(|laser| ScanFiles {
                points: LASER.path(&self.dir, index),
                origins: Some(ORIGINS.path(&self.dir, index)),
                map_from_laser: map_from_rectified * laser,
            }),
        })
    }
}

impl Sequence for KittiOdometry {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        Ok(self.world_from_rectified(index)? * self.calibration.pair.left_from_rectified.inverse())
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        self.parts(index, map_from_world)?.read(self.info.rig)
    }

    fn laser(&self, index: usize, map_from_world: &Pose) -> Result<Option<LaserScan>, ReplayError> {
        self.parts(index, map_from_world)?.read_laser()
    }
}

#[derive(Debug)]
struct Calibration {
    pair: RectifiedPair,
    rectified_from_laser: Option<Pose>,
}

fn read_calibration(dir: &Path) -> Result<Calibration, ReplayError> {
    let path = dir.join(CALIBRATION);
    let size = first_image_size(dir)?;
    let has_laser = dir.join(LASER.folder).is_dir();
    let text = read_text("calibration", &path)?;
    parse_calibration(&text, size, has_laser).map_err(|fault| fault.of(&path))
}

fn parse_calibration(text: &str, size: ImageSize, has_laser: bool) -> Result<Calibration, Fault> {
    let table = KeyValues::parse(text, ':');
    let (left, right) = (table.numbers("P0")?, table.numbers("P1")?);
    let left = ProjectionMatrix::new("P0", &left)?;
    let pair = rectified_pair(&left, &ProjectionMatrix::new("P1", &right)?, size)?;
    let rectified_from_laser =
        if has_laser { Some(pose_from_matrix("Tr", &table.numbers("Tr")?)?) } else { None };
    Ok(Calibration { pair, rectified_from_laser })
}

fn first_image_size(dir: &Path) -> Result<ImageSize, ReplayError> {
    match LEFT.numbers(dir)?.first() {
        Some(&first) => png::inspect(&LEFT.path(dir, first)),
        None => LEFT.frame_count(dir).map(|_| ImageSize { width: 0, height: 0 }),
    }
}

/// `poses.txt` in the sequence, else where the benchmark has it; the former if neither is there.
fn poses_path(dir: &Path, resolved: &Path) -> PathBuf {
    let own = dir.join("poses.txt");
    let root = resolved.parent().and_then(Path::parent);
    let packed = root.map(|root| root.join("poses").join(format!("{}.txt", folder_name(resolved))));
    packed.filter(|packed| !own.exists() && packed.exists()).unwrap_or(own)
}

fn require_lines(what: &str, found: usize, frame_count: usize, path: &Path) -> Result<(), ReplayError> {
    if found >= frame_count {
        return Ok(());
    }
    let expected = format!("a line for each of {frame_count} frames");
    Err(Fault::new(what, expected, format!("{found} lines")).of(path))
}

/// The benchmark names its sequences by two digits, which alone would say little in a table.
fn id(name: &str) -> String {
    let number = !name.is_empty() && name.bytes().all(|b| b.is_ascii_digit());
    if number { format!("odometry_{name}") } else { name.to_owned() }
}

/// Looks through a sequence.
fn check(inspection: &mut Inspection) {
    let dir = inspection.dir.clone();
    let keys = if dir.join(LASER.folder).is_dir() { KEYS.len() } else { 2 };
    inspection.calibration(&dir.join(CALIBRATION), ':', &KEYS[..keys]);
    inspection.stereo(LEFT, RIGHT);
    inspection.lines("times", &dir.join(STAMPS), |text| parse_seconds(text).map(|times| times.len()));
    let resolved = resolve(&dir).unwrap_or_else(|_| dir.clone());
    let poses = poses_path(&dir, &resolved);
    inspection.lines("poses", &poses, |text| parse_poses(text).map(|poses| poses.len()));
    inspection.laser(LASER);
    // The benchmark has none.
    if dir.join(ORIGINS.folder).is_dir() {
        inspection.files("laser origins", ORIGINS, ItemState::Optional, |frame, path| {
            check_origins(path, &LASER.path(&dir, frame))
        });
    }
}

#[cfg(test)]
mod tests;
