//! Safe ground from laser points of scenes made by hand. Cells are 0.2 m wide; the robot stands at the origin on a
//! floor at the height 0.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{LaserScan, Pose};
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap};
use evigrid_truth::{LaserSafety, RobotPlace};

const ROBOT: RobotPlace = RobotPlace { at_m: [0.0, 0.0], floor_m: 0.0, height_m: 1.5, radius_m: 6.0 };

/// Points of a surface every 4 cm; NaN: the laser saw nothing there. The laser stands 1 m over the floor.
fn truth(height_m: impl Fn([f64; 2]) -> f64, robot: &RobotPlace) -> SafetyMap {
    let spec = PlanSpec::of_area([-4.0, 4.0], [-3.0, 3.0], 0.2).unwrap();
    let at = |n: i32| 0.04 * f64::from(n) + 0.02;
    let points = (-100..100).flat_map(|i| (-75..75).map(move |j| [at(i), at(j)]));
    let points = points.map(|[x, y]| [x, y, height_m([x, y])]).filter(|p| p[2].is_finite());
    let points = points.map(|[x, y, z]| [x as f32, y as f32, (z - 1.0) as f32]).collect();
    let scan = LaserScan::new(points, Pose::translation(0.0, 0.0, 1.0)).unwrap();
    let mut truth = LaserSafety::new(spec, SafetyRules::default(), 0.0);
    truth.add_scan(&scan, robot);
    truth.map(robot)
}

fn at(map: &SafetyMap, x: f64, y: f64) -> SafetyLabel {
    map.labels()[map.spec().cell_of([x, y]).unwrap()]
}

use SafetyLabel::{Inclined, Level, NonGround, Unknown};

#[test]
fn a_step_of_8_cm_is_unsafe_and_one_of_2_cm_is_not() {
    for (step_m, beyond) in [(0.08, NonGround), (0.02, Level)] {
        let map = truth(|[x, _]| if x > 1.0 { step_m } else { 0.0 }, &ROBOT);
        assert_eq!((at(&map, 0.5, 0.1), at(&map, 2.1, 0.1)), (Level, beyond), "{step_m}");
    }
}

/// A kerb within a cell: between 5 and 10 cm it is unclear, from 10 cm on an edge. What lies beyond cannot be
/// reached in either case.
#[test]
fn kerbs_within_a_cell() {
    for (step_m, kerb) in [(0.07, Unknown), (0.15, NonGround)] {
        let map = truth(|[x, _]| if x > 1.1 { step_m } else { 0.0 }, &ROBOT);
        assert_eq!((at(&map, 1.1, 0.1), at(&map, 2.1, 0.1)), (kerb, NonGround), "{step_m}");
    }
}

#[test]
fn ramps_are_inclined_up_to_10_degrees() {
    for (slope_deg, label) in [(1.0_f64, Level), (7.0, Inclined), (14.0, NonGround)] {
        let map = truth(|[x, _]| (x - 1.0).max(0.0) * slope_deg.to_radians().tan(), &ROBOT);
        assert_eq!((at(&map, 0.3, 0.1), at(&map, 2.5, 0.1)), (Level, label), "{slope_deg}");
    }
}

/// A wall is unsafe; a roof over the robot's head does not matter.
#[test]
fn obstacles_are_what_the_robot_can_hit() {
    let wall = |[x, y]: [f64; 2]| if (x - 2.0).abs() < 0.1 && y > 0.0 { 1.0 + y % 0.4 } else { 0.0 };
    let map = truth(wall, &ROBOT);
    assert_eq!((at(&map, 2.05, 1.1), at(&map, 2.05, -1.1)), (NonGround, Level));
    let map = truth(wall, &RobotPlace { height_m: 0.9, ..ROBOT });
    assert_eq!((at(&map, 2.5, 1.1), at(&map, 2.05, -1.1)), (Level, Level));
}

/// Ground behind a strip that the laser did not see may be reachable: unknown. Behind a step it is not.
#[test]
fn what_the_laser_did_not_see_is_unknown() {
    let strip = |[x, _]: [f64; 2]| if (1.0..1.6).contains(&x) { f64::NAN } else { 0.0 };
    let map = truth(strip, &ROBOT);
    assert_eq!((at(&map, 0.5, 0.1), at(&map, 1.3, 0.1), at(&map, 2.5, 0.1)), (Level, Unknown, Unknown));
    // Three cells of the strip are as good as a wall: a robot needs five.
    let slit = |[x, y]: [f64; 2]| match x {
        x if x < 1.0 => 0.0,
        x if x < 1.6 && y.abs() < 0.3 => f64::NAN,
        x if x < 1.6 => 1.0,
        _ => 0.3,
    };
    assert_eq!(at(&truth(slit, &ROBOT), 2.5, 0.1), NonGround);
}

/// Only points within the planning radius count; without floor at the robot's height nothing is known.
#[test]
fn the_robot_decides_what_counts() {
    let map = truth(|_| 0.0, &RobotPlace { radius_m: 2.0, ..ROBOT });
    assert_eq!((at(&map, 1.5, 0.1), at(&map, 2.5, 0.1)), (Level, Unknown));
    let map = truth(|_| 0.0, &RobotPlace { floor_m: -3.0, height_m: 9.0, ..ROBOT });
    assert!(map.labels().iter().all(|label| *label == Unknown));
    let map = truth(|_| f64::NAN, &ROBOT);
    assert!(map.labels().iter().all(|label| *label == Unknown));
}
