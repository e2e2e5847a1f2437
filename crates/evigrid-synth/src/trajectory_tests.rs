use super::*;

fn waypoint(at: &[f64], speed: Option<f64>, pause: f64) -> WaypointSpec {
    WaypointSpec {
        at_m: Place::try_from(at.to_vec()).unwrap(),
        speed_mps: speed.map(Positive),
        pause_s: NonNegative(pause),
        roll_deg: Finite(0.0),
        pitch_deg: Finite(0.0),
    }
}

fn spec(waypoints: Vec<WaypointSpec>) -> TrajectorySpec {
    TrajectorySpec { waypoints, look_at_m: None }
}

fn path(points: &[&[f64]]) -> Result<Path, SynthError> {
    let waypoints = points.iter().map(|p| waypoint(p, Some(1.0), 0.0)).collect();
    Path::new(&spec(waypoints), "trajectory.waypoints")
}

#[test]
fn a_straight_path_is_driven_at_its_distance() {
    let path = path(&[&[1.0, 2.0], &[4.0, 6.0], &[7.0, 10.0]]).unwrap();
    assert!((path.duration_s() - 10.0).abs() < 1e-9);
    for time in [0.0, 0.7, 5.0, 9.9, 10.0, 12.0] {
        let pose = path.world_from_body(time);
        let driven = time.min(10.0);
        let expected = Vector3::new(1.0 + 0.6 * driven, 2.0 + 0.8 * driven, 0.0);
        assert!((pose.translation.vector - expected).norm() < 1e-6, "{time}");
        assert!((pose.rotation * Vector3::x() - Vector3::new(0.6, 0.8, 0.0)).norm() < 1e-9, "{time}");
    }
}

#[test]
fn a_bend_passes_its_way_points_with_even_speed_and_smooth_heading() {
    let path = path(&[&[0.0, 0.0], &[10.0, 0.0], &[18.0, 6.0], &[20.0, 15.0]]).unwrap();
    let step = 0.05;
    let poses: Vec<Pose> =
        (0..(path.duration_s() / step) as usize).map(|i| path.world_from_body(i as f64 * step)).collect();
    for pair in poses.windows(2) {
        let moved = (pair[1].translation.vector - pair[0].translation.vector).norm();
        assert!((moved - step).abs() < 5e-3 * step, "{moved}");
        assert!(pair[0].rotation.angle_to(&pair[1].rotation) < 0.02);
    }
    let passes = |x, y| poses.iter().any(|p| (p.translation.vector - Vector3::new(x, y, 0.0)).norm() < step);
    assert!(passes(10.0, 0.0) && passes(18.0, 6.0));
}

#[test]
fn pauses_and_speeds_set_the_time() {
    let points = vec![
        waypoint(&[0.0, 0.0], Some(2.0), 1.0),
        waypoint(&[4.0, 0.0], None, 3.0),
        waypoint(&[8.0, 0.0], Some(0.5), 0.0),
        waypoint(&[9.0, 0.0], None, 5.0),
    ];
    let path = Path::new(&spec(points), "t").unwrap();
    for (time, x, speed) in [
        (0.5, 0.0, 0.0),
        (2.0, 2.0, 2.0),
        (3.5, 4.0, 0.0),
        (5.9, 4.0, 0.0),
        (7.0, 6.0, 2.0),
        (9.0, 8.5, 0.5),
        (12.0, 9.0, 0.0),
    ] {
        assert!((path.world_from_body(time).translation.x - x).abs() < 1e-6, "{time}");
        assert!((path.velocity_mps(time) - Vector3::x() * speed).norm() < 1e-6, "{time}");
    }
    assert!((path.duration_s() - 15.0).abs() < 1e-9, "{}", path.duration_s());
}

#[test]
fn a_flight_rises_rolls_and_pitches() {
    let mut points =
        vec![waypoint(&[0.0, 0.0, 5.0], Some(1.0), 0.0), waypoint(&[10.0, 0.0, 15.0], None, 0.0)];
    points[1].roll_deg = Finite(10.0);
    points[1].pitch_deg = Finite(-6.0);
    let path = Path::new(&spec(points), "t").unwrap();
    assert!(path.is_in_the_air());
    let middle = path.world_from_body(0.5 * path.duration_s());
    assert!((middle.translation.vector - Vector3::new(5.0, 0.0, 10.0)).norm() < 1e-6);
    // Half of either angle: the front 3 degrees down, the left side 5 degrees up.
    let front = middle.rotation * Vector3::x();
    assert!((front - angle::direction(0.0, -3.0)).norm() < 1e-6, "{front}");
    let left = middle.rotation * Vector3::y();
    assert!((left.z - 5_f64.to_radians().sin() * 3_f64.to_radians().cos()).abs() < 1e-6, "{left}");
}

#[test]
fn a_body_that_looks_at_a_point_turns_to_it() {
    let mut arc = spec(vec![waypoint(&[0.0, -3.0], Some(1.0), 0.0), waypoint(&[3.0, 0.0], None, 0.0)]);
    arc.look_at_m = Some([0.0, 0.0].map(Finite));
    let path = Path::new(&arc, "t").unwrap();
    let front = |t| path.world_from_body(t).rotation * Vector3::x();
    assert!((front(0.0) - Vector3::y()).norm() < 1e-9);
    assert!((front(1e3) + Vector3::x()).norm() < 1e-9);
}

#[test]
fn one_way_point_is_a_place_to_stand() {
    let path = Path::new(&spec(vec![waypoint(&[2.0, 3.0], None, 4.0)]), "t").unwrap();
    assert!((path.duration_s() - 4.0).abs() < 1e-12);
    assert_eq!(path.world_from_body(1.0), Pose::translation(2.0, 3.0, 0.0));
    assert_eq!(path.velocity_mps(1.0), Vector3::zeros());
}

#[test]
fn impossible_paths_are_refused() {
    for (points, named) in [
        (vec![], "1 to 10000 way-points"),
        (vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], "way-points 1 and 2"),
        (vec![[0.0, 0.0], [5.0, 0.0], [0.0, 1.0]], "at way-point 1"),
    ] {
        let points: Vec<&[f64]> = points.iter().map(|p: &[f64; 2]| &p[..]).collect();
        let error = path(&points).unwrap_err().to_string();
        assert!(error.starts_with("trajectory.waypoints: ") && error.contains(named), "{error}");
    }
    let slow = spec(vec![waypoint(&[0.0, 0.0], None, 0.0), waypoint(&[1.0, 0.0], Some(1.0), 0.0)]);
    let error = Path::new(&slow, "t").unwrap_err().to_string();
    assert!(error.contains("speed_mps at the first way-point"), "{error}");
}
