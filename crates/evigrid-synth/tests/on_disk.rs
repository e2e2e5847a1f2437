//! Data sets on disk are read back as they were made, and the exact truth lies beside them.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use evigrid_core::{Frame, Pose};
use evigrid_replay::{KittiOdometry, Sequence, map_from_world, read_disparity_png};
use evigrid_results::npz::Npz;
use evigrid_synth::{SyntheticSequence, World, WriteStep, write_data_set};

const YARD: &str = include_str!("yard.toml");

/// A data set in a temporary folder.
struct Written {
    dir: PathBuf,
    steps: Vec<WriteStep>,
    _root: tempfile::TempDir,
}

fn write(text: &str, frames: std::ops::Range<usize>) -> Written {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("yard");
    let mut steps = Vec::new();
    write_data_set(&World::from_toml(text).unwrap(), frames, &dir, &mut |step| steps.push(step)).unwrap();
    Written { dir, steps, _root: root }
}

fn distance(a: &Pose, b: &Pose) -> f64 {
    let step = a.inverse() * b;
    step.translation.vector.norm() + step.rotation.angle()
}

/// The frames are the same: bytes and bits, poses to rounding.
fn check_same(read: &Frame, made: &Frame) {
    assert_eq!(read.left(), made.left());
    assert_eq!(read.right(), made.right());
    assert_eq!(read.stamp_ns(), made.stamp_ns());
    assert_eq!(read.rig(), made.rig());
    assert!(distance(read.map_from_left(), made.map_from_left()) < 1e-9);
    match (read.laser(), made.laser()) {
        (None, None) => {}
        (Some(read), Some(made)) => {
            assert_eq!(read.points(), made.points());
            assert_eq!(read.origins(), made.origins());
            assert!(distance(read.map_from_laser(), made.map_from_laser()) < 1e-9);
        }
        (read, made) => panic!("scan read: {}, made: {}", read.is_some(), made.is_some()),
    }
}

#[test]
fn frames_come_back_the_same() {
    for from in [0, 1] {
        let written = write(YARD, from..5);
        let made = SyntheticSequence::new(World::from_toml(YARD).unwrap());
        let read = KittiOdometry::open(&written.dir).unwrap();
        assert_eq!((read.info().frame_count, read.info().id.as_str()), (5 - from, "yard"));
        assert_eq!(read.info().rig, made.info().rig);
        let mut scans = Vec::new();
        let map_from_world = map_from_world(&made.world_from_left(from).unwrap());
        for index in 0..5 - from {
            let there = read.world_from_left(index).unwrap();
            assert!(distance(&there, &made.world_from_left(from + index).unwrap()) < 1e-9);
            let frame = read.frame(index, &map_from_world).unwrap();
            check_same(&frame, &made.frame(from + index, &map_from_world).unwrap());
            scans.push(frame.laser().map(|scan| scan.points().len()));
        }
        // Both scanners, none, the planar one, the other one, the planar one.
        let least = [Some(300), None, Some(30), Some(250), Some(30)];
        for (points, least) in scans.iter().zip(&least[from..]) {
            assert!(points.is_some() == least.is_some() && points >= least, "{scans:?}");
        }
        let total = 5 - from;
        assert_eq!(written.steps[0], WriteStep::Truth);
        assert_eq!(written.steps.last(), Some(&WriteStep::Frames { done: total, total }));
        assert!(evigrid_replay::check(&written.dir).usable());
    }
}

#[test]
fn merged_scans_are_in_the_frame_of_the_first_scanner() {
    // Only the second one is due at the second frame.
    let text = YARD.replace("rate_hz = 5.0", "rate_hz = 1.0").replace("rate_hz = 3.4", "rate_hz = 10.0");
    let made = SyntheticSequence::new(World::from_toml(&text).unwrap());
    let frame = made.frame(1, &Pose::identity()).unwrap();
    let scan = frame.laser().unwrap();
    let left_from_laser = frame.map_from_left().inverse() * scan.map_from_laser();
    let first = made.frame(0, &Pose::identity()).unwrap();
    let at_first = first.map_from_left().inverse() * first.laser().unwrap().map_from_laser();
    assert!(distance(&left_from_laser, &at_first) < 1e-12);
    // The second scanner is 0.6 m behind, 0.1 m to the left and 1.4 m above the first.
    let origin = scan.origins().unwrap()[scan.points().len() / 8];
    let off = [origin[0] + 0.6, origin[1] - 0.1, origin[2] - 1.4].map(f64::from);
    assert!(off.iter().all(|v| v.abs() < 0.4) && off[2].abs() < 0.05, "{origin:?}");
}

#[test]
fn a_still_body_with_one_scanner_needs_no_origins() {
    let still =
        include_str!("box.toml").replacen(", speed_mps = 10.0", ", speed_mps = 10.0, pause_s = 9.0", 1);
    let written = write(&still, 0..2);
    assert!(written.dir.join("velodyne/000001.bin").is_file());
    assert!(!written.dir.join("velodyne_origins").exists());
    assert!(!written.dir.join("ground_truth/poses.txt").exists(), "the reported poses are the true ones");
}

