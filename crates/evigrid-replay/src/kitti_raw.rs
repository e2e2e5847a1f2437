//! KITTI raw drives, synced and rectified (Geiger et al., "Vision meets robotics: the KITTI dataset", IJRR
//! 2013).

use std::path::{Path, PathBuf};

use evigrid_core::{Frame, LaserScan, Mounting, Pose};

use crate::calibration::{ProjectionMatrix, RectifiedPair, pose, rectified_pair, rotation};
use crate::check_folder::{CalibrationKey, Inspection};
use crate::folder::{FrameFiles, folder_name, resolve};
use crate::frame_parts::{FrameParts, ScanFiles, require_frame};
use crate::image_size::ImageSize;
use crate::layout::LayoutSpec;
use crate::oxts::{MercatorWorld, Packet, parse_packet};
use crate::stamps::parse_dates;
use crate::text::{Fault, KeyValues, excerpt, read_text};
use crate::{ItemState, Layout, ReplayError, Sequence, SequenceInfo};

const LEFT: FrameFiles = FrameFiles { folder: "image_00/data", digits: 10, extension: "png" };
const RIGHT: FrameFiles = FrameFiles { folder: "image_01/data", ..LEFT };
const OXTS: FrameFiles = FrameFiles { folder: "oxts/data", digits: 10, extension: "txt" };
const LASER: FrameFiles = FrameFiles { folder: "velodyne_points/data", digits: 10, extension: "bin" };
const STAMPS: &str = "image_00/timestamps.txt";
/// Calibration of the cameras; as all calibration of the day, it lies in the drive's parent folder.
const CAMERAS: &str = "calib_cam_to_cam.txt";
const CAMERA_FROM_LASER: &str = "calib_velo_to_cam.txt";
const LASER_FROM_IMU: &str = "calib_imu_to_velo.txt";
/// Keys of the camera calibration that are used.
const CAMERA_KEYS: [CalibrationKey; 5] = [
    CalibrationKey::new("S_rect_00", 2),
    CalibrationKey::new("R_rect_00", 9),
    CalibrationKey::new("P_rect_00", 12),
    CalibrationKey::new("S_rect_01", 2),
    CalibrationKey::new("P_rect_01", 12),
];
/// Keys of a calibration between two sensors.
const RIGID_KEYS: [CalibrationKey; 2] = [CalibrationKey::new("R", 9), CalibrationKey::new("T", 3)];
/// Mounting of the recording car's cameras: 1.65 m above the road (Geiger et al., IJRR 2013, Fig. 3). The
/// pitch is nominal: the poses carry the real tilt.
const MOUNTING: Mounting = Mounting::over_middle(1.65, 0.0);

impl Layout {
    /// Layout of a [`KittiRaw`] drive.
    pub const KITTI_RAW: Self = Self(&LayoutSpec {
        name: "kitti-raw",
        wants: "image_00, image_01, oxts, optionally velodyne_points; calib_cam_to_cam.txt, \
                calib_velo_to_cam.txt and calib_imu_to_velo.txt in the parent folder",
        fits: |dir| dir.join("image_00").is_dir() || dir.join("oxts").is_dir(),
        open: |dir| Ok(Box::new(KittiRaw::open(dir)?)),
        check,
    });
}

/// A drive of the KITTI raw data: grey stereo pair, GPS/IMU poses, Velodyne.
///
/// The world is x east, y north, z up, metres, origin at the drive's first GPS position. Frame numbers are
/// the file numbers in `image_00/data`; a frame without a Velodyne file has no scan. Scans are taken as
/// recorded, that is, not corrected for the car's motion while the laser turned.
#[derive(Debug)]
pub struct KittiRaw {
    dir: PathBuf,
    info: SequenceInfo,
    stamps_ns: Vec<i64>,
    imu_from_laser: Pose,
    imu_from_left: Pose,
    world: MercatorWorld,
}

impl KittiRaw {
    /// Opens a `*_drive_NNNN_sync` folder, whose parent holds the three calibration files of the day.
    ///
    /// # Errors
    /// If a calibration file, the time stamps, the left images or the first GPS packet are missing or wrong.
    /// The frames themselves are looked at when they are read.
    pub fn open(dir: &Path) -> Result<Self, ReplayError> {
        let resolved = resolve(dir)?;
        let name = folder_name(&resolved);
        if name.ends_with("_extract") {
            let fault =
                Fault::new("KITTI raw drive", "synced and rectified images (..._sync)", excerpt(&name));
            return Err(fault.of(dir));
        }
        let day = resolved.parent().unwrap_or(&resolved);
        let cameras = read_cameras(&day.join(CAMERAS))?;
        let camera_from_laser = read_rigid(&day.join(CAMERA_FROM_LASER))?;
        let laser_from_imu = read_rigid(&day.join(LASER_FROM_IMU))?;
        let imu_from_laser = laser_from_imu.inverse();
        let left_from_laser = cameras.left_from_camera * camera_from_laser;
        let frame_count = LEFT.frame_count(dir)?;
        Ok(Self {
            info: SequenceInfo {
                id: name.strip_suffix("_sync").unwrap_or(&name).to_owned(),
                layout: Layout::KITTI_RAW.name(),
                rig: cameras.pair.rig,
                mounting: Some(MOUNTING),
                frame_count,
            },
            stamps_ns: read_stamps(&dir.join(STAMPS), frame_count)?,
            imu_from_laser,
            imu_from_left: imu_from_laser * left_from_laser.inverse(),
            world: MercatorWorld::at(&first_packet(dir)?),
            dir: dir.to_owned(),
        })
    }

