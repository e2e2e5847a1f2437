#![allow(clippy::unwrap_used)]

use super::*;
use crate::{CheckItem, ItemState, fixtures};
use evigrid_core::Mounting;

fn item<'a>(report: &'a CheckReport, name: &str) -> &'a CheckItem {
    report.items.iter().find(|item| item.name == name).unwrap()
}

#[test]
fn whole_recordings_are_usable() {
    for recording in [fixtures::kitti_raw(3), fixtures::kitti_odometry(3)] {
        let report = check(&recording.dir);
        assert!(report.usable(), "{report}");
        assert!(report.items.iter().all(|item| item.state == ItemState::Ok), "{report}");
        assert_eq!((report.frame_count, report.stereo_frames, report.laser_frames), (3, 3, 3));
        assert_eq!(report.rig.unwrap().baseline_m, 0.5);
    }
}

#[test]
fn the_mounting_stands_beside_the_rig() {
    let drive = check(&fixtures::kitti_raw(1).dir);
    assert_eq!(drive.mounting, Some(Mounting::over_middle(1.65, 0.0)));
    let text = drive.to_string();
    let line = text.lines().nth(2);
    assert_eq!(line, Some("camera 1.65 m above the ground, pitch 0 degrees"), "{text}");
    let sequence = check(&fixtures::kitti_odometry(1).dir);
    assert_eq!(sequence.mounting, None);
    let text = sequence.to_string();
    let line = text.lines().nth(2);
    let expected = "mounting over the ground: not told by the data set \
                    (--set input.mounting=[height_m, pitch_deg])";
    assert_eq!(line, Some(expected), "{text}");
    let recording = fixtures::kitti_raw(1);
    recording.remove("../calib_cam_to_cam.txt");
    let text = check(&recording.dir).to_string();
    assert!(text.contains("rig: unknown\n\n") && !text.contains("above the ground"), "{text}");
}

#[test]
fn missing_scans_do_not_matter_to_mapping() {
    let recording = fixtures::kitti_raw(8);
    for index in [1, 4, 5, 6] {
        recording.remove(&format!("velodyne_points/data/000000000{index}.bin"));
    }
    let report = check(&recording.dir);
    let scans = item(&report, "laser scans");
    assert_eq!((scans.state, scans.missing.to_string().as_str()), (ItemState::Optional, "1, 4..7"));
    assert!(report.usable() && report.laser_frames == 4, "{report}");
    assert!(report.to_string().contains("optional  missing 1, 4..7\n"), "{report}");
}

#[test]
fn origins_of_laser_points_are_looked_at_where_there_are_some() {
    let recording = fixtures::kitti_odometry(3);
    std::fs::create_dir(recording.dir.join("velodyne_origins")).unwrap();
    recording.write("velodyne_origins/000001.bin", fixtures::origin_bytes(&[[0.1, 0.0, 0.0]]));
    let report = check(&recording.dir);
    let origins = item(&report, "laser origins");
    assert_eq!((origins.state, origins.missing.to_string().as_str()), (ItemState::Optional, "0, 2"));
    assert!(report.usable(), "{report}");
    recording.write("velodyne_origins/000000.bin", fixtures::origin_bytes(&[[0.0; 3]; 2]));
    recording.remove("velodyne/000001.bin");
    let report = check(&recording.dir);
    assert_eq!(item(&report, "laser origins").faulty.to_string(), "0..2", "{report}");
    assert!(report.problems[0].starts_with("laser origins: expected one for each of 1 points, found 2: "));
    assert!(
        report.problems[1].starts_with("laser origins: expected the scan that they belong to, found none")
    );
}

#[test]
fn every_problem_is_reported_not_the_first_alone() {
    let recording = fixtures::kitti_raw(6);
    recording.replace("../calib_cam_to_cam.txt", "R_rect_00", "R_rect_99");
    recording.replace("../calib_imu_to_velo.txt", "T: 0 0 0", "T: 0 0");
    recording.remove("image_01/data/0000000002.png");
    recording.write("image_01/data/0000000003.png", fixtures::png_bytes(fixtures::gradient(12, 9)));
    recording.write("image_00/data/0000000004.png", &fixtures::png_bytes(fixtures::gradient(12, 8))[..45]);
    recording.write("oxts/data/0000000005.txt", "1 2 3");
    recording.write("velodyne_points/data/0000000000.bin", [0; 15]);
    recording.write("image_00/timestamps.txt", "2001-01-01 00:00:00\n");
    let report = check(&recording.dir);
    assert!(!report.usable());
    for (name, state, missing, faulty) in [
        ("calib_cam_to_cam.txt", ItemState::Faulty, "", ""),
        ("calib_velo_to_cam.txt", ItemState::Ok, "", ""),
        ("calib_imu_to_velo.txt", ItemState::Faulty, "", ""),
        ("left images", ItemState::Faulty, "", "4"),
        ("right images", ItemState::Faulty, "2", "3"),
        ("time stamps", ItemState::Missing, "1..6", ""),
        ("GPS/IMU packets", ItemState::Faulty, "", "5"),
        ("laser scans", ItemState::Faulty, "", "0"),
    ] {
        let item = item(&report, name);
        let found = (item.state, item.missing.to_string(), item.faulty.to_string());
        assert_eq!(found, (state, missing.to_owned(), faulty.to_owned()), "{name}: {report}");
    }
    assert_eq!((report.stereo_frames, report.laser_frames), (3, 5));
    assert_eq!(report.problems.len(), 6, "{report}");
    assert!(report.problems.iter().all(|line| !line.contains('\n')), "{report}");
}

#[test]
fn missing_files_are_named() {
    let recording = fixtures::kitti_odometry(2);
    recording.remove("poses.txt");
    recording.remove("calib.txt");
    let report = check(&recording.dir);
    assert_eq!(item(&report, "poses").state, ItemState::Missing);
    assert_eq!(item(&report, "calib.txt").found, "no file");
    assert_eq!(report.problems.len(), 2, "{report}");
    assert!(!report.usable());
}

#[test]
fn a_pair_without_calibration_has_an_assumed_rig() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["im2.png", "im6.png"] {
        fixtures::write_png(&dir.path().join(name), fixtures::gradient(5, 4));
    }
    let report = check(dir.path());
    assert!(report.usable() && report.rig_is_assumed && report.stereo_frames == 1, "{report}");
    assert!(report.to_string().contains("(assumed: metres are nominal)"), "{report}");
    fixtures::write_png(&dir.path().join("im6.png"), fixtures::gradient(6, 4));
    let report = check(dir.path());
    assert!(!report.usable() && report.problems[0].contains("expected 5x4, found 6x4"), "{report}");
}

#[test]
fn unknown_folders_are_a_problem() {
    let dir = tempfile::tempdir().unwrap();
    let report = check(dir.path());
    assert!(!report.usable() && report.layout.is_none() && report.problems.len() == 1, "{report}");
    assert!(!check(Path::new("/nowhere/at/all")).usable());
}
