//! KITTI raw drives (Geiger et al., "Vision meets robotics: the KITTI dataset", IJRR 2013), synced and rectified.

use std::path::{Path, PathBuf};

use evigrid_core::{Frame, Pose};

use crate::calibration::{RectifiedPair, image_size, pose, rectified_pair, rotation};
use crate::folder::{FrameFiles, folder_name, resolve};
use crate::frame_parts::{FrameParts, ScanFiles, require_frame};
use crate::oxts::{MercatorWorld, Packet, parse_packet};
use crate::stamps::parse_dates;
use crate::text::{Fault, KeyValues, excerpt, read_text};
use crate::{ReplayError, Sequence, SequenceInfo};

pub(crate) const LEFT: FrameFiles = FrameFiles { folder: "image_00/data", digits: 10, extension: "png" };
pub(crate) const RIGHT: FrameFiles = FrameFiles { folder: "image_01/data", ..LEFT };
pub(crate) const OXTS: FrameFiles = FrameFiles { folder: "oxts/data", digits: 10, extension: "txt" };
pub(crate) const LASER: FrameFiles =
    FrameFiles { folder: "velodyne_points/data", digits: 10, extension: "bin" };
pub(crate) const STAMPS: &str = "image_00/timestamps.txt";
/// A calibration file of the day, its keys and how many numbers each holds.
pub(crate) type CalibrationKeys = (&'static str, &'static [(&'static str, usize)]);
/// What is needed of the calibration of the day, in the drive's parent folder.
pub(crate) const CALIBRATION: [CalibrationKeys; 3] = [
    (
        "calib_cam_to_cam.txt",
        &[("S_rect_00", 2), ("R_rect_00", 9), ("P_rect_00", 12), ("S_rect_01", 2), ("P_rect_01", 12)],
    ),
    ("calib_velo_to_cam.txt", &[("R", 9), ("T", 3)]),
    ("calib_imu_to_velo.txt", &[("R", 9), ("T", 3)]),
];

/// A drive of the KITTI raw data: grey stereo pair, GPS/IMU poses, Velodyne.
///
/// The world is x east, y north, z up, metres, origin at the drive's first GPS position. Frame numbers are the file
/// numbers in `image_00/data`; a frame without a Velodyne file has no scan. Scans are taken as recorded, that is,
/// not corrected for the car's motion while the laser turned.
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
    /// If a calibration file, the time stamps, the left images or the first GPS packet are missing or wrong. The
    /// frames themselves are looked at when they are read.
    pub fn open(dir: &Path) -> Result<Self, ReplayError> {
        let resolved = resolve(dir)?;
        let name = folder_name(&resolved);
        if name.ends_with("_extract") {
            let fault =
                Fault::new("KITTI raw drive", "synced and rectified images (..._sync)", excerpt(&name));
            return Err(fault.of(dir));
        }
        let day = resolved.parent().unwrap_or(&resolved);
        let cameras = read_cameras(&day.join(CALIBRATION[0].0))?;
        let camera_from_laser = read_rigid(&day.join(CALIBRATION[1].0))?;
        let laser_from_imu = read_rigid(&day.join(CALIBRATION[2].0))?;
        let imu_from_laser = laser_from_imu.inverse();
        let left_from_laser = cameras.left_from_camera * camera_from_laser;
        let frame_count = LEFT.frame_count(dir)?;
        Ok(Self {
            info: SequenceInfo {
                id: name.strip_suffix("_sync").unwrap_or(&name).to_owned(),
                layout: "kitti-raw",
                rig: cameras.pair.rig,
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

impl Sequence for KittiRaw {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        Ok(self.world_from_imu(index)? * self.imu_from_left)
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        let map_from_imu = map_from_world * self.world_from_imu(index)?;
        FrameParts {
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
        }
        .read(self.info.rig)
    }
}

/// What `calib_cam_to_cam.txt` says of the grey pair.
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
    let size = image_size("S_rect_00", table.numbers("S_rect_00")?)?;
    let right_size = image_size("S_rect_01", table.numbers("S_rect_01")?)?;
    if right_size != size {
        let (expected, found) = (format!("the size of S_rect_00, {size:?}"), format!("{right_size:?}"));
        return Err(Fault::new("S_rect_01", expected, found));
    }
    let names = ["P_rect_00", "P_rect_01"];
    let pair = rectified_pair(names, &table.numbers(names[0])?, &table.numbers(names[1])?, size)?;
    let rectified_from_camera = rotation("R_rect_00", &table.numbers("R_rect_00")?)?;
    Ok(Cameras { pair, left_from_camera: pair.left_from_rectified * rectified_from_camera })
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

/// The packet that the world's scale and origin come from: the first that is there, so that a drive may be cut.
fn first_packet(dir: &Path) -> Result<Packet, ReplayError> {
    match OXTS.numbers(dir)?.first() {
        Some(&first) => read_packet(&OXTS.path(dir, first)),
        None => {
            let fault = Fault::new("GPS/IMU packets", format!("files {}", OXTS.pattern()), "none");
            Err(fault.of(&dir.join(OXTS.folder)))
        }
    }
}

pub(crate) fn read_packet(path: &Path) -> Result<Packet, ReplayError> {
    parse_packet(&read_text("GPS/IMU packet", path)?).map_err(|fault| fault.of(path))
}

#[cfg(test)]
mod tests;
