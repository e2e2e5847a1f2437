use evigrid_core::Pose;
use nalgebra::{Translation3, UnitQuaternion};
use proptest::prelude::*;

use super::super::touch::Relation;
use super::*;

fn object(shape: Shape, pose: &Pose) -> Object {
    let mut object = Object {
        shape,
        centre: Point3::origin(),
        local_from_world: Matrix3::identity(),
        material: 0,
        seed: 0,
        thing: 0,
    };
    object.place(pose);
    object
}

fn at(x: f64, y: f64, z: f64, yaw: f64) -> Pose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Pose::from_parts(Translation3::new(x, y, z), rotation)
}

const CUBE: Cube = Cube { centre: Point3::new(0.0, 0.0, 0.0), half_m: 0.1 };

/// Whether one of very many points is in no solid.
fn has_air_in_samples(solids: &[&Object]) -> bool {
    let place = |i: usize| CUBE.half_m * (f64::from(i as u32) / 24.0 - 1.0);
    (0..49 * 49 * 49).any(|i| {
        let point = Point3::new(place(i / 2401), place(i / 49 % 49), place(i % 49));
        is_air(&point, solids)
    })
}

/// A solid large enough to fill much of the cube.
fn solid() -> impl Strategy<Value = Object> {
    let shape = prop_oneof![
        3 => prop::array::uniform3(0.1..0.6_f64).prop_map(|half| Shape::Box { half: Vector3::from(half) }),
        1 => (0.15..0.6_f64, 0.1..0.6_f64)
            .prop_map(|(radius, half_height)| Shape::Cylinder { radius, half_height }),
        1 => (0.2..0.7_f64).prop_map(|radius| Shape::Sphere { radius }),
    ];
    let turn = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-3.1..3.1_f64)];
    (shape, prop::array::uniform3(-0.35..0.35_f64), turn).prop_map(|(shape, at, [yaw, pitch, roll])| {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        object(shape, &Pose::from_parts(Translation3::from(Vector3::from(at)), rotation))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn no_pocket_between_boxes_is_missed(
        solids in prop::collection::vec(solid(), 2..5),
    ) {
        let is_cut = |solid: &&Object| CUBE.relation(solid) == Relation::Cut;
        let cutting: Vec<&Object> = solids.iter().filter(is_cut).collect();
        prop_assume!(cutting.len() > 1);
        let found = has_air(&CUBE, &cutting);
        let are_boxes = cutting.iter().all(|solid| matches!(solid.shape, Shape::Box { .. }));
        if has_air_in_samples(&cutting) && are_boxes {
            prop_assert!(found);
        }
        // Curved faces may hide a pocket from it, but only one that none of its own points is in.
        let coarse = (0..1000).any(|i| {
            let place = |i: usize| CUBE.half_m * ((2 * i + 1) as f64 / 10.0 - 1.0);
            is_air(&Point3::new(place(i / 100), place(i / 10 % 10), place(i % 10)), &cutting)
        });
        prop_assert!(found || !coarse);
    }
}

#[test]
fn a_crack_is_an_opening_only_if_it_is_wide_enough() {
    let half = Vector3::repeat(1.0);
    let is_open = |gap: f64, yaw: f64| {
        // Both turned alike, so that the crack is as wide as the gap.
        let turned = |x: f64| object(Shape::Box { half }, &(at(0.0, 0.0, 0.0, yaw) * at(x, 0.0, 0.0, 0.0)));
        let (left, right) = (turned(0.0337 - 1.0), turned(0.0337 + 1.0 + gap));
        has_air(&CUBE, &[&left, &right])
    };
    for yaw in [0.0, 0.4, 2.0] {
        let found = [0.0, 1e-12, 1e-5, 5e-4, 5e-3, 0.02].map(|gap| is_open(gap, yaw));
        assert_eq!(found, [false, false, false, true, true, true], "{yaw}");
    }
}

#[test]
fn three_boxes_that_leave_a_wedge() {
    let half = Vector3::repeat(1.0);
    let left = object(Shape::Box { half }, &at(-1.0, 0.0, 0.0, 0.0));
    // Its face passes through the origin, turned a little: a wedge of 1.4 mm is left on one side.
    let wedge = |yaw: f64| object(Shape::Box { half }, &(at(0.0, 0.0, 0.0, yaw) * at(1.0, 0.0, 0.0, 0.0)));
    assert!(has_air(&CUBE, &[&left, &wedge(0.014)]));
    assert!(!has_air(&CUBE, &[&left, &wedge(0.0)]));
    let lid = |y: f64| object(Shape::Box { half }, &at(0.0, y, 0.0, 0.0));
    let (low, high) = (lid(-1.0), lid(1.0));
    assert!(!has_air(&CUBE, &[&left, &wedge(0.014), &low, &high]));
    // A turn to the left opens the wedge where y is below zero.
    assert!(!has_air(&CUBE, &[&left, &wedge(0.014), &low]));
    assert!(has_air(&CUBE, &[&left, &wedge(0.014), &high]));
}
