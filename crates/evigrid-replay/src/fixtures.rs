//! Small recordings on disk for the tests of this crate, with numbers that can be worked out by hand.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use tempfile::TempDir;

/// Image size of the fixtures, pixels.
pub const SIZE: (u32, u32) = (12, 8);

/// A recording in a temporary folder that lives as long as this value.
pub struct Recording {
    pub dir: PathBuf,
    _root: TempDir,
}

impl Recording {
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.dir.join(name), content).unwrap();
    }

    pub fn replace(&self, name: &str, from: &str, to: &str) {
        let text = fs::read_to_string(self.dir.join(name)).unwrap();
        assert!(text.contains(from), "{name} does not contain {from}");
        self.write(name, text.replace(from, to));
    }

    pub fn remove(&self, name: &str) {
        fs::remove_file(self.dir.join(name)).unwrap();
    }
}

pub fn gradient(width: u32, height: u32) -> DynamicImage {
    GrayImage::from_fn(width, height, |x, y| Luma([(10 * x + y) as u8])).into()
}

pub fn png_bytes(image: DynamicImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

pub fn write_png(path: &Path, image: DynamicImage) {
    fs::write(path, png_bytes(image)).unwrap();
}

pub fn scan_bytes(points: &[[f32; 3]]) -> Vec<u8> {
    points.iter().flat_map(|[x, y, z]| [*x, *y, *z, 0.5]).flat_map(f32::to_le_bytes).collect()
}

pub fn origin_bytes(origins: &[[f32; 3]]) -> Vec<u8> {
    origins.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
}

pub fn oxts_line(latitude: f64, longitude: f64, yaw: f64) -> String {
    format!("{latitude} {longitude} 100 0 0 {yaw}{}\n", " 0".repeat(24))
}

/// A raw drive at the equator that starts eastwards and moves 0.00001 degrees (1.1132 m) a frame. IMU and
/// laser are at one place; camera 0 is 0.3 m in front of them, level; its rectification is a shift of
/// nothing. Every scan is one point, 10 m ahead.
pub fn kitti_raw(frame_count: usize) -> Recording {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("2001_01_01_drive_0001_sync");
    for folder in ["image_00/data", "image_01/data", "oxts/data", "velodyne_points/data"] {
        fs::create_dir_all(dir.join(folder)).unwrap();
    }
    let recording = Recording { dir, _root: root };
    recording.write(
        "../calib_cam_to_cam.txt",
        "calib_time: 09-Jan-2012 13:57:47\n\
         S_rect_00: 1.200000e+01 8.000000e+00\n\
         R_rect_00: 1 0 0 0 1 0 0 0 1\n\
         P_rect_00: 10 0 5 0 0 10 3 0 0 0 1 0\n\
         S_rect_01: 1.200000e+01 8.000000e+00\n\
         P_rect_01: 10 0 5 -5 0 10 3 0 0 0 1 0\n",
    );
    recording.write("../calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -0.3\n");
    recording.write("../calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
    let stamps: String = (0..frame_count).map(|i| format!("2001-01-01 00:00:{i:02}.000000007\n")).collect();
    recording.write("image_00/timestamps.txt", stamps);
    for index in 0..frame_count {
        for camera in ["image_00", "image_01"] {
            recording.write(&format!("{camera}/data/{index:010}.png"), png_bytes(gradient(SIZE.0, SIZE.1)));
        }
        recording.write(&format!("oxts/data/{index:010}.txt"), oxts_line(0.0, 1e-5 * index as f64, 0.0));
        recording.write(&format!("velodyne_points/data/{index:010}.bin"), scan_bytes(&[[10.0, 0.0, 0.0]]));
    }
    recording
}

/// An odometry sequence that moves 2 m forward a frame; the laser is 0.3 m behind the camera. Every scan is
/// one point, 10 m ahead of the laser.
pub fn kitti_odometry(frame_count: usize) -> Recording {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("sequences/07");
    for folder in ["image_0", "image_1", "velodyne"] {
        fs::create_dir_all(dir.join(folder)).unwrap();
    }
    let recording = Recording { dir, _root: root };
    recording.write(
        "calib.txt",
        "P0: 10 0 5 0 0 10 3 0 0 0 1 0\nP1: 10 0 5 -5 0 10 3 0 0 0 1 0\n\
         Tr: 0 -1 0 0 0 0 -1 0 1 0 0 -0.3\n",
    );
    recording.write("times.txt", (0..frame_count).map(|i| format!("{i}.5e+00\n")).collect::<String>());
    let poses: String = (0..frame_count).map(|i| format!("1 0 0 0 0 1 0 0 0 0 1 {}\n", 2 * i)).collect();
    recording.write("poses.txt", poses);
    for index in 0..frame_count {
        for camera in ["image_0", "image_1"] {
            recording.write(&format!("{camera}/{index:06}.png"), png_bytes(gradient(SIZE.0, SIZE.1)));
        }
        recording.write(&format!("velodyne/{index:06}.bin"), scan_bytes(&[[10.0, 0.0, 0.0]]));
    }
    recording
}
