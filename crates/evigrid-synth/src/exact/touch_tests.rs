use std::sync::Arc;

use evigrid_core::Pose;
use nalgebra::{Translation3, UnitQuaternion};
use proptest::prelude::*;

use super::*;

fn solids() -> Vec<Shape> {
    vec![
        Shape::Box { half: Vector3::new(1.0, 0.5, 0.25) },
        Shape::Box { half: Vector3::new(3.0, 0.02, 0.9) },
        Shape::Cylinder { radius: 0.6, half_height: 1.1 },
        Shape::Cylinder { radius: 0.9, half_height: 0.05 },
        Shape::Cylinder { radius: 0.005, half_height: 1.5 },
        Shape::Sphere { radius: 0.9 },
    ]
}

fn mesh_of_box(half: &Vector3<f64>) -> Shape {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vector3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Shape::Mesh(Arc::new(Mesh::new((0..8).map(corner).collect(), triangles).unwrap()))
}

fn object(shape: Shape, pose: &Pose) -> Object {
    let (centre, local_from_world) = (Point3::origin(), Matrix3::identity());
    let mut object = Object { shape, centre, local_from_world, material: 0, seed: 0, thing: 0 };
    object.place(pose);
    object
}

/// The point of the shape that is nearest to `p`, by the definition of the shape.
fn nearest(shape: &Shape, p: &Vector3<f64>) -> Vector3<f64> {
    match shape {
        Shape::Box { half } => p.sup(&-half).inf(half),
        Shape::Cylinder { radius, half_height } => {
            let share = (radius / p.xy().norm()).min(1.0);
            Vector3::new(p.x * share, p.y * share, p.z.clamp(-half_height, *half_height))
        }
        Shape::Sphere { radius } => p * (radius / p.norm()).min(1.0),
        Shape::Mesh(_) => *p,
    }
}

/// The largest coordinate of a point of the shape along a direction, by the definition of the shape.
fn reach(shape: &Shape, direction: &Vector3<f64>) -> f64 {
    match shape {
        Shape::Box { half } => half.dot(&direction.abs()),
        Shape::Cylinder { radius, half_height } => {
            radius * direction.xy().norm() + half_height * direction.z.abs()
        }
        Shape::Sphere { radius } => radius * direction.norm(),
        Shape::Mesh(_) => f64::NAN,
    }
}

/// Whether the cube touches the shape, by going from the nearest point of one to the nearest of the other, to
/// and fro (Cheney and Goldstein 1959: this ends at the smallest distance of two convex sets). They touch if
/// the points meet; they do not if a plane across the way between the points separates them. Nothing if
/// neither comes soon.
fn touches_slowly(cube: &Cube, object: &Object) -> Option<bool> {
    let [low, high] = cube.bounds();
    let mut p = cube.centre;
    for _ in 0..3000 {
        let q = object.centre + object.in_world(&nearest(&object.shape, &object.local_point(&p)));
        p = q.coords.sup(&low).inf(&high).into();
        let way = p - q;
        if way.norm() < 1e-9 {
            return Some(true);
        }
        let across = way.normalize();
        let of_cube = across.dot(&cube.centre.coords) - cube.half_m * across.abs().sum();
        let local = object.local_from_world * across;
        if of_cube > across.dot(&object.centre.coords) + reach(&object.shape, &local) + 1e-9 {
            return Some(false);
        }
    }
    None
}

fn pose() -> impl Strategy<Value = Pose> {
    let turn = prop_oneof![
        Just([0.0; 3]),
        (-3.1..3.1_f64).prop_map(|yaw| [yaw, 0.0, 0.0]),
        prop::array::uniform3(-3.1..3.1_f64),
    ];
    (prop::array::uniform3(-2.0..2.0_f64), turn).prop_map(|(at, [yaw, pitch, roll])| {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Pose::from_parts(Translation3::from(Vector3::from(at)), rotation)
    })
}

fn cube() -> impl Strategy<Value = Cube> {
    (prop::array::uniform3(-1.0..1.0_f64), 0.02..0.8_f64)
        .prop_map(|(at, half_m)| Cube { centre: Point3::from(at), half_m })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn cubes_touch_what_no_plane_separates_from_them(pose in pose(), cube in cube()) {
        for shape in solids() {
            let object = object(shape, &pose);
            let found = cube.relation(&object);
            if let Some(expected) = touches_slowly(&cube, &object) {
                prop_assert_eq!(found != Relation::Apart, expected, "{:?}", object.shape);
            }
            let is_inside = cube.corners().iter().all(|corner| object.contains(corner));
            prop_assert_eq!(found == Relation::Inside, is_inside, "{:?}", object.shape);
        }
    }

    #[test]
    fn a_mesh_of_a_box_is_touched_where_the_box_is(pose in pose(), cube in cube()) {
        for shape in solids() {
            let Shape::Box { half } = shape else { continue };
            let (mesh, exact) = (object(mesh_of_box(&half), &pose), object(shape, &pose));
            prop_assert_eq!(cube.relation(&mesh), cube.relation(&exact));
        }
    }

    #[test]
    fn a_triangle_touches_a_cube_if_one_of_its_points_is_in_it(
        corners in prop::array::uniform3(prop::array::uniform3(-1.5..1.5_f64)),
        half_m in 0.05..0.8_f64,
    ) {
        let corners = corners.map(Vector3::from);
        let [a, b, c] = corners;
        prop_assume!((b - a).cross(&(c - a)).norm() > 0.05);
        let steps = 400;
        let share = |i: i32| f64::from(i) / f64::from(steps);
        let points = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| (i, j)));
        let largest = points.map(|(i, j)| (a + (b - a) * share(i) + (c - a) * share(j)).amax());
        let nearest = largest.fold(f64::MAX, f64::min);
        // The largest step between two points of the lattice.
        let step = ((b - a).amax() + (c - a).amax()) / f64::from(steps);
        if nearest <= half_m {
            prop_assert!(triangle_touches(&corners, half_m));
        } else if nearest > half_m + step {
            prop_assert!(!triangle_touches(&corners, half_m));
        }
    }
}

#[test]
fn an_open_mesh_has_no_inside() {
    let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vector3::from).to_vec();
    let mesh = Mesh::new(triangle, vec![[0, 1, 2]]).unwrap();
    let object = object(Shape::Mesh(Arc::new(mesh)), &Pose::identity());
    let relation = |x: f64, z: f64| Cube { centre: Point3::new(x, x, z), half_m: 0.1 }.relation(&object);
    assert_eq!(relation(0.5, 0.05), Relation::Cut);
    assert_eq!(relation(0.5, 0.2), Relation::Apart);
    // Beyond the long edge: its bounds are touched, it is not.
    assert_eq!(relation(1.2, 0.0), Relation::Apart);
}
