use evigrid_core::Pose;
use evigrid_grid::GridSpec;
use evigrid_replay::map_from_world;
use nalgebra::UnitQuaternion;

use super::super::fixtures::{a_box, grid, object, turned_map, world};
use super::super::safety::SafetyTruth;
use super::super::terrain::{GroundColumn, TerrainTruth};
use super::*;
use crate::World;
use evigrid_grid::safe_ground::SafetyRules;

fn truths(world: &World, spec: GridSpec, map_from_world: &Pose) -> (SafetyTruth, TerrainTruth) {
    let safety = SafetyTruth::new(world, spec, map_from_world, 0, &SafetyRules::default()).unwrap();
    (safety, TerrainTruth::new(world, spec, map_from_world, 0).unwrap())
}

/// Height of a plane at a place, metres.
fn height_m(plane: &SafetyPlane, [x, y]: [f64; 2]) -> f64 {
    (plane.offset_m - plane.normal.x * x - plane.normal.y * y) / plane.normal.z
}

/// The labels are those of the truth; safe cells lie on the true surface at their centres, others on no
/// plane; no two planes are the same, and all are needed.
fn check(safety: &SafetyTruth, terrain: &TerrainTruth) -> SafetyMap {
    let map = safety.map();
    assert_eq!(map.labels(), safety.labels());
    assert_eq!(*map.spec(), safety.spec().plan());
    for (flat, label) in map.labels().iter().enumerate() {
        let plane = map.plane_of(flat);
        assert_eq!(plane.is_some(), label.is_safe() == Some(true), "{flat}");
        let (Some(plane), GroundColumn::Surface(surface)) = (plane, terrain.columns()[flat]) else {
            continue;
        };
        let height_m = height_m(plane, map.spec().centre_m(flat));
        assert!((height_m - surface.height_m).abs() < 1e-8, "{flat}: {height_m} {surface:?}");
        assert!((plane.normal - surface.normal).norm() < 1e-8, "{flat}: {plane:?}");
    }
    for (number, plane) in map.planes().iter().enumerate() {
        assert!(!map.planes()[..number].iter().any(|other| is_same(other, plane)), "{plane:?}");
        assert!(map.plane_numbers().contains(&Some(number as u32)), "{plane:?}");
    }
    map
}

#[test]
fn the_cells_of_every_safety_world_lie_on_its_planes() {
    for name in ["safety-1", "safety-2", "safety-3", "safety-4", "safety-5"] {
        let world = World::builtin(name).unwrap();
        let map_from_world = map_from_world(&world.true_world_from_left(0));
        let (safety, terrain) = truths(&world, world.truth_grid(), &map_from_world);
        let map = check(&safety, &terrain);
        let safe = map.labels().iter().filter(|label| label.is_safe() == Some(true)).count();
        assert!(safe > 100 && !map.planes().is_empty(), "{name}: {safe} cells");
        assert!(map.planes().len() < 20, "{name}: {} planes", map.planes().len());
    }
}

#[test]
fn cells_share_a_plane_exactly_if_their_surfaces_lie_on_it() {
    // Two boxes of one height, a low step, and a ramp; in a map that is turned, so that normals are rounded.
    let world = world(&[
        a_box([6.0, 8.0, 1.0], [1.0, 0.0, -0.5], ""),
        a_box([2.0, 8.0, 3.0], [5.0, 0.0, -1.5], ""),
        a_box([2.0, 8.0, 1.0], [7.0, 0.0, -0.47], ""),
        object(
            "ramp = { run_m = 4.0, rise_m = 0.3, width_m = 8.0, thickness_m = 0.1 }",
            [10.0, 0.0, 0.18],
            "",
        ),
    ]);
    let spec = grid([0.0, 12.0], [-2.0, 2.0], [0.0, 1.0], 0.1);
    let (safety, terrain) = truths(&world, spec, &turned_map());
    let map = check(&safety, &terrain);
    let normals: Vec<Vector3<f64>> =
        map.planes().iter().map(|plane| turned_map().inverse().rotation * plane.normal).collect();
    assert_eq!(normals.len(), 3, "{:?}", map.planes());
    let slopes = normals.iter().map(|normal| normal.xy().norm() / normal.z);
    for (slope, expected) in slopes.zip([0.0, 0.0, 0.075]) {
        assert!((slope - expected).abs() < 1e-9, "{slope}");
    }
}

#[test]
fn planes_across_a_step_of_the_search_are_one() {
    let mut map = SafetyMap::unknown(grid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], 0.5).plan());
    let mut known = KnownPlanes::default();
    let mut number = |offset_m: f64, turn: f64| {
        let normal = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), turn) * Vector3::z();
        known.number(&mut map, SafetyPlane { normal, offset_m })
    };
    let found = [(0.0, 0.0), (-4e-10, 0.0), (4e-10, 1e-10), (3e-9, 0.0), (0.0, 0.1), (2.6e-9, 0.0)];
    assert_eq!(found.map(|(offset_m, turn)| number(offset_m, turn)), [0, 0, 0, 1, 2, 1]);
}
