#![allow(clippy::unwrap_used)]

use super::*;
use crate::fixtures::{self, Recording};
use crate::map_from_world;
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::fs;

/// 0.00001 degrees of the equator, metres: 6378137 * pi / 180 / 100000.
const STEP_M: f64 = 1.113_194_9;

fn open(recording: &Recording) -> KittiRaw {
    KittiRaw::open(&recording.dir).unwrap()
}

fn forward(pose: &Pose) -> Vector3<f64> {
    pose.rotation * Vector3::z()
}

#[test]
fn the_chain_leads_from_the_world_over_the_imu_to_the_rectified_camera() {
    let recording = fixtures::kitti_raw(3);
    let drive = open(&recording);
    assert_eq!((drive.info().id.as_str(), drive.info().frame_count), ("2001_01_01_drive_0001", 3));
    let rig = drive.info().rig;
    assert_eq!((rig.width, rig.height, rig.focal_px, rig.baseline_m), (12, 8, 10.0, 0.5));
    for index in 0..3 {
        // Eastwards from the first packet; the camera is 0.3 m in front of the IMU.
        let pose = drive.world_from_left(index).unwrap();
        let expected = Vector3::new(0.3 + STEP_M * index as f64, 0.0, 0.0);
        assert!((pose.translation.vector - expected).norm() < 1e-6, "{pose}");
        assert!((forward(&pose) - Vector3::x()).norm() < 1e-12, "{pose}");
    }
}

#[test]
fn a_frame_holds_images_time_pose_and_scan_in_the_map_frame() {
    let recording = fixtures::kitti_raw(3);
    let drive = open(&recording);
    let map_from_world = map_from_world(&drive.world_from_left(0).unwrap());
    let frame = drive.frame(2, &map_from_world).unwrap();
    assert_eq!((frame.index(), frame.left().row(1)[3], frame.right().row(7)[0]), (2, 31, 7));
    // 2001-01-01 is day 11323 of the epoch.
    assert_eq!(frame.stamp_ns(), (11_323 * 86_400 + 2) * 1_000_000_000 + 7);
    let file = fs::read(recording.dir.join("image_00/data/0000000002.png")).unwrap();
    assert_eq!(frame.left_png().unwrap().as_ref(), file);
    // The point is 10 m in front of the laser, 9.7 m in front of the camera, in the middle of its image.
    let laser = frame.laser().unwrap();
    let in_map = laser.map_from_laser() * Point3::from(laser.points()[0].map(f64::from));
    assert!((in_map - Point3::new(2.0 * STEP_M + 9.7, 0.0, 0.0)).norm() < 1e-6, "{in_map}");
    let in_left = frame.map_from_left().inverse() * in_map;
    assert!((in_left - Point3::new(0.0, 0.0, 9.7)).norm() < 1e-9, "{in_left}");
    let alone = drive.laser(2, &map_from_world).unwrap().unwrap();
    assert_eq!((alone.points(), alone.map_from_laser()), (laser.points(), laser.map_from_laser()));
}

#[test]
fn the_rectifying_rotation_turns_the_camera() {
    let recording = fixtures::kitti_raw(1);
    // x_rect = -z, y_rect = y, z_rect = x: the rectified camera looks to the right of the camera, southwards.
    recording.replace(
        "../calib_cam_to_cam.txt",
        "R_rect_00: 1 0 0 0 1 0 0 0 1",
        "R_rect_00: 0 0 -1 0 1 0 1 0 0",
    );
    let pose = open(&recording).world_from_left(0).unwrap();
    assert!((forward(&pose) + Vector3::y()).norm() < 1e-12, "{pose}");
    assert!((pose.translation.vector - Vector3::new(0.3, 0.0, 0.0)).norm() < 1e-12, "{pose}");
}