#[test]
fn the_truth_lies_beside_the_frames() {
    let written = write(YARD, 0..5);
    let truth = written.dir.join("ground_truth");
    assert_eq!(fs::read_to_string(truth.join("world.toml")).unwrap(), YARD);
    check_images(&truth);
    check_voxels(&truth);
    check_ground(&truth);
    check_hazards(&truth);
    check_tables(&truth);
    let poses =
        |path: &Path| fs::read_to_string(path).unwrap().lines().map(str::to_owned).collect::<Vec<_>>();
    let (reported, real) = (poses(&written.dir.join("poses.txt")), poses(&truth.join("poses.txt")));
    assert_eq!(reported[0], real[0], "the first pose is exact");
    assert_ne!(reported[4], real[4]);
}

/// The frame of the yard's board is 10 m ahead of the first camera; the sky is above the horizon.
fn check_images(truth: &Path) {
    let disparity = read_disparity_png(&truth.join("disparity/000000.png")).unwrap();
    let occlusion = image::open(truth.join("occlusion/000000.png")).unwrap().into_luma8();
    assert_eq!((disparity.width(), disparity.height()), (160, 96));
    let (sky, ground) = (disparity.values()[80], disparity.values()[95 * 160 + 80]);
    assert_eq!(sky, 1.0 / 256.0);
    assert_eq!(occlusion.get_pixel(80, 0).0, [128]);
    assert_eq!(occlusion.get_pixel(80, 95).0, [255]);
    // The camera is 1.5 m up; the ray through row 95 goes down by 3 degrees and atan(47.5 / 120).
    let down = 3_f64.to_radians() + (47.5_f64 / 120.0).atan();
    let depth_m = 1.5 / down.sin() * (47.5_f64 / 120.0).atan().cos();
    assert!((f64::from(ground) - 48.0 / depth_m).abs() < 1.0 / 256.0, "{ground}");
    assert!(occlusion.pixels().any(|p| p.0 == [0]), "something is hidden from the right camera");
    let surface = image::open(truth.join("surface/000000.png")).unwrap().into_luma16();
    for (seen, surface) in occlusion.pixels().zip(surface.pixels()) {
        assert_eq!(seen.0 == [128], surface.0 == [0], "the sky has number 0");
    }
    let names = fs::read_to_string(truth.join("surfaces.csv")).unwrap();
    let line = names.lines().nth(usize::from(surface.get_pixel(80, 95).0[0]) + 1).unwrap();
    assert!(line.ends_with(",1"), "the lowest row shows ground: {line}");
    assert_eq!(names.lines().next(), Some("surface,name,is_ground"));
}

fn check_voxels(truth: &Path) {
    let bytes = fs::read(truth.join("voxels.npz")).unwrap();
    let mut npz = Npz::new(&bytes).unwrap();
    assert_eq!(npz.array("cell_size").unwrap().values, [0.25]);
    assert_eq!(npz.array("origin").unwrap().values, [0.0, -3.0, -2.0]);
    let cells = |npz: &mut Npz<'_>, name| {
        let array = npz.array(name).unwrap();
        assert!(array.is_integer && array.shape[1] == 3);
        array.values.chunks_exact(3).map(|v| [v[0] as i32, v[1] as i32, v[2] as i32]).collect::<Vec<_>>()
    };
    let (occupied, hidden) = (cells(&mut npz, "occupied"), cells(&mut npz, "hidden"));
    // The ground's upper face is 1.5 m below the camera: on the border of layers 1
    // and 2, so it is in the upper one.
    let ground = occupied.iter().filter(|v| v[2] == 2).count();
    assert_eq!(ground, 48 * 24, "all of the ground");
    assert!(hidden.iter().all(|v| v[2] < 2) && hidden.len() >= 48 * 24, "below it");
    // The board stands 10 m ahead and 0.8 m to the left of the camera.
    assert!(occupied.contains(&[(10.0 / 0.25) as i32, ((0.8 + 3.0) / 0.25) as i32, 5]), "the board");
}

fn check_ground(truth: &Path) {
    let bytes = fs::read(truth.join("ground.npz")).unwrap();
    let mut npz = Npz::new(&bytes).unwrap();
    let height = npz.array("height").unwrap();
    assert_eq!((height.shape, height.is_integer), (vec![48, 24], false));
    assert!((height.values[0] + 1.5).abs() < 1e-6);
    assert_eq!(npz.array("slope").unwrap().values[0], 0.0);
    let safety = image::open(truth.join("safety_map.png")).unwrap().into_luma8();
    assert_eq!(safety.dimensions(), (24, 48));
    let table: toml::Table = fs::read_to_string(truth.join("safety_map.toml")).unwrap().parse().unwrap();
    let label = |name: &str| table["labels"][name].as_integer().unwrap() as u8;
    // The robot stands at the bottom in the middle; the board is 10 m ahead, 0.8 m to the left.
    assert_eq!(safety.get_pixel(12, 47).0, [label("level")]);
    let (i, j) = ((10.0_f64 / 0.25) as u32, (3.8_f64 / 0.25) as u32);
    assert_eq!(safety.get_pixel(23 - j, 47 - i).0, [label("non_ground")]);
}

