//! Scans of worlds: points on the surfaces, origins, noise and times.

#![allow(clippy::unwrap_used)]

mod common;

use common::{BOX, frame, sequence};
use nalgebra::{Point3, Vector3};

/// The distance of a point to the ground or the box of the small world, metres.
fn off_surfaces(p: &Point3<f64>) -> f64 {
    let (sin, cos) = 25_f64.to_radians().sin_cos();
    let (dx, dy) = (p.x - 9.0, p.y - 1.0);
    let local =
        [(cos * dx + sin * dy).abs() - 0.5, (cos * dy - sin * dx).abs() - 2.0, (p.z - 1.5).abs() - 1.5];
    local.into_iter().fold(f64::MIN, f64::max).abs().min(p.z.abs())
}

#[test]
fn laser_points_lie_on_the_surfaces() {
    let sequence = sequence(BOX);
    let scan = frame(&sequence, 1).laser().unwrap().clone();
    let (mut on_ground, mut on_box) = (0, 0);
    for (point, origin) in scan.points().iter().zip(scan.origins().unwrap()) {
        let p = scan.map_from_laser() * Point3::from(point.map(f64::from));
        assert!(off_surfaces(&p) < 1e-5, "{p}");
        on_ground += usize::from(p.z.abs() < 1e-5);
        on_box += usize::from(p.z.abs() >= 1e-5);
        // Elevations of the beams: 5, 3, 1, ... degrees.
        let [x, y, z] = [0, 1, 2].map(|a| f64::from(point[a] - origin[a]));
        let elevation = z.atan2(x.hypot(y)).to_degrees();
        assert!(((elevation - 5.0) / 2.0 - ((elevation - 5.0) / 2.0).round()).abs() < 1e-4, "{elevation}");
    }
    assert!(on_ground > 3000 && on_box > 200, "{on_ground} {on_box}");
    // The scanner stands 0.3 m behind and 0.1 m to the left of the body's origin at x = 2, y = 0.5.
    let origin = scan.map_from_laser().translation.vector;
    assert!((origin - Vector3::new(1.7, 0.6, 1.8)).norm() < 1e-6, "{origin}");
}

#[test]
fn range_noise_has_the_given_spread_and_goes_along_the_beam() {
    let exact = frame(&sequence(BOX), 0);
    let noisy = frame(&sequence(&BOX.replace("range_noise_m = 0.0", "range_noise_m = 0.05")), 0);
    let (exact, noisy) = (exact.laser().unwrap(), noisy.laser().unwrap());
    assert_eq!(exact.origins(), noisy.origins());
    let (exact, origins, noisy) = (exact.points(), exact.origins().unwrap(), noisy.points());
    assert_eq!(exact.len(), noisy.len());
    let mut squares = 0.0;
    for ((a, b), origin) in exact.iter().zip(noisy).zip(origins) {
        let [a, b] = [a, b].map(|p| Vector3::from(*p) - Vector3::from(*origin));
        assert!(a.cross(&b).norm() / (a.norm() * b.norm()) < 1e-5);
        squares += f64::from(b.norm() - a.norm()).powi(2);
    }
    let spread = (squares / exact.len() as f64).sqrt();
    assert!((spread - 0.05).abs() < 0.003, "{spread}");
}

#[test]
fn a_world_without_a_laser_has_no_scans() {
    let start = BOX.find("[[laser]]").unwrap();
    let end = BOX.find("[light]").unwrap();
    let sequence = sequence(&format!("{}{}", &BOX[..start], &BOX[end..]));
    assert!(frame(&sequence, 0).laser().is_none());
}

#[test]
fn a_sweep_from_a_moving_platform_has_the_scanners_own_place_for_every_point() {
    let scan = frame(&sequence(BOX), 1).laser().unwrap().clone();
    let origins = scan.origins().unwrap();
    let mut ahead = 0;
    for (point, origin) in scan.points().iter().zip(origins) {
        let world = scan.map_from_laser() * Point3::from(point.map(f64::from));
        assert!(off_surfaces(&world) < 1e-5, "{world}");
        // 10 m/s and 10 turns per second: 1 m per turn, half of it before the scanner looks straight ahead.
        let seen_from = [0, 1, 2].map(|a| f64::from(point[a] - origin[a]));
        let turn = seen_from[1].atan2(seen_from[0]) / std::f64::consts::TAU;
        assert!((f64::from(origin[0]) - turn).abs() < 1e-3, "{origin:?} at {turn} turns");
        assert!(origin[1].abs() < 1e-5 && origin[2].abs() < 1e-5);
        ahead += usize::from(turn.abs() < 0.01);
    }
    assert!(ahead > 50, "{ahead}");
}

#[test]
fn a_scan_from_a_standing_platform_has_one_origin() {
    let text = BOX.replace("{ at_m = [1.0, 0.5], speed_mps = 10.0 }", "{ at_m = [1.0, 0.5], pause_s = 9 }");
    let still = text.replace("    { at_m = [6.0, 0.5] },\n", "");
    assert!(frame(&sequence(&still), 1).laser().unwrap().origins().is_none());
}

const SECOND_LASER: &str = "[[laser]]\nbeams = 1\nopening_deg = 90\nstep_deg = 1\nrange_m = 30\n\
                            mount_m = [0.5, 0.0, 0.4]\nroll_deg = 90\n[light]";

#[test]
fn several_scanners_make_one_scan() {
    let one = frame(&sequence(BOX), 1).laser().unwrap().clone();
    let both = frame(&sequence(&BOX.replace("[light]", SECOND_LASER)), 1).laser().unwrap().clone();
    assert_eq!(one.points(), &both.points()[..one.points().len()]);
    let origins = both.origins().unwrap();
    let (mut upright, mut seen) = (0.0_f64, 0);
    for (point, origin) in both.points().iter().zip(origins).skip(one.points().len()) {
        let [p, o] = [point, origin].map(|p| both.map_from_laser() * Point3::from(p.map(f64::from)));
        assert!(off_surfaces(&p) < 1e-5, "{p}");
        // Rolled by 90 degrees it sweeps the plane y = 0.5 upright, from 0.4 m above the ground.
        assert!((o.z - 0.4).abs() < 1e-5 && (p.y - 0.5).abs() < 1e-4, "{o} {p}");
        (upright, seen) = (upright.max(p.z), seen + 1);
    }
    assert!(seen > 50 && upright > 2.5, "{seen} points up to {upright} m");
}

#[test]
fn drop_outs_and_slow_scanners_leave_points_and_scans_out() {
    let all = frame(&sequence(BOX), 0).laser().unwrap().points().to_vec();
    let some = frame(&sequence(&BOX.replace("[light]", "drop_out = 0.3\n[light]")), 0);
    let some = some.laser().unwrap().points().to_vec();
    assert!(some.iter().all(|p| all.contains(p)));
    let share = some.len() as f64 / all.len() as f64;
    assert!((share - 0.7).abs() < 0.03, "{share}");
    let slow = sequence(&BOX.replace("[light]", "rate_hz = 5\n[light]"));
    assert_eq!([0, 1, 2].map(|i| frame(&slow, i).laser().is_some()), [true, false, true]);
}
