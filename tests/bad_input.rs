//! Bad input gives one clear error line and exit code 2, never a panic, and leaves nothing half-written.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::io::Write;
use std::path::Path;

use common::{TinyDrive, evigrid, names, path, stderr};

/// The run fails with one line that holds all the parts, and leaves no file.
fn check_refused(output: &std::process::Output, out: &Path, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    let errors: Vec<_> = text.lines().filter(|l| l.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{text}");
    assert_eq!(text.lines().last(), Some(errors[0]), "{text}");
    assert!(!text.contains("panicked"), "{text}");
    for part in parts {
        assert!(errors[0].contains(part), "expected {part:?} in: {}", errors[0]);
    }
    assert!(names(out).is_empty(), "left behind: {:?}", names(out));
}

fn check_spoilt_drive(spoil: impl Fn(&TinyDrive), parts: &[&str]) {
    let drive = TinyDrive::new(3);
    spoil(&drive);
    let out = drive.root.path().join("out");
    check_refused(&drive.run(&out, &[]), &out, parts);
}

fn replace(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{from:?} is not in {}", file.display());
    fs::write(file, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn a_drive_without_fault_runs() {
    let drive = TinyDrive::new(3);
    let out = drive.root.path().join("out");
    let output = drive.run(&out, &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(names(&out).contains(&"summary.csv".to_owned()));
}

#[test]
fn missing_calibration_key() {
    let spoil = |d: &TinyDrive| replace(&d.calibration(), "P_rect_01", "Q_rect_01");
    check_spoilt_drive(spoil, &["P_rect_01", "calib_cam_to_cam.txt"]);
}

#[test]
fn unequal_focal_lengths() {
    let spoil = |d: &TinyDrive| {
        replace(&d.calibration(), "P_rect_00: 80 0 47.5 0 0 80", "P_rect_00: 80 0 47.5 0 0 81")
    };
    check_spoilt_drive(spoil, &["P_rect_00", "80", "81", "calib_cam_to_cam.txt"]);
}

#[test]
fn image_sizes_that_differ() {
    let spoil = |d: &TinyDrive| image::GrayImage::new(90, 48).save(d.image("image_01", 1)).unwrap();
    check_spoilt_drive(spoil, &["96x48", "90x48", "0000000001.png"]);
}

#[test]
fn truncated_png() {
    let spoil = |d: &TinyDrive| {
        let file = d.image("image_00", 2);
        let bytes = fs::read(&file).unwrap();
        fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    };
    check_spoilt_drive(spoil, &["0000000002.png"]);
}

#[test]
fn velodyne_file_of_odd_length() {
    let spoil = |d: &TinyDrive| {
        let bytes = fs::read(d.scan(1)).unwrap();
        fs::write(d.scan(1), &bytes[..bytes.len() - 3]).unwrap();
    };
    check_spoilt_drive(spoil, &["16", "797", "0000000001.bin"]);
}

#[test]
fn velodyne_point_that_is_no_number() {
    let spoil = |d: &TinyDrive| {
        let mut bytes = fs::read(d.scan(0)).unwrap();
        bytes[32..36].copy_from_slice(&f32::NAN.to_le_bytes());
        fs::write(d.scan(0), bytes).unwrap();
    };
    check_spoilt_drive(spoil, &["finite", "NaN", "0000000000.bin", "byte 32"]);
}

#[test]
fn oxts_line_with_too_few_fields() {
    let spoil = |d: &TinyDrive| fs::write(d.oxts(1), "49.0 8.4 114 0 0 0\n").unwrap();
    check_spoilt_drive(spoil, &["30", "6", "0000000001.txt"]);
}

#[test]
fn wrong_arguments() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    let refused = |more: &[&str], parts: &[&str]| check_refused(&drive.run(&out, more), &out, parts);
    refused(&["--frames", "1..1"], &["run.frames", "at least one frame", "1..1"]);
    refused(&["--frames", "0..9"], &["run.frames", "0..2", "0..9"]);
    refused(&["--frames", "x"], &["run.frames", "A..B", "x"]);
    refused(&["--stride", "0"], &["run.stride", "found 0"]);
    refused(&["--method", "winer-take-all"], &["winer-take-all", "did you mean `winner-take-all`?"]);
    refused(&["--set", "stereo.windw=7"], &["stereo.windw", "did you mean `stereo.window`?"]);
    refused(&["--set", "stereo.window=8"], &["stereo.window", "odd", "found 8"]);
    refused(&["--set", "stereo.semi_global.block=4"], &["stereo.semi_global.block", "odd", "found 4"]);
    refused(
        &["--set", "stereo.semi_global.p2=199"],
        &["stereo.semi_global.p2", "semi_global.p1", "found 199"],
    );
    refused(&["--set", "stereo.semi_global.pahts=4"], &["did you mean `stereo.semi_global.paths`?"]);
    refused(&["--set", "stereo.matcher=blok"], &["blok", "semi-global"]);
    refused(&["--set", "stereo.graph_cuts.lambda=-1"], &["stereo.graph_cuts.lambda", "found -1"]);
    refused(&["--set", "stereo.graph_cuts.cutoff=0"], &["stereo.graph_cuts.cutoff", "found 0"]);
    let no_costs = ["--method", "cost-curve", "--set", "stereo.matcher=graph-cuts"];
    refused(&no_costs, &["stereo.matcher", "`cost-curve`", "found graph-cuts"]);
    refused(&["--set", "winner-take-all.peak_ratio=0"], &["winner-take-all.peak_ratio", "found 0"]);
    refused(&["--set", "cost-curve.variance_factor=0"], &["cost-curve.variance_factor", "found 0"]);
    let from_elsewhere = ["--method", "cost-curve", "--set", "input.disparity_dir=elsewhere"];
    refused(&from_elsewhere, &["input.disparity_dir", "`cost-curve`", "found `elsewhere`"]);
    refused(&["--set", "grid.cell_size_m=-1"], &["grid.cell_size_m", "found -1"]);
    refused(&["--set", "grid.cell_size_m=0.00001"], &["grid", "GiB"]);
    refused(&["--set", "truth.max_range_m=0"], &["truth.max_range_m", "found 0"]);
    refused(&["--config", "no/such/file.toml"], &["no/such/file.toml"]);
    let unknown = evigrid(&["run", "--dataset", "2011_09_26_drive_0031", "--out", path(&out)]);
    check_refused(&unknown, &out, &["2011_09_26_drive_0031", "did you mean `2011_09_26_drive_0013`?"]);
    let world = evigrid(&["run", "--dataset", "synth:strait", "--out", path(&out)]);
    check_refused(&world, &out, &["strait", "street"]);
}

#[test]
fn output_that_cannot_be_written() {
    let drive = TinyDrive::new(1);
    let file = drive.root.path().join("a_file");
    fs::write(&file, "").unwrap();
    let out = file.join("out");
    check_refused(&drive.run(&out, &[]), &out, &["a_file/out"]);
}

#[test]
fn a_map_file_that_is_none() {
    let drive = TinyDrive::new(1);
    let map = drive.root.path().join("map.npz");
    fs::write(&map, "no zip").unwrap();
    let none = drive.root.path().join("none");
    let score = |map: &Path| evigrid(&["score", path(map), "--dataset", path(&drive.dir())]);
    check_refused(&score(&map), &none, &["map.npz", "npz"]);
    check_refused(&score(&none), &none, &["none"]);
    check_refused(&evigrid(&["score", path(&map)]), &none, &["--dataset"]);

    // 2 x 2 indices where N x 3 are expected.
    let npy = |dtype: &str, shape: &str, data: &[u8]| {
        let header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        [bytes, header.into_bytes(), data.to_vec()].concat()
    };
    let mut zip = zip::ZipWriter::new(fs::File::create(&map).unwrap());
    zip.start_file("indices.npy", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(&npy("<i4", "(2, 2)", &[0; 16])).unwrap();
    zip.finish().unwrap();
    check_refused(&score(&map), &none, &["map.npz", "indices", "[N, 3]", "[2, 2]"]);
}

#[test]
fn mistyped_options() {
    let none = Path::new("no/such/folder");
    check_refused(&evigrid(&["run", "--datset", "x"]), none, &["--datset", "--dataset"]);
    check_refused(&evigrid(&["rum"]), none, &["rum", "run"]);
    check_refused(&evigrid(&["run", "--stride", "two"]), none, &["two", "--stride"]);
    check_refused(&evigrid(&["run", "--stride", "-1"]), none, &["--stride", "at least 1", "found `-1`"]);
    check_refused(&evigrid(&["run", "--stride", "1.5"]), none, &["--stride", "whole number", "found `1.5`"]);
    let tolerance = evigrid(&["compare", "a", "b", "--tolerance", "-1"]);
    check_refused(&tolerance, none, &["--tolerance", "at least 0", "found `-1`"]);
    check_refused(&evigrid(&["score"]), none, &["not provided: <MAP.npz>"]);
    let elsewhere = evigrid(&["score", "map.npz", "--method", "line"]);
    check_refused(&elsewhere, none, &["unexpected argument '--method' found (see --help)"]);
    assert!(evigrid(&["--help"]).status.success());
}

#[test]
fn a_mistyped_name_is_found_before_the_work_on_the_others() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    for (wrong, parts) in [
        ("brando", ["`brando`", "did you mean `brandao`?"]),
        ("andert/fig2", ["unknown item `andert/fig2`", "did you mean"]),
    ] {
        check_refused(&evigrid(&["reproduce", "worlds", wrong, "--out", path(&out)]), &out, &parts);
    }
}

#[test]
fn two_runs_into_one_folder() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    fs::create_dir(&out).unwrap();
    let folder = fs::File::open(&out).unwrap();
    folder.lock().unwrap();
    check_refused(&drive.run(&out, &[]), &out, &["no other run", "out"]);
    drop(folder);
    assert!(drive.run(&out, &[]).status.success());
}

#[test]
fn a_folder_that_is_no_data_set() {
    let empty = tempfile::tempdir().unwrap();
    let out = empty.path().join("out");
    let output = evigrid(&["run", "--dataset", path(empty.path()), "--out", path(&out)]);
    check_refused(&output, &out, &["kitti-raw", "kitti-odometry", "middlebury"]);
    let output = evigrid(&["check", path(empty.path())]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
}
