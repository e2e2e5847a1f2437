//! Worlds through the eyes of the rest of the project: frames of a sequence.

#![allow(clippy::unwrap_used)]

use evigrid_core::{Frame, Pose};
use evigrid_replay::{ReplayError, Sequence, map_from_world};
use evigrid_synth::{SyntheticSequence, World};
use nalgebra::{Point3, Vector3};

const BOX: &str = include_str!("box.toml");

fn sequence(text: &str) -> SyntheticSequence {
    SyntheticSequence::new(World::from_toml(text).unwrap())
}

fn frame(sequence: &SyntheticSequence, index: usize) -> Frame {
    sequence.frame(index, &Pose::identity()).unwrap()
}

fn with_threads(threads: usize, index: usize) -> Frame {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| frame(&SyntheticSequence::new(World::builtin("street").unwrap()), index))
}

#[test]
fn the_bytes_are_the_same_for_any_number_of_threads_and_every_time() {
    let one = with_threads(1, 3);
    for other in [with_threads(2, 3), with_threads(2, 3), with_threads(5, 3)] {
        assert_eq!(one.left(), other.left());
        assert_eq!(one.right(), other.right());
        let (a, b) = (one.laser().unwrap(), other.laser().unwrap());
        assert_eq!(a.points(), b.points());
    }
    assert_ne!(one.left(), with_threads(2, 4).left());
}

#[test]
fn laser_points_lie_on_the_surfaces() {
    let sequence = sequence(BOX);
    let scan = frame(&sequence, 1).laser().unwrap().clone();
    let (sin, cos) = 25_f64.to_radians().sin_cos();
    let (mut on_ground, mut on_box) = (0, 0);
    for point in scan.points() {
        let p = scan.map_from_laser() * Point3::from(point.map(f64::from));
        let (dx, dy) = (p.x - 9.0, p.y - 1.0);
        let local =
            [(cos * dx + sin * dy).abs() - 0.5, (cos * dy - sin * dx).abs() - 2.0, (p.z - 1.5).abs() - 1.5];
        let outside = local.into_iter().fold(f64::MIN, f64::max);
        if p.z.abs() < 1e-5 {
            on_ground += 1;
        } else {
            assert!(outside.abs() < 1e-5, "{p} is {outside} m off the box");
            on_box += 1;
        }
        // Elevations of the beams: 5, 3, 1, ... degrees.
        let elevation = f64::from(point[2]).atan2(f64::from(point[0]).hypot(point[1].into())).to_degrees();
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
    let (exact, noisy) = (exact.laser().unwrap().points(), noisy.laser().unwrap().points());
    assert_eq!(exact.len(), noisy.len());
    let mut squares = 0.0;
    for (a, b) in exact.iter().zip(noisy) {
        let (a, b) = (Vector3::from(*a), Vector3::from(*b));
        assert!(a.cross(&b).norm() / (a.norm() * b.norm()) < 1e-5);
        squares += f64::from(b.norm() - a.norm()).powi(2);
    }
    let spread = (squares / exact.len() as f64).sqrt();
    assert!((spread - 0.05).abs() < 0.003, "{spread}");
}

#[test]
fn image_noise_has_the_given_spread() {
    let exact = frame(&sequence(BOX), 0);
    let noisy = frame(&sequence(&BOX.replace("[[laser]]", "noise = { read_grey = 3.0 }\n[[laser]]")), 0);
    let squares = exact.left().pixels().iter().zip(noisy.left().pixels()).map(|(&a, &b)| {
        let d = f64::from(a) - f64::from(b);
        d * d
    });
    // Rounding to whole grey levels adds 1/12 for each of the two images.
    let spread = (squares.sum::<f64>() / exact.left().pixels().len() as f64 - 1.0 / 6.0).sqrt();
    assert!((spread - 3.0).abs() < 0.1, "{spread}");
}

#[test]
fn frames_are_in_the_map_frame() {
    let sequence = sequence(BOX);
    let map_from_world = map_from_world(&sequence.world_from_left(1).unwrap());
    let frame = sequence.frame(2, &map_from_world).unwrap();
    // The first used camera is the map's origin; the next one stands 1 m further along x.
    assert!((frame.map_from_left().translation.vector - Vector3::x()).norm() < 1e-6);
    let laser = frame.laser().unwrap().map_from_laser();
    assert!((laser.translation.vector - Vector3::new(0.7, -0.1, 0.3)).norm() < 1e-6);
    assert_eq!((frame.index(), frame.stamp_ns()), (2, 200_000_000));
    assert_eq!(frame.rig(), &sequence.info().rig);
}

#[test]
fn frames_beyond_the_end_do_not_exist() {
    let sequence = sequence(BOX);
    assert_eq!(sequence.info().frame_count, 3);
    assert_eq!((sequence.info().id.as_str(), sequence.info().layout), ("box", "synthetic"));
    let error = sequence.frame(3, &Pose::identity()).unwrap_err();
    assert!(matches!(error, ReplayError::NoSuchFrame { index: 3, frame_count: 3, .. }), "{error}");
    assert!(error.to_string().ends_with("synth:box"), "{error}");
    assert!(sequence.world_from_left(3).is_err());
}

#[test]
fn a_world_without_a_laser_has_no_scans() {
    let start = BOX.find("[[laser]]").unwrap();
    let end = BOX.find("[light]").unwrap();
    let sequence = sequence(&format!("{}{}", &BOX[..start], &BOX[end..]));
    assert!(frame(&sequence, 0).laser().is_none());
}