    fn world_from_imu(&self, index: usize) -> Result<Pose, ReplayError> {
        require_frame(&self.info, &self.dir, index)?;
        Ok(self.world.world_from_imu(&read_packet(&OXTS.path(&self.dir, index))?))
    }
}

impl KittiRaw {
    /// The places of the parts of a frame.
    fn parts(&self, index: usize, map_from_world: &Pose) -> Result<FrameParts, ReplayError> {
        let map_from_imu = map_from_world * self.world_from_imu(index)?;
        Ok(FrameParts {
            index,
            stamp_ns: self.stamps_ns[index],
            left: LEFT.path(&self.dir, index),
            right: RIGHT.path(&self.dir, index),
            map_from_left: map_from_imu * self.imu_from_left,
            laser: Some(ScanFiles {
                points: LASER.path(&self.dir, index),
                origins: None,
                map_from_laser: map_from_imu * self.imu_from_laser,
            }),
        })
    }
}

impl Sequence for KittiRaw {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        Ok(self.world_from_imu(index)? * self.imu_from_left)
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        self.parts(index, map_from_world)?.read(self.info.rig)
    }

    fn laser(&self, index: usize, map_from_world: &Pose) -> Result<Option<LaserScan>, ReplayError> {
        self.parts(index, map_from_world)?.read_laser()
    }
}

/// The grey pair as `calib_cam_to_cam.txt` describes it.
struct Cameras {
    pair: RectifiedPair,
    /// From camera 0 as mounted to the left camera after rectification.
    left_from_camera: Pose,
}

fn read_cameras(path: &Path) -> Result<Cameras, ReplayError> {
    parse_cameras(&read_text("camera calibration", path)?).map_err(|fault| fault.of(path))
}

fn parse_cameras(text: &str) -> Result<Cameras, Fault> {
    let table = KeyValues::parse(text, ':');
    let size = parse_size(&table, "S_rect_00")?;
    let right_size = parse_size(&table, "S_rect_01")?;
    if right_size != size {
        let expected = format!("the size of S_rect_00, ({}, {})", size.width, size.height);
        let found = format!("({}, {})", right_size.width, right_size.height);
        return Err(Fault::new("S_rect_01", expected, found));
    }
    let (left, right) = (table.numbers("P_rect_00")?, table.numbers("P_rect_01")?);
    let left = ProjectionMatrix::new("P_rect_00", &left)?;
    let pair = rectified_pair(&left, &ProjectionMatrix::new("P_rect_01", &right)?, size)?;
    let rectified_from_camera = rotation("R_rect_00", &table.numbers("R_rect_00")?)?;
    Ok(Cameras { pair, left_from_camera: pair.left_from_rectified * rectified_from_camera })
}

fn parse_size(table: &KeyValues<'_>, key: &str) -> Result<ImageSize, Fault> {
    let [width, height] = table.numbers(key)?;
    ImageSize::from_numbers(key, width, height)
}

fn read_rigid(path: &Path) -> Result<Pose, ReplayError> {
    parse_rigid(&read_text("calibration", path)?).map_err(|fault| fault.of(path))
}

fn parse_rigid(text: &str) -> Result<Pose, Fault> {
    let table = KeyValues::parse(text, ':');
    pose("R", &table.numbers("R")?, &table.numbers("T")?)
}

fn read_stamps(path: &Path, frame_count: usize) -> Result<Vec<i64>, ReplayError> {
    let stamps = parse_dates(&read_text("time stamps", path)?).map_err(|fault| fault.of(path))?;
    if stamps.len() < frame_count {
        let expected = format!("a line for each of {frame_count} frames");
        return Err(Fault::new("time stamps", expected, format!("{} lines", stamps.len())).of(path));
    }
    Ok(stamps)
}

/// The packet that gives the world its scale and origin: the first that is there, so that a drive may be cut.
fn first_packet(dir: &Path) -> Result<Packet, ReplayError> {
    match OXTS.numbers(dir)?.first() {
        Some(&first) => read_packet(&OXTS.path(dir, first)),
        None => {
            let fault = Fault::new("GPS/IMU packets", format!("files {}", OXTS.pattern()), "none");
            Err(fault.of(&dir.join(OXTS.folder)))
        }
    }
}

fn read_packet(path: &Path) -> Result<Packet, ReplayError> {
    parse_packet(&read_text("GPS/IMU packet", path)?).map_err(|fault| fault.of(path))
}

/// Looks through a drive and the calibration of its day.
fn check(inspection: &mut Inspection) {
    let resolved = resolve(&inspection.dir).ok();
    let day = resolved.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    inspection.calibration(&day.join(CAMERAS), ':', &CAMERA_KEYS);
    inspection.calibration(&day.join(CAMERA_FROM_LASER), ':', &RIGID_KEYS);
    inspection.calibration(&day.join(LASER_FROM_IMU), ':', &RIGID_KEYS);
    inspection.stereo(LEFT, RIGHT);
    let stamps = inspection.dir.join(STAMPS);
    inspection.lines("time stamps", &stamps, |text| parse_dates(text).map(|stamps| stamps.len()));
    inspection.files("GPS/IMU packets", OXTS, ItemState::Missing, |_, path| read_packet(path).map(|_| ()));
    inspection.laser(LASER);
}

#[cfg(test)]
mod tests;
