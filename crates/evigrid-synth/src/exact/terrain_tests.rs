use super::super::fixtures::{a_box, grid, object, turned_map, world};
use super::*;

#[test]
fn heights_and_slopes_are_those_of_the_shapes() {
    // The robot stands at (1, 0.5) on a floor at 0.02; a wall at x = 4 to 5 and nothing
    // beyond x = 8; a ramp; a bridge.
    let world = world(&[
        a_box([8.0, 6.0, 1.0], [4.0, 0.0, -0.48], ""),
        a_box([1.0, 1.0, 3.0], [4.5, 0.5, 1.5], ""),
        object(
            "ramp = { run_m = 2.0, rise_m = 0.2, width_m = 1.0, thickness_m = 0.1 }",
            [6.0, -1.5, 0.3],
            "yaw_deg = 180.0",
        ),
        a_box([1.0, 1.0, 0.3], [6.5, 1.5, 1.45], ""),
        a_box([0.2, 0.2, 0.2], [2.0, 0.5, 1.0], "motion = { velocity_mps = [1.0, 0.0, 0.0] }"),
    ]);
    let truth =
        TerrainTruth::new(&world, grid([0.0, 10.0], [-3.0, 3.0], [0.0, 1.0], 0.5), &Pose::identity(), 0)
            .unwrap();
    let at = |i: usize, j: usize| truth.columns()[i * 12 + j];
    let surface = |i: usize, j: usize| match at(i, j) {
        GroundColumn::Surface(surface) => surface,
        other => panic!("{i} {j}: {other:?}"),
    };
    let floor = surface(2, 2);
    assert!((floor.height_m - 0.02).abs() < 1e-12 && floor.thing == 0 && floor.slope_rad() == 0.0);
    assert_eq!(surface(13, 9).thing, 0, "below the bridge");
    assert_eq!(surface(3, 7).thing, 0, "where the moving thing is at the start");
    assert_eq!(at(9, 7), GroundColumn::Filled { thing: 1 });
    assert_eq!(at(17, 3), GroundColumn::Empty);
    // The ramp falls along x from 0.4 at x = 5 to 0.2 at x = 7.
    for i in 10..14 {
        let (x, ramp) = (0.5 * (i as f64 + 0.5), surface(i, 3));
        assert!((ramp.height_m - (0.3 - 0.1 * (x - 6.0))).abs() < 1e-9, "{ramp:?}");
        assert!((ramp.slope_rad() - 0.1_f64.atan()).abs() < 1e-9 && ramp.normal.x > 0.0);
        assert!((ramp.surface().height_at([0.25, 7.0]) - (ramp.height_m - 0.025)).abs() < 1e-9);
    }
    let (heights, slopes) = (truth.heights_m(), truth.slopes_deg());
    let flat = 12 * 12 + 3;
    assert!((f64::from(heights[flat]) - 0.275).abs() < 1e-6 && (slopes[flat] - 5.710_593).abs() < 1e-5);
    for nan in [9 * 12 + 7, 17 * 12 + 3] {
        assert!(heights[nan].is_nan() && slopes[nan].is_nan());
    }
}

#[test]
fn the_map_frame_moves_heights_and_cells_along() {
    let world = world(&[
        a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], ""),
        object("ramp = { run_m = 3.0, rise_m = 0.6, width_m = 9.0, thickness_m = 0.1 }", [6.0, 0.0, 0.4], ""),
    ]);
    let spec = grid([0.0, 10.0], [-3.0, 3.0], [0.0, 1.0], 0.25);
    let truth = TerrainTruth::new(&world, spec, &turned_map(), 0).unwrap();
    let mut on_ramp = 0;
    for (flat, column) in truth.columns().iter().enumerate() {
        let GroundColumn::Surface(surface) = column else { panic!("{flat}: {column:?}") };
        let [x, y] = cell_point(&spec, [flat / 24, flat % 24], [0.5, 0.5]);
        let in_world = turned_map().inverse() * Point3::new(x, y, surface.height_m);
        // The face at the ramp's upper end leans over.
        if (7.5..7.53).contains(&in_world.x) {
            continue;
        }
        let expected = if surface.thing == 1 { 0.4 + (in_world.x - 6.0) * 0.2 } else { 0.0 };
        assert!((in_world.z - expected).abs() < 1e-9, "{in_world}");
        let normal = turned_map().inverse().rotation * surface.normal;
        let slope = if surface.thing == 1 { 0.2 } else { 0.0 };
        assert!((normal.x / normal.z + slope).abs() < 1e-9 && normal.y.abs() < 1e-9);
        on_ramp += usize::from(surface.thing == 1);
    }
    assert!(on_ramp > 250, "{on_ramp}");
}

#[test]
fn a_world_without_a_robot_or_with_one_in_a_wall_has_no_ground() {
    let spec = grid([0.0, 10.0], [-3.0, 3.0], [0.0, 1.0], 0.25);
    let message =
        |world: &World| TerrainTruth::new(world, spec, &Pose::identity(), 0).unwrap_err().to_string();
    let without = World::from_toml(include_str!("../../tests/box.toml")).unwrap();
    assert!(message(&without).starts_with("robot: expected a table [robot]"), "{}", message(&without));
    let nowhere = world(&[a_box([1.0, 1.0, 1.0], [9.0, 0.0, 0.5], "")]);
    assert!(message(&nowhere).ends_with("room for its height, found no ground"), "{}", message(&nowhere));
    let walled = world(&[a_box([1.0, 0.2, 1.3], [1.0, 0.4, 0.65], "")]);
    assert!(message(&walled).ends_with("found a solid around its top"), "{}", message(&walled));
}
