//! Worlds through the eyes of the rest of the project: frames of a sequence.

#![allow(clippy::unwrap_used)]

mod common;

use common::{BOX, frame, sequence};
use evigrid_core::{Frame, Pose};
use evigrid_replay::{ReplayError, Sequence, map_from_world};
use evigrid_synth::{SyntheticSequence, World};
use nalgebra::{Point3, Vector3};

fn with_threads(threads: usize, world: &str, index: usize) -> Frame {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| frame(&SyntheticSequence::new(World::builtin(world).unwrap()), index))
}

#[test]
fn the_bytes_are_the_same_for_any_number_of_threads_and_every_time() {
    // A street that stands still, and a crossing where things move.
    for world in ["street", "crossing"] {
        let one = with_threads(1, world, 3);
        for threads in [2, 2, 5] {
            let other = with_threads(threads, world, 3);
            assert_eq!(one.left(), other.left());
            assert_eq!(one.right(), other.right());
            let (a, b) = (one.laser().unwrap(), other.laser().unwrap());
            assert_eq!((a.points(), a.origins()), (b.points(), b.origins()));
        }
        assert_ne!(one.left(), with_threads(2, world, 4).left());
    }
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
    let (scan, alone) = (frame.laser().unwrap(), sequence.laser(2, &map_from_world).unwrap().unwrap());
    assert_eq!((scan.points(), scan.map_from_laser()), (alone.points(), alone.map_from_laser()));
    assert_eq!((frame.index(), frame.stamp_ns()), (2, 200_000_000));
    assert_eq!(frame.rig(), &sequence.info().rig);
}

#[test]
fn frames_beyond_the_end_do_not_exist() {
    let sequence = sequence(BOX);
    assert_eq!(sequence.info().frame_count, 3);
    assert_eq!(sequence.info().mounting.unwrap().height_m, 1.5);
    assert_eq!((sequence.info().id.as_str(), sequence.info().layout), ("box", "synthetic"));
    let error = sequence.frame(3, &Pose::identity()).unwrap_err();
    assert!(matches!(error, ReplayError::NoSuchFrame { index: 3, frame_count: 3, .. }), "{error}");
    assert!(error.to_string().ends_with("synth:box"), "{error}");
    assert!(sequence.world_from_left(3).is_err());
}

/// Mean and deviation of the difference to the noise-free left image over pixels of about this grey.
fn camera_error(noise: &str, index: usize, greys: std::ops::Range<u8>) -> (f64, f64) {
    let exact = frame(&sequence(BOX), index);
    let noisy = frame(&sequence(&BOX.replace("[[laser]]", &format!("noise = {noise}\n[[laser]]"))), index);
    let pairs = exact.left().pixels().iter().zip(noisy.left().pixels());
    let differences: Vec<f64> =
        pairs.filter(|(a, _)| greys.contains(a)).map(|(&a, &b)| f64::from(b) - f64::from(a)).collect();
    let n = differences.len() as f64;
    assert!(n > 300.0, "{n} pixels");
    let mean = differences.iter().sum::<f64>() / n;
    (mean, (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n).sqrt())
}

#[test]
fn shot_noise_grows_with_the_root_of_the_light() {
    // Rounding adds 1/12 for each image.
    let expected = |grey: f64| (0.2 * grey + 1.0 / 6.0).sqrt();
    let (_, dark) = camera_error("{ shot_grey = 0.2 }", 0, 70..90);
    let (_, bright) = camera_error("{ shot_grey = 0.2 }", 0, 220..240);
    assert!((dark / expected(80.0) - 1.0).abs() < 0.1, "{dark}");
    assert!((bright / expected(230.0) - 1.0).abs() < 0.1, "{bright}");
}