/// Each row is a cell whose pixel in the safety map tells the same.
fn check_hazards(truth: &Path) {
    let safety = image::open(truth.join("safety_map.png")).unwrap().into_luma8();
    let table = fs::read_to_string(truth.join("hazards.csv")).unwrap();
    let mut rows = table.lines();
    assert_eq!(rows.next(), Some("name,kind,x_m,y_m"));
    let mut cells = [0, 0];
    for row in rows {
        let columns: Vec<&str> = row.split(',').collect();
        let is_safe = match columns[..2] {
            ["board", "obstacle"] => false,
            ["before-the-board", "safe-area"] => true,
            _ => panic!("{row}"),
        };
        let [x, y] = [2, 3].map(|column| columns[column].parse::<f64>().unwrap());
        let (i, j) = ((x / 0.25) as u32, ((y + 3.0) / 0.25) as u32);
        assert_eq!(safety.get_pixel(23 - j, 47 - i).0[0] > 128, is_safe, "{row}");
        cells[usize::from(is_safe)] += 1;
    }
    // The board is 1.5 m wide, the safe area has 1.8 square metres.
    assert!((6..=14).contains(&cells[0]) && (26..=32).contains(&cells[1]), "{cells:?}");
}

fn check_tables(truth: &Path) {
    let rows = |name: &str| {
        let text = fs::read_to_string(truth.join(name)).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect::<Vec<Vec<String>>>()
    };
    let number = |text: &str| text.parse::<f64>().unwrap();
    let planes = rows("planes.csv");
    assert_eq!((planes.len(), planes[1][1].as_str()), (2, "yard"));
    assert!((number(&planes[1][5]) + 1.5).abs() < 1e-6, "{planes:?}");
    let boards = rows("boards.csv");
    assert_eq!((boards.len(), boards[1][2].as_str()), (6, "board"));
    assert!((number(&boards[1][4]) - 1.5).abs() < 1e-6 && (number(&boards[1][5]) - 1.5).abs() < 0.1);
    let objects = rows("objects.csv");
    assert_eq!(objects.len(), 1 + 5 * 3);
    let cart: Vec<_> = objects.iter().filter(|row| row[2] == "cart").collect();
    let moved = number(&cart[4][4]) - number(&cart[0][4]);
    assert!((moved - 0.4).abs() < 0.01, "0.4 s at 1 m/s: {moved}");
    assert_eq!((cart[0][13].as_str(), objects[1][13].as_str()), ("1", "0"));
}

#[test]
fn a_world_without_robot_or_scanner_lacks_only_their_files() {
    let text = include_str!("box.toml");
    let (start, end) = (text.find("[[laser]]").unwrap(), text.find("[light]").unwrap());
    let written = write(&format!("{}{}", &text[..start], &text[end..]), 0..1);
    assert!(
        KittiOdometry::open(&written.dir).unwrap().frame(0, &Pose::identity()).unwrap().laser().is_none()
    );
    let names = |dir: &Path| {
        let mut names: Vec<_> =
            fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(
        names(&written.dir),
        ["calib.txt", "ground_truth", "image_0", "image_1", "poses.txt", "times.txt"]
    );
    assert_eq!(
        names(&written.dir.join("ground_truth")),
        [
            "boards.csv",
            "disparity",
            "objects.csv",
            "occlusion",
            "planes.csv",
            "surface",
            "surfaces.csv",
            "voxels.npz",
            "world.toml"
        ]
    );
}

#[test]
fn what_fails_leaves_nothing_behind() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("yard");
    let refusal = |text: &str, frames| {
        let world = World::from_toml(text).unwrap();
        let error = write_data_set(&world, frames, &dir, &mut |_| ()).unwrap_err().to_string();
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
        error
    };
    assert_eq!(refusal(YARD, 2..9), "frames: expected at least one within 0..5, found 2..9");
    assert!(refusal(YARD, 2..2).ends_with("found 2..2"));
    let hidden = YARD.replace("x_m = [10.8, 11.2]", "x_m = [30.0, 31.0]");
    assert!(refusal(&hidden, 0..5).starts_with("hazard board: expected at least one unsafe cell"));
    let floating = YARD.replace("size_m = [60.0, 60.0, 1.0]", "size_m = [1.0, 1.0, 1.0]");
    assert!(
        refusal(&floating, 0..5).starts_with("robot.height_m: expected ground below the robot at frame 0")
    );
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let written = pool.install(|| write(YARD, 0..5));
        let mut files = Vec::new();
        let mut folders = vec![written.dir.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let name = path.strip_prefix(&written.dir).unwrap().to_owned();
                    files.push((name, fs::read(&path).unwrap()));
                }
            }
        }
        files.sort();
        files
    };
    let one = bytes(1);
    assert!(one.len() > 25, "{}", one.len());
    assert!(one == bytes(4));
}
