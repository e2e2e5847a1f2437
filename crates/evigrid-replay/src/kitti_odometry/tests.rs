#![allow(clippy::unwrap_used)]

use super::*;
use crate::fixtures::{self, Recording};
use crate::map_from_world;
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::fs;

#[test]
fn the_first_camera_is_level_and_poses_lead_on_from_it() {
    let recording = fixtures::kitti_odometry(3);
    let sequence = KittiOdometry::open(&recording.dir).unwrap();
    assert_eq!((sequence.info().id.as_str(), sequence.info().frame_count), ("odometry_07", 3));
    let pose = sequence.world_from_left(2).unwrap();
    assert!((pose.translation.vector - Vector3::new(4.0, 0.0, 0.0)).norm() < 1e-12, "{pose}");
    for (camera, world) in
        [(Vector3::z(), Vector3::x()), (Vector3::x(), -Vector3::y()), (Vector3::y(), -Vector3::z())]
    {
        assert!((pose.rotation * camera - world).norm() < 1e-12, "{camera}");
    }
}

#[test]
fn a_frame_holds_its_scan_in_the_map_frame() {
    let recording = fixtures::kitti_odometry(3);
    let sequence = KittiOdometry::open(&recording.dir).unwrap();
    let map_from_world = map_from_world(&sequence.world_from_left(1).unwrap());
    let frame = sequence.frame(2, &map_from_world).unwrap();
    assert_eq!(frame.stamp_ns(), 2_500_000_000);
    // 2 m after the origin of the map, and 10 m ahead of a laser that is 0.3 m behind the camera.
    let laser = frame.laser().unwrap();
    let in_map = laser.map_from_laser() * Point3::from(laser.points()[0].map(f64::from));
    assert!((in_map - Point3::new(11.7, 0.0, 0.0)).norm() < 1e-12, "{in_map}");
    assert!((frame.map_from_left().translation.vector - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-12);
}

#[test]
fn rays_start_where_the_file_of_origins_says() {
    let recording = fixtures::kitti_odometry(3);
    fs::create_dir(recording.dir.join("velodyne_origins")).unwrap();
    recording.write("velodyne_origins/000001.bin", fixtures::origin_bytes(&[[0.5, 0.25, -0.125]]));
    let sequence = KittiOdometry::open(&recording.dir).unwrap();
    let frame = |index| sequence.frame(index, &Pose::identity());
    assert_eq!(frame(0).unwrap().laser().unwrap().origins(), None);
    assert_eq!(frame(1).unwrap().laser().unwrap().origins(), Some(&[[0.5, 0.25, -0.125]][..]));
    let alone = sequence.laser(1, &Pose::identity()).unwrap().unwrap();
    assert_eq!(alone.origins(), Some(&[[0.5, 0.25, -0.125]][..]));
    recording.write("velodyne_origins/000002.bin", fixtures::origin_bytes(&[[0.0; 3]; 2]));
    let error = frame(2).unwrap_err().to_string();
    assert!(error.starts_with("laser origins: expected one for each of 1 points, found 2: "), "{error}");
    assert!(error.ends_with("velodyne_origins/000002.bin"), "{error}");
    recording.remove("velodyne/000001.bin");
    let error = frame(1).unwrap_err().to_string();
    assert!(
        error.starts_with("laser origins: expected the scan that they belong to, found none: "),
        "{error}"
    );
}

#[test]
fn poses_lie_in_the_sequence_or_where_the_benchmark_packs_them() {
    let recording = fixtures::kitti_odometry(2);
    let packed = recording.dir.join("../../poses");
    fs::create_dir(&packed).unwrap();
    fs::rename(recording.dir.join("poses.txt"), packed.join("07.txt")).unwrap();
    assert_eq!(KittiOdometry::open(&recording.dir).unwrap().info().frame_count, 2);
    fs::remove_dir_all(&packed).unwrap();
    let error = KittiOdometry::open(&recording.dir).unwrap_err().to_string();
    assert!(error.starts_with("cannot read poses: ") && error.ends_with("07/poses.txt"), "{error}");
}

#[test]
fn without_laser_no_transform_to_it_is_needed() {
    let recording = fixtures::kitti_odometry(2);
    recording.replace("calib.txt", "Tr:", "Other:");
    let error = KittiOdometry::open(&recording.dir).unwrap_err().to_string();
    assert!(error.starts_with("calibration key Tr: expected a line \"Tr: ...\", found none: "), "{error}");
    fs::remove_dir_all(recording.dir.join("velodyne")).unwrap();
    let sequence = KittiOdometry::open(&recording.dir).unwrap();
    assert!(sequence.frame(0, &Pose::identity()).unwrap().laser().is_none());
}

fn error_of(damage: impl Fn(&Recording)) -> String {
    let recording = fixtures::kitti_odometry(2);
    damage(&recording);
    let frame = KittiOdometry::open(&recording.dir).and_then(|s| s.frame(1, &Pose::identity()));
    let message = frame.unwrap_err().to_string();
    message.replace(&format!("{}/", recording.dir.display()), "")
}

#[test]
fn damage_is_told_in_one_line() {
    assert_eq!(
        error_of(|r| r.replace("calib.txt", "P1: 10 0 5 -5 0 10", "P1: 11 0 5 -5 0 11")),
        "P1: expected the focal length of P0, 10 px, found 11 px: calib.txt"
    );
    assert_eq!(
        error_of(|r| r.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n")),
        "poses: expected a line for each of 2 frames, found 1 lines: poses.txt"
    );
    assert_eq!(
        error_of(|r| r.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 3 0\n")),
        "pose: expected a rotation matrix, found rows that are 8.0e0 from orthonormal, \
         determinant 3.0000: poses.txt:2"
    );
    assert_eq!(
        error_of(|r| r.write("times.txt", "0\nlater\n")),
        "time: expected a finite number, found \"later\": times.txt:2"
    );
    assert_eq!(
        error_of(|r| r.write("image_0/000001.png", fixtures::png_bytes(fixtures::gradient(13, 8)))),
        "frame 1: image sizes differ: expected 12x8, found 13x8 (left image): image_0/000001.png"
    );
}

proptest! {
    #[test]
    fn any_calibration_is_read_without_panic(
        text in "\\PC*|((P0|P1|Tr): ([-0-9.e]{1,5} ){12}\n){1,4}",
        laser: bool,
    ) {
        let _ = parse_calibration(&text, ImageSize { width: 12, height: 8 }, laser).is_ok();
    }
}