#[test]
fn vignetting_darkens_the_corners_and_drift_whole_frames() {
    let exact = frame(&sequence(BOX), 0);
    let dim = frame(&sequence(&BOX.replace("[[laser]]", "noise = { vignetting = 0.5 }\n[[laser]]")), 0);
    let ratio = |i: usize| f64::from(dim.left().pixels()[i]) / f64::from(exact.left().pixels()[i]);
    assert!((ratio(0) - 0.5).abs() < 0.02, "{}", ratio(0));
    assert!((ratio(47 * 160 + 79) - 1.0).abs() < 0.02);
    let drift = "{ exposure_drift = 0.1 }";
    let (first, _) = camera_error(drift, 0, 140..160);
    let (later, spread) = camera_error(drift, 2, 140..160);
    assert!(first.abs() < 0.01 && later.abs() > 1.0 && spread < 0.5, "{first} {later} {spread}");
}

#[test]
fn things_move_as_described_and_the_rest_stands_still() {
    let mover = "[[object]]\nname = \"ball\"\nshape = { sphere = { radius_m = 0.3 } }\nmaterial = \"wood\"\n\
                 centre_m = [5.0, -1.0, 1.0]\nmotion = { velocity_mps = [0.0, 6.0, 0.0] }\n";
    let text = BOX.replace("speed_mps = 10.0", "speed_mps = 0.001, pause_s = 9");
    let sequence = sequence(&format!("{text}{mover}"));
    // The only points nearer than 0.301 m to the ball's centre are its own.
    let on_ball = |index: usize| {
        let scan = frame(&sequence, index).laser().unwrap().clone();
        let centre = Point3::new(5.0, -1.0 + 0.6 * index as f64, 1.0);
        let world = scan.points().iter().map(|p| scan.map_from_laser() * Point3::from(p.map(f64::from)));
        world.filter(|p| ((p - centre).norm() - 0.3).abs() < 1e-4).count()
    };
    assert!((0..3).all(|i| on_ball(i) > 5), "{:?}", [0, 1, 2].map(on_ball));
}

#[test]
fn reported_poses_carry_errors_and_images_do_not() {
    let noisy = sequence(&BOX.replace("[stereo]", "[reported_pose]\nwhite_m = 0.1\n[stereo]"));
    let exact = sequence(BOX);
    let translation = |s: &SyntheticSequence, i| s.world_from_left(i).unwrap().translation.vector;
    assert_eq!(translation(&noisy, 0), translation(&exact, 0));
    let error = translation(&noisy, 2) - translation(&exact, 2);
    assert!(error.norm() > 1e-3 && error.z.abs() < 1e-12, "{error}");
    let (a, b) = (frame(&noisy, 2), frame(&exact, 2));
    assert_eq!(a.left(), b.left());
    assert_eq!(a.laser().unwrap().points(), b.laser().unwrap().points());
    let shift = a.laser().unwrap().map_from_laser().translation.vector
        - b.laser().unwrap().map_from_laser().translation.vector;
    assert!((shift - error).norm() < 1e-9);
}

/// A cube of 2 units whose quads are anticlockwise from outside.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
                    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn a_mesh_file_beside_the_world_is_seen_like_the_box_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.toml");
    let shape = "shape = { box = { size_m = [1.0, 4.0, 3.0] } }";
    let with = |shape_now: &str| {
        std::fs::write(&path, BOX.replace(shape, shape_now)).unwrap();
        World::from_file(&path)
    };
    std::fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    let meshed = with("shape = { mesh_file = { path = \"cube.obj\", unit_m = 0.6 } }").unwrap();
    let boxed = with("shape = { box = { size_m = [1.2, 1.2, 1.2] } }").unwrap();
    let points = |world: World| frame(&SyntheticSequence::new(world), 0).laser().unwrap().points().to_vec();
    let (meshed, boxed) = (points(meshed), points(boxed));
    assert_eq!(meshed.len(), boxed.len());
    for (a, b) in meshed.iter().zip(&boxed) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-4), "{a:?} {b:?}");
    }
    std::fs::write(folder.path().join("cube.obj"), "v 1 2\nf 1 2 3\n").unwrap();
    let error =
        with("shape = { mesh_file = { path = \"cube.obj\", unit_m = 0.6 } }").unwrap_err().to_string();
    assert!(
        error.starts_with("line ") && error.contains("cube.obj") && error.ends_with("world.toml)"),
        "{error}"
    );
    let error = World::from_file(&folder.path().join("none.toml")).unwrap_err().to_string();
    assert!(error.ends_with("none.toml)"), "{error}");
}
