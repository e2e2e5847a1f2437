//! The safety map of a laser against the exact one: what a nearly perfect sensor gets.
#![allow(clippy::unwrap_used)]

use evigrid_grid::safe_ground::SafetyRules;
use evigrid_replay::{Sequence, map_from_world};
use evigrid_synth::{SafetyTruth, SyntheticSequence, World};
use evigrid_truth::{LaserSafety, RobotPlace};

/// A world with one scanner of 64 beams that looks down from over the robot's head, in place of its own.
fn world(name: &str) -> World {
    let path = format!("{}/../../datasets/synth/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut world: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let laser = "beams = 64\ntop_deg = -2.0\nbottom_deg = -60.0\nstep_deg = 0.5\nrange_m = 30.0\n\
                 range_noise_m = 0.01\nmount_m = [0.0, 0.0, 1.5]";
    world.insert("laser".into(), toml::Value::Array(vec![toml::Value::Table(laser.parse().unwrap())]));
    World::from_toml(&world.to_string()).unwrap()
}

/// Cells that are unsafe and safe in the exact map, each as: the same in the laser's, the opposite, unknown. Cells
/// beside a border between safe and unsafe ones are left out: the laser cannot resolve them.
fn compared(name: &str) -> [[usize; 3]; 2] {
    let world = world(name);
    let spec = world.truth_grid();
    let map_from_world = map_from_world(&world.true_world_from_left(0));
    let exact = SafetyTruth::new(&world, spec, &map_from_world, 0, &SafetyRules::default()).unwrap();
    let sequence = SyntheticSequence::new(world);
    let mounting = sequence.info().mounting.unwrap();
    let mut laser = LaserSafety::new(spec.plan(), SafetyRules::default(), 0.5);
    let mut start = None;
    for frame in (0..sequence.info().frame_count).step_by(6) {
        let pose = map_from_world * sequence.world_from_left(frame).unwrap();
        let floor_m = pose.translation.z - mounting.height_m;
        let robot = RobotPlace { at_m: mounting.robot_m(&pose), floor_m, height_m: 1.3, radius_m: 6.0 };
        laser.add_scan(&sequence.laser(frame, &map_from_world).unwrap().unwrap(), &robot);
        start.get_or_insert(robot);
    }
    let found = laser.map(&start.unwrap());
    let mut counts = [[0; 3]; 2];
    for (cell, label) in exact.labels().iter().enumerate() {
        let Some(safe) = label.is_safe() else { continue };
        let is_opposite = |other: usize| exact.labels()[other].is_safe() == Some(!safe);
        if spec.plan().neighbours(cell).any(is_opposite) {
            continue;
        }
        let verdict = match found.labels()[cell].is_safe() {
            Some(found) => usize::from(found != safe),
            None => 2,
        };
        counts[usize::from(safe)][verdict] += 1;
    }
    counts
}

/// Of the cells that both classify at most one in a hundred is the opposite (a map of one label would have all of
/// one kind wrong), and the laser classifies nearly all safe cells.
#[test]
fn a_laser_hardly_ever_says_the_opposite_of_the_exact_map() {
    for name in ["safety-1", "safety-3"] {
        let [of_unsafe, of_safe] = compared(name);
        for [same, opposite, _] in [of_unsafe, of_safe] {
            assert!(same > 300 && 100 * opposite <= same + opposite, "{name}: {of_unsafe:?} {of_safe:?}");
        }
        let [safe, _, unknown] = of_safe;
        assert!(20 * unknown <= safe, "{name}: {of_safe:?}");
    }
}
