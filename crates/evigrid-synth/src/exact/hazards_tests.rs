use std::collections::BTreeSet;

use evigrid_grid::SafetyLabel;
use evigrid_replay::map_from_world;
use nalgebra::{UnitQuaternion, Vector3};

use super::*;
use crate::exact::SafetyTruth;
use crate::exact::fixtures::{a_box, grid, world};
use evigrid_grid::safe_ground::SafetyRules;

/// A floor with a block of 1 m x 1 m about (6.5, 0.5), and these areas.
fn block(areas: &str) -> World {
    world(&[
        a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], ""),
        a_box([1.0, 1.0, 1.0], [6.5, 0.5, 0.5], ""),
        areas.to_owned(),
    ])
}

fn hazard(x_m: [f64; 2], y_m: [f64; 2], yaw_deg: f64) -> String {
    format!(
        "\n[[hazard]]\nname = \"block\"\nkind = \"obstacle\"\n\
         x_m = {x_m:?}\ny_m = {y_m:?}\nyaw_deg = {yaw_deg:?}\n"
    )
}

fn safe_area(x_m: [f64; 2], y_m: [f64; 2], yaw_deg: f64) -> String {
    format!("\n[[safe_area]]\nname = \"floor\"\nx_m = {x_m:?}\ny_m = {y_m:?}\nyaw_deg = {yaw_deg:?}\n")
}

/// The hazards on cells of 1 m: flat index 10 i + j for the cell over [i, i + 1) x [j - 5, j - 4) of the
/// world.
fn on_metres(areas: &str) -> Result<Vec<Hazard>, SynthError> {
    let world = block(areas);
    let spec = grid([0.0, 10.0], [-5.0, 5.0], [-2.0, 2.0], 1.0);
    let map = Pose::identity();
    let truth = SafetyTruth::new(&world, spec, &map, 0, &SafetyRules::default()).unwrap();
    hazards(&world, &map, &truth.map())
}

#[test]
fn a_hazard_has_the_unsafe_cells_of_its_area_and_a_safe_area_the_safe_ones() {
    let area = ([5.9, 7.1], [-0.6, 1.6]);
    let found = on_metres(&(hazard(area.0, area.1, 0.0) + &safe_area(area.0, area.1, 0.0))).unwrap();
    let block = Hazard { name: "block".to_owned(), kind: HazardKind::Obstacle, cells: vec![65] };
    let floor = Hazard { name: "floor".to_owned(), kind: HazardKind::SafeArea, cells: vec![64, 66] };
    assert_eq!(found, [block, floor]);
}

#[test]
fn areas_turn_about_their_centre() {
    let cells = |yaw_deg| on_metres(&safe_area([2.5, 6.5], [0.2, 0.8], yaw_deg)).unwrap()[0].cells.clone();
    assert_eq!(cells(0.0), [25, 35, 45, 55]);
    assert_eq!(cells(45.0), [34, 45, 56], "along the diagonal");
    assert_eq!(cells(90.0), [43, 44, 45, 46, 47]);
    assert_eq!(cells(-45.0), [36, 45, 54]);
}

#[test]
fn areas_stay_where_they_are_when_the_map_turns() {
    let world = block(&(hazard([5.9, 7.1], [-0.6, 1.6], 0.0) + &safe_area([5.9, 7.1], [1.0, 1.9], 0.0)));
    // The map's x is the world's y: the point (6.5, 0.5) of the world is (0.5, -6.5) of the map.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2);
    let map = Pose::from_parts(Vector3::zeros().into(), turn);
    let spec = grid([-5.0, 5.0], [-10.0, 0.0], [-2.0, 2.0], 1.0);
    let truth = SafetyTruth::new(&world, spec, &map, 0, &SafetyRules::default()).unwrap();
    let found = hazards(&world, &map, &truth.map()).unwrap();
    assert_eq!((&found[0].cells[..], &found[1].cells[..]), (&[53][..], &[63][..]));
}

#[test]
fn an_area_without_cells_is_refused_by_its_name() {
    let message = |areas: &str| on_metres(areas).unwrap_err().to_string();
    let expected =
        "hazard block: expected at least one unsafe cell of the safety map in its area, found none";
    assert_eq!(message(&hazard([2.0, 4.0], [0.0, 1.0], 0.0)), expected, "a safe place");
    assert_eq!(message(&hazard([20.0, 21.0], [0.0, 1.0], 0.0)), expected, "outside of the grid");
    let expected =
        "safe_area floor: expected at least one safe cell of the safety map in its area, found none";
    assert_eq!(message(&safe_area([6.0, 7.0], [0.0, 1.0], 0.0)), expected);
}

/// The true safety map of a built-in world as it lies on disk, and the map's frame.
fn built_in(name: &str) -> (World, Pose, SafetyMap) {
    let world = World::builtin(name).unwrap();
    let map = map_from_world(&world.true_world_from_left(0));
    let truth = SafetyTruth::new(&world, world.truth_grid(), &map, 0, &SafetyRules::default()).unwrap();
    (world, map, truth.map())
}

#[test]
fn every_hazard_of_a_built_in_world_has_cells_and_all_of_a_safe_area_is_safe() {
    for name in World::builtin_names() {
        if World::builtin(name).unwrap().areas.is_empty() {
            assert!(!name.starts_with("safety-"), "{name}");
            continue;
        }
        let (world, map, truth) = built_in(name);
        let found = hazards(&world, &map, &truth).unwrap();
        assert_eq!(found.len(), world.areas.len());
        for (hazard, NamedArea { area, .. }) in found.iter().zip(&world.areas) {
            let all: Vec<usize> = cells_in(area, truth.spec(), &map.inverse()).collect();
            // A bollard fills the fewest cells.
            assert!(hazard.cells.len() >= 8, "{name}: {hazard:?}");
            assert!(!hazard.kind.is_safe() || hazard.cells == all, "{name}: {hazard:?}");
        }
    }
}

/// Built-in worlds, and from where to where along x and y their inside reaches, 0.1 m from the walls.
const INSIDE_M: [(&str, [f64; 2], [f64; 2]); 5] = [
    ("safety-1", [-4.9, 11.9], [-3.9, 4.4]),
    ("safety-2", [-4.4, 8.9], [-3.1, 2.9]),
    ("safety-3", [-4.4, 10.9], [-3.7, 3.7]),
    ("safety-4", [-4.4, 10.4], [-3.1, 4.9]),
    ("safety-5", [-4.9, 12.9], [-8.1, 2.3]),
];

#[test]
fn hardly_an_unsafe_cell_between_the_walls_of_a_built_in_world_is_in_no_hazard() {
    for (name, x_m, y_m) in INSIDE_M {
        let (world, map, truth) = built_in(name);
        let inside = Area::between(x_m, y_m);
        let unsafe_cells: Vec<usize> = cells_in(&inside, truth.spec(), &map.inverse())
            .filter(|&flat| truth.labels()[flat] == SafetyLabel::NonGround)
            .collect();
        let hazards = hazards(&world, &map, &truth).unwrap();
        let hazards = hazards.iter().filter(|hazard| !hazard.kind.is_safe());
        let named: BTreeSet<usize> = hazards.flat_map(|hazard| hazard.cells.iter().copied()).collect();
        let forgotten = unsafe_cells.iter().filter(|flat| !named.contains(flat)).count();
        let all = unsafe_cells.len();
        // A door of safety-2 stands out of its wall.
        assert!(all > 1500 && forgotten <= 3, "{name}: {forgotten} of {all} unsafe cells");
    }
}