#[test]
fn a_left_camera_beside_the_rectified_origin_is_honoured() {
    let recording = fixtures::kitti_raw(1);
    // P_rect_00 shifts by 1 / 10 = 0.1 m: the left camera is 0.1 m further left (north), the baseline longer.
    recording.replace("../calib_cam_to_cam.txt", "P_rect_00: 10 0 5 0 ", "P_rect_00: 10 0 5 1 ");
    let drive = open(&recording);
    let position = drive.world_from_left(0).unwrap().translation.vector;
    assert!((position - Vector3::new(0.3, 0.1, 0.0)).norm() < 1e-12, "{position}");
    assert!((drive.info().rig.baseline_m - 0.6).abs() < 1e-12);
}

#[test]
fn a_frame_without_scan_is_a_frame() {
    let recording = fixtures::kitti_raw(2);
    recording.remove("velodyne_points/data/0000000001.bin");
    let drive = open(&recording);
    assert!(drive.frame(0, &Pose::identity()).unwrap().laser().is_some());
    assert!(drive.frame(1, &Pose::identity()).unwrap().laser().is_none());
    assert!(drive.laser(1, &Pose::identity()).unwrap().is_none());
    fs::remove_dir_all(recording.dir.join("velodyne_points")).unwrap();
    assert!(open(&recording).frame(0, &Pose::identity()).unwrap().laser().is_none());
}

#[test]
fn a_drive_may_be_cut_at_its_start() {
    let recording = fixtures::kitti_raw(3);
    for name in ["image_00/data/0000000000.png", "image_01/data/0000000000.png", "oxts/data/0000000000.txt"] {
        recording.remove(name);
    }
    let drive = open(&recording);
    assert_eq!(drive.info().frame_count, 3);
    assert!(
        (drive.world_from_left(1).unwrap().translation.vector - Vector3::new(0.3, 0.0, 0.0)).norm() < 1e-9
    );
    assert!(drive.world_from_left(0).unwrap_err().to_string().ends_with("oxts/data/0000000000.txt"));
}

/// The error of opening a damaged drive, or of reading its frame 1: one line, which ends with the path.
fn error_of(damage: impl Fn(&Recording)) -> String {
    let recording = fixtures::kitti_raw(2);
    damage(&recording);
    let frame = KittiRaw::open(&recording.dir).and_then(|drive| drive.frame(1, &Pose::identity()));
    let message = frame.unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    let root = fs::canonicalize(recording.dir.parent().unwrap()).unwrap();
    message.replace(&format!("{}/", root.display()), "").replace("2001_01_01_drive_0001_sync/", "")
}

#[test]
fn damaged_calibration_is_told_in_one_line() {
    let cameras = "../calib_cam_to_cam.txt";
    for (from, to, expected) in [
        (
            "P_rect_01",
            "Q_rect_01",
            "calibration key P_rect_01: expected a line \"P_rect_01: ...\", found none: calib_cam_to_cam.txt",
        ),
        (
            "P_rect_00: 10 0 5 0 0 10",
            "P_rect_00: 10 0 5 0 0 11",
            "P_rect_00: expected equal focal lengths fx = fy > 0, found fx 10 px, fy 11 px: \
             calib_cam_to_cam.txt",
        ),
        (
            "P_rect_01: 10 0 5 -5 0 10",
            "P_rect_01: 12 0 5 -5 0 12",
            "P_rect_01: expected the focal length of P_rect_00, 10 px, found 12 px: calib_cam_to_cam.txt",
        ),
        (
            "S_rect_01: 1.200000e+01",
            "S_rect_01: 1.300000e+01",
            "S_rect_01: expected the size of S_rect_00, (12, 8), found (13, 8): calib_cam_to_cam.txt",
        ),
        (
            "R_rect_00: 1",
            "R_rect_00: nan",
            "calibration key R_rect_00: expected a finite number, found \"nan\": calib_cam_to_cam.txt:3",
        ),
        (
            "R_rect_00: 1",
            "R_rect_00: 2",
            "R_rect_00: expected a rotation matrix, found rows that are 3.0e0 from orthonormal, \
             determinant 2.0000: calib_cam_to_cam.txt",
        ),
    ] {
        assert_eq!(error_of(|recording| recording.replace(cameras, from, to)), expected);
    }
}

