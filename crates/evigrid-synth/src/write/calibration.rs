//! calib.txt, times.txt and poses.txt.

use std::fmt::Write;

use evigrid_core::{Pose, StereoRig};
use nalgebra::{Isometry3, Translation3};

use crate::{World, angle};

/// The lines of calib.txt: P0 to P3 project from the left camera (the benchmark's colour pair is the grey one
/// here), Tr leads from the first laser scanner to the left camera.
pub fn calibration(world: &World) -> String {
    let StereoRig { focal_px, centre_x_px, centre_y_px, baseline_m, .. } = world.rig;
    let projection = |offset_m: f64| {
        let (f, x, y) = (focal_px, centre_x_px, centre_y_px);
        numbers(&[f, 0.0, x, -f * offset_m, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0])
    };
    let mut text = String::new();
    for (camera, offset_m) in [0.0, baseline_m, 0.0, baseline_m].into_iter().enumerate() {
        let _ = writeln!(text, "P{camera}: {}", projection(offset_m));
    }
    if let Some(laser) = world.lasers.first() {
        let left_from_laser = world.body_from_left.inverse() * laser.body_from_laser();
        let _ = writeln!(text, "Tr: {}", matrix(&left_from_laser));
    }
    text
}

/// The lines of times.txt: seconds, exact to the nanosecond.
pub fn times(stamps_ns: impl Iterator<Item = i64>) -> String {
    let second = 1_000_000_000;
    stamps_ns.map(|ns| format!("{}.{:09}\n", ns / second, ns % second)).collect()
}

/// The lines of poses.txt: poses of the left camera in the frame of a level camera at the world's origin that
/// looks along its x axis.
pub fn poses(world_from_left: impl Iterator<Item = Pose>) -> String {
    let level = Isometry3::from_parts(Translation3::identity(), angle::body_from_camera_axes()).inverse();
    world_from_left.map(|pose| matrix(&(level * pose)) + "\n").collect()
}

/// The rows of [R | t].
fn matrix(pose: &Pose) -> String {
    let m = pose.to_homogeneous();
    let rows: Vec<f64> = (0..12).map(|i| m[(i / 4, i % 4)]).collect();
    numbers(&rows)
}

/// Numbers with as many digits as it takes to read the same ones back.
fn numbers(values: &[f64]) -> String {
    // Adding 0 drops the sign of a negative zero.
    values.iter().map(|v| format!("{:e}", v + 0.0)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: &str = include_str!("../../tests/box.toml");

    #[test]
    fn the_lines_are_those_of_the_benchmark() {
        let text = calibration(&World::from_toml(BOX).unwrap());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "P0: 1.2e2 0e0 7.95e1 0e0 0e0 1.2e2 4.75e1 0e0 0e0 0e0 1e0 0e0");
        assert_eq!(lines[1], "P1: 1.2e2 0e0 7.95e1 -4.8e1 0e0 1.2e2 4.75e1 0e0 0e0 0e0 1e0 0e0");
        // x right = -y of the laser, y down = -z, z forward = x; the laser is 0.3 m behind, 0.1 m to the
        // right and 0.3 m above the camera.
        let tr: Vec<f64> =
            lines[4].strip_prefix("Tr: ").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
        let expected = [0.0, -1.0, 0.0, 0.1, 0.0, 0.0, -1.0, -0.3, 1.0, 0.0, 0.0, -0.3];
        assert!(tr.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{tr:?}");
    }

    #[test]
    fn times_are_exact() {
        assert_eq!(times([0, 1, 12_345_678_901].into_iter()), "0.000000000\n0.000000001\n12.345678901\n");
    }

    #[test]
    fn a_level_camera_at_the_origin_has_the_unit_pose() {
        let level = Isometry3::from_parts(Translation3::identity(), angle::body_from_camera_axes());
        let text = poses([level, Translation3::new(2.0, 1.0, 0.5) * level].into_iter());
        assert_eq!(
            text,
            "1e0 0e0 0e0 0e0 0e0 1e0 0e0 0e0 0e0 0e0 1e0 0e0\n\
             1e0 0e0 0e0 -1e0 0e0 1e0 0e0 -5e-1 0e0 0e0 1e0 2e0\n"
        );
    }
}
