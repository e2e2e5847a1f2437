//! A tiny KITTI raw drive on disk, and how the binary is run on it.
#![allow(clippy::unwrap_used, dead_code, missing_docs)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub mod runs;

pub const WIDTH: usize = 96;
pub const HEIGHT: usize = 48;

/// A few frames of a ground and a box, with a planar scanner.
pub const TINY_WORLD: &str = r#"
name = "tiny"
seed = 3
frames = 3
rate_hz = 10.0
trajectory = { waypoints = [{ at_m = [0.0, 0.0], speed_mps = 5.0 }, { at_m = [3.0, 0.0] }] }
reported_pose = { white_m = 0.01 }

[stereo]
width = 96
height = 64
focal_px = 80.0
centre_px = [47.5, 31.5]
baseline_m = 0.3
mount_m = [0.0, 0.15, 1.25]

[[laser]]
beams = 8
top_deg = 2.0
bottom_deg = -20.0
step_deg = 1.0
range_m = 30.0
mount_m = [0.0, 0.0, 1.4]

[light]
ambient = 0.5
sun = 0.6
sun_azimuth_deg = 160.0
sun_elevation_deg = 50.0
shadows = true
sky_horizon_grey = 240.0
sky_zenith_grey = 210.0

[material.soil]
grey = 120.0
contrast = 25.0
scale_m = 0.3
octaves = 6

[[object]]
shape = { box = { size_m = [60.0, 60.0, 1.0] } }
centre_m = [0.0, 0.0, -0.5]
material = "soil"

[[object]]
shape = { box = { size_m = [1.0, 3.0, 2.0] } }
centre_m = [7.0, 0.5, 1.0]
material = "soil"
"#;

/// A drive of `frames` frames in a temporary folder, driving straight on at 1 m per frame. Every part can be
/// spoilt by overwriting its file.
pub struct TinyDrive {
    pub root: tempfile::TempDir,
}

impl TinyDrive {
    pub fn new(frames: usize) -> Self {
        let drive = Self { root: tempfile::tempdir().unwrap() };
        for folder in ["image_00/data", "image_01/data", "oxts/data", "velodyne_points/data"] {
            fs::create_dir_all(drive.dir().join(folder)).unwrap();
        }
        drive.write_calibration();
        let stamps: String = (0..frames).map(|i| format!("2011-09-26 13:10:5{i}.000000000\n")).collect();
        for folder in ["image_00", "image_01", "oxts", "velodyne_points"] {
            fs::write(drive.dir().join(folder).join("timestamps.txt"), &stamps).unwrap();
        }
        for index in 0..frames {
            drive.write_frame(index);
        }
        drive
    }

    pub fn dir(&self) -> PathBuf {
        self.root.path().join("2011_09_26/2011_09_26_drive_9999_sync")
    }

    pub fn calibration(&self) -> PathBuf {
        self.root.path().join("2011_09_26/calib_cam_to_cam.txt")
    }

    fn write_calibration(&self) {
        let identity = "1 0 0 0 1 0 0 0 1";
        let mut text = String::from("calib_time: 09-Jan-2012 13:57:47\n");
        for (camera, tx) in [("00", 0.0), ("01", -40.0)] {
            text += &format!("S_rect_{camera}: {WIDTH} {HEIGHT}\nR_rect_{camera}: {identity}\n");
            text += &format!("P_rect_{camera}: 80 0 47.5 {tx} 0 80 23.5 0 0 0 1 0\n");
        }
        let date = self.root.path().join("2011_09_26");
        fs::write(self.calibration(), text).unwrap();
        // Camera axes from laser axes: x right = -y, y down = -z, z forward = x.
        fs::write(date.join("calib_velo_to_cam.txt"), "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n").unwrap();
        fs::write(date.join("calib_imu_to_velo.txt"), format!("R: {identity}\nT: -0.8 0.3 -0.8\n")).unwrap();
    }

    fn write_frame(&self, index: usize) {
        for (camera, shift) in [("image_00", 5), ("image_01", 0)] {
            let image = image::GrayImage::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| {
                let h =
                    (x + 200 - shift + 7919 * index as u32).wrapping_mul(2654435761) ^ y.wrapping_mul(40503);
                image::Luma([(h.wrapping_mul(2246822519) >> 24) as u8])
            });
            image.save(self.image(camera, index)).unwrap();
        }
        let longitude = 8.4 + index as f64 / (111_319.49 * 49_f64.to_radians().cos());
        fs::write(self.oxts(index), format!("49.0 {longitude} 114 0 0 0{}\n", " 0".repeat(24))).unwrap();
        let points = (0..50).flat_map(|i| [8.0_f32, i as f32 * 0.1 - 2.5, -0.5, 0.3]);
        let bytes: Vec<u8> = points.flat_map(f32::to_le_bytes).collect();
        fs::write(self.scan(index), bytes).unwrap();
    }

    pub fn image(&self, camera: &str, index: usize) -> PathBuf {
        self.dir().join(format!("{camera}/data/{index:010}.png"))
    }

    pub fn oxts(&self, index: usize) -> PathBuf {
        self.dir().join(format!("oxts/data/{index:010}.txt"))
    }

    pub fn scan(&self, index: usize) -> PathBuf {
        self.dir().join(format!("velodyne_points/data/{index:010}.bin"))
    }

    /// Arguments that run the drive into a folder, small and without a recording.
    pub fn run(&self, out: &Path, more: &[&str]) -> Output {
        let dir = self.dir();
        let mut args = vec!["run", "--dataset", path(&dir), "--out", path(out)];
        args.extend(["--set", "stereo.disparities=16", "--set", "output.recording=false"]);
        args.extend(["--set", "grid.x_m=[0, 20]"]);
        args.extend(more);
        evigrid(&args)
    }
}

/// A plan on the drive, small, with these keys of the sweep and more before its sections.
pub fn sweep_plan(drive: &TinyDrive, head: &str, sweep: &str) -> PathBuf {
    let text = format!(
        "datasets = [{:?}]\n{head}\n[stereo]\ndisparities = 16\n[grid]\nx_m = [0, 20]\n[sweep]\n{sweep}\n",
        drive.dir()
    );
    let file = drive.root.path().join("plan.toml");
    fs::write(&file, text).unwrap();
    file
}

pub fn sweep(plan: &Path, out: &Path) -> Output {
    evigrid(&["sweep", path(plan), "--out", path(out)])
}

pub fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

pub fn evigrid(args: &[&str]) -> Output {
    command(args).output().unwrap()
}

pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("evigrid"));
    command.args(args);
    command
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// File names of a folder, sorted.
pub fn names(dir: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(dir) else { return Vec::new() };
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The root of the real data, if it is there.
pub fn real_data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let root = std::env::var_os("EVIGRID_DATA").map_or(beside, PathBuf::from);
    let found = root.join("kitti_raw").is_dir();
    if !found {
        skipped(&format!("no real data at {} (set EVIGRID_DATA)", root.display()));
    }
    found.then_some(root)
}

/// Says why a test did nothing.
pub fn skipped(why: &str) {
    // Not `println`, which a passing test swallows.
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}
