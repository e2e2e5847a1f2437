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

/// The distance of a point to the ground or the box of the small world, metres.
fn off_surfaces(p: &Point3<f64>) -> f64 {
    let (sin, cos) = 25_f64.to_radians().sin_cos();
    let (dx, dy) = (p.x - 9.0, p.y - 1.0);
    let local =
        [(cos * dx + sin * dy).abs() - 0.5, (cos * dy - sin * dx).abs() - 2.0, (p.z - 1.5).abs() - 1.5];
    local.into_iter().fold(f64::MIN, f64::max).abs().min(p.z.abs())
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
