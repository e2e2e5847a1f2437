use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;

fn ray(origin: [f64; 3], direction: [f64; 3]) -> LocalRay {
    LocalRay { origin: Vector3::from(origin), direction: Vector3::from(direction).normalize() }
}

fn shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("box", Shape::Box { half: Vector3::new(1.0, 0.5, 0.25) }),
        ("cylinder", Shape::Cylinder { radius: 0.6, half_height: 1.1 }),
        ("sphere", Shape::Sphere { radius: 0.9 }),
    ]
}

/// How far outside a shape a point is, by the definition of the shape; negative inside.
fn outside(shape: &Shape, p: &Vector3<f64>) -> f64 {
    match shape {
        Shape::Box { half } => (0..3).map(|a| p[a].abs() - half[a]).fold(f64::MIN, f64::max),
        Shape::Cylinder { radius, half_height } => (p.xy().norm() - radius).max(p.z.abs() - half_height),
        Shape::Sphere { radius } => p.norm() - radius,
        Shape::Mesh(_) => f64::NAN,
    }
}

#[test]
fn known_rays_meet_known_places() {
    let cast = |i: usize, o, d| shapes()[i].1.cast(&ray(o, d), 100.0);
    let along_x = cast(0, [-5.0, 0.1, 0.1], [1.0, 0.0, 0.0]).unwrap();
    assert_eq!(along_x, Contact { range_m: 4.0, normal: -Vector3::x() });
    let from_above = cast(1, [0.3, 0.0, 4.0], [0.0, 0.0, -1.0]).unwrap();
    assert_eq!(from_above.normal, Vector3::z());
    assert!((from_above.range_m - 2.9).abs() < 1e-12);
    let side = cast(1, [-3.0, 0.0, 0.2], [1.0, 0.0, 0.0]).unwrap();
    assert!((side.range_m - 2.4).abs() < 1e-12 && (side.normal + Vector3::x()).norm() < 1e-12);
    let ball = cast(2, [0.0, 4.0, 0.0], [0.0, -1.0, 0.0]).unwrap();
    assert!((ball.range_m - 3.1).abs() < 1e-12);
    // From inside a ray meets the way out.
    assert!((cast(0, [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]).unwrap().range_m - 0.5).abs() < 1e-12);
    assert!(cast(2, [0.0, 4.0, 0.0], [0.0, 1.0, 0.0]).is_none(), "behind the ray");
    assert!(cast(2, [0.0, 4.0, 0.95], [0.0, -1.0, 0.0]).is_none(), "beside the sphere");
}

#[test]
fn a_mesh_of_a_box_is_met_where_the_box_is() {
    let half = Vector3::new(1.0, 0.5, 0.25);
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vector3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = Mesh::new((0..8).map(corner).collect(), triangles.clone()).unwrap();
    assert!(mesh.is_closed());
    let (mesh, exact) = (Shape::Mesh(Arc::new(mesh)), Shape::Box { half });
    let open = Mesh::new((0..8).map(corner).collect(), triangles[2..].to_vec()).unwrap();
    assert!(!open.is_closed() && !open.contains(&Vector3::zeros()));
    let mut met = 0;
    for i in 0..4000 {
        let at = |k: f64| (f64::from(i) * k).fract() * 4.0 - 2.0;
        let (origin, target) = ([at(0.7548), at(0.5698), at(0.8191)], [at(0.4142), at(0.7320), at(0.2360)]);
        let direction = [0, 1, 2].map(|a| target[a] - origin[a]);
        let ray = ray(origin, direction);
        let (a, b) = (mesh.cast(&ray, 50.0), exact.cast(&ray, 50.0));
        match (a, b) {
            (Some(a), Some(b)) => {
                assert!((a.range_m - b.range_m).abs() < 1e-9 && (a.normal - b.normal).norm() < 1e-9, "{i}");
                met += 1;
            }
            (a, b) => assert!(a.is_none() && b.is_none(), "ray {i}: {a:?} {b:?}"),
        }
        assert_eq!(mesh.contains(&ray.origin), exact.contains(&ray.origin), "ray {i}");
    }
    assert!(met > 500, "{met}");
}

proptest! {
    #[test]
    fn rays_meet_the_first_change_from_outside_to_inside(
        origin in prop::array::uniform3(-3.0..3.0_f64),
        target in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        for (name, shape) in shapes() {
            let direction = [0, 1, 2].map(|a| target[a] - origin[a]);
            prop_assume!(Vector3::from(direction).norm() > 0.1);
            let ray = ray(origin, direction);
            let starts_inside = outside(&shape, &ray.origin) < 0.0;
            // Brute force: small steps along the ray until the side changes.
            let at = |t: f64| outside(&shape, &(ray.origin + ray.direction * t));
            let step = 1e-3;
            let change = (1..12_000).map(|i| f64::from(i) * step).find(|&t| (at(t) < 0.0) != starts_inside);
            match (shape.cast(&ray, 12.0), change) {
                (Some(contact), Some(t)) => {
                    prop_assert!(contact.range_m <= t + 1e-9, "{}: {} {}", name, contact.range_m, t);
                    prop_assert!(at(contact.range_m).abs() < 1e-9, "{name}: not on the surface");
                    // A corner that the steps jumped over may be cut before.
                    let is_before = at(contact.range_m + 0.5 * step) > -step;
                    prop_assert!(contact.range_m > t - 2.0 * step || is_before);
                    let slope = (at(contact.range_m + 1e-6) - at(contact.range_m - 1e-6)).signum();
                    let along = contact.normal.dot(&ray.direction);
                    prop_assert!(slope * along >= -1e-6, "{name}: {:?}", contact);
                }
                (None, Some(t)) => prop_assert!(false, "{}: missed at {}", name, t),
                (Some(contact), None) => {
                    // Only a graze shorter than a step.
                    let (before, after) = (at(contact.range_m - step), at(contact.range_m + step));
                    prop_assert!(before > -1e-3 && after > -1e-3, "{}: {:?}", name, contact);
                }
                (None, None) => {}
            }
            prop_assert_eq!(shape.contains(&ray.origin), starts_inside);
        }
    }
}