#[test]
fn damaged_frames_are_told_in_one_line() {
    let oxts = "oxts/data/0000000001.txt";
    assert_eq!(
        error_of(|r| r.write(oxts, "1 2 3\n")),
        "oxts packet: expected 30 numbers, found 3: oxts/data/0000000001.txt:1"
    );
    let right = "image_01/data/0000000001.png";
    assert_eq!(
        error_of(|r| r.write(right, fixtures::png_bytes(fixtures::gradient(12, 9)))),
        format!("frame 1: image sizes differ: expected 12x8, found 12x9 (right image): {right}")
    );
    let cut = error_of(|r| r.write(right, &fixtures::png_bytes(fixtures::gradient(12, 8))[..50]));
    assert!(cut.starts_with("image: expected a whole PNG file, found ") && cut.ends_with(right), "{cut}");
    let missing = error_of(|r| r.remove(right));
    assert!(missing.starts_with("cannot read right image: ") && missing.ends_with(right), "{missing}");
    let scan = "velodyne_points/data/0000000001.bin";
    assert_eq!(
        error_of(|r| r.write(scan, [0; 17])),
        format!("laser scan: expected a multiple of 16 bytes, found 17 bytes: {scan} at byte 16")
    );
    assert_eq!(
        error_of(|r| r.write(scan, fixtures::scan_bytes(&[[0.0, 0.0, f32::INFINITY]]))),
        format!("laser scan: expected finite coordinates, found (0, 0, inf): {scan} at byte 0")
    );
}

#[test]
fn damaged_lists_are_told_in_one_line() {
    let stamps = "image_00/timestamps.txt";
    assert_eq!(
        error_of(|r| r.write(stamps, "2001-01-01 00:00:00\n")),
        format!("time stamps: expected a line for each of 2 frames, found 1 lines: {stamps}")
    );
    assert_eq!(
        error_of(|r| r.write(stamps, "2001-01-01 00:00:00\nyesterday\n")),
        format!("time stamp: expected a date YYYY-MM-DD HH:MM:SS.nnnnnnnnn, found \"yesterday\": {stamps}:2")
    );
    assert_eq!(
        error_of(|r| (0..2).for_each(|i| r.remove(&format!("oxts/data/000000000{i}.txt")))),
        "GPS/IMU packets: expected files oxts/data/NNNNNNNNNN.txt, found none: oxts/data"
    );
    let recording = fixtures::kitti_raw(2);
    let error = open(&recording).frame(2, &Pose::identity()).unwrap_err().to_string();
    assert!(error.starts_with("frame 2 does not exist: expected 0..2: "), "{error}");
}

#[test]
fn unrectified_drives_are_refused() {
    let recording = fixtures::kitti_raw(1);
    let extract = recording.dir.with_file_name("2001_01_01_drive_0001_extract");
    fs::rename(&recording.dir, &extract).unwrap();
    let error = KittiRaw::open(&extract).unwrap_err().to_string();
    assert!(
        error.starts_with("KITTI raw drive: expected synced and rectified images (..._sync), found "),
        "{error}"
    );
}

proptest! {
    #[test]
    fn any_calibration_is_read_without_panic(
        text in "\\PC*|([SRP]_rect_0[01]: ([-0-9.e]{1,5} ){2,12}\n){1,6}"
    ) {
        let _ = (parse_cameras(&text).is_ok(), parse_rigid(&text).is_ok());
    }

    #[test]
    fn any_number_in_a_calibration_is_taken_without_panic(p in prop::array::uniform12(-1e3..1e3), r: f64) {
        let row = p.map(|v: f64| v.to_string()).join(" ");
        let text = format!(
            "S_rect_00: 12 8\nS_rect_01: 12 8\nR_rect_00: 1 0 0 0 1 0 0 0 {r}\n\
             P_rect_00: {row}\nP_rect_01: {row}\n"
        );
        let _ = parse_cameras(&text).is_ok();
    }
}
