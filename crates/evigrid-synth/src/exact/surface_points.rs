//! Points on the surfaces of a world, for the tests of its voxels.

use nalgebra::{Point3, Vector3};

use super::air::is_open;
use crate::scene::Object;
use crate::shape::Shape;

/// Points of a shape's surface with their normals in its frame, no two
/// neighbours farther apart than `spacing`.
fn surface(shape: &Shape, spacing: f64) -> Vec<[Vector3<f64>; 2]> {
    let steps = |length: f64| steps(length, spacing);
    let lattice = |origin: Vector3<f64>, u: Vector3<f64>, v: Vector3<f64>, triangle: bool| {
        let (nu, nv) = (steps(u.norm()), steps(v.norm()));
        let normal = u.cross(&v).normalize();
        let share = |i: usize, n: usize| i as f64 / n as f64;
        let all = (0..=nu).flat_map(move |i| (0..=nv).map(move |j| (share(i, nu), share(j, nv))));
        let kept = all.filter(move |(a, b)| !triangle || a + b <= 1.0 + 1e-9);
        kept.map(move |(a, b)| [origin + u * a + v * b, normal]).collect::<Vec<_>>()
    };
    match shape {
        Shape::Box { half } => (0..6)
            .flat_map(|side| {
                let (axis, sign) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
                let unit =
                    |a: usize| Vector3::from_fn(|row, _| if row == a % 3 { 2.0 * half[row] } else { 0.0 });
                let (u, v) = (unit(axis + 1), unit(axis + 2) * sign);
                lattice(unit(axis) * (0.5 * sign) - (u + v) * 0.5, u, v, false)
            })
            .collect(),
        Shape::Mesh(mesh) => mesh
            .near(&mesh.bounds()[0], &mesh.bounds()[1])
            .flat_map(|index| {
                let [a, b, c] = mesh.triangle(index);
                lattice(a, b - a, c - a, true)
            })
            .collect(),
        Shape::Sphere { radius } => {
            let rings = steps(std::f64::consts::PI * radius);
            let ring = |i: usize| {
                let (sin, z) = (std::f64::consts::PI * i as f64 / rings as f64).sin_cos();
                around(sin * radius, spacing).into_iter().map(move |p| Vector3::new(p[0], p[1], z * radius))
            };
            (0..=rings).flat_map(ring).map(|p| [p, p / *radius]).collect()
        }
        Shape::Cylinder { radius, half_height } => cylinder(*radius, *half_height, spacing),
    }
}

/// Points of a cylinder's side and caps with their normals.
fn cylinder(radius: f64, half_height: f64, spacing: f64) -> Vec<[Vector3<f64>; 2]> {
    let heights = steps(2.0 * half_height, spacing);
    let z = |i: usize| (2.0 * i as f64 / heights as f64 - 1.0) * half_height;
    let side = (0..=heights).flat_map(|i| {
        around(radius, spacing)
            .into_iter()
            .map(move |[x, y]| [Vector3::new(x, y, z(i)), Vector3::new(x, y, 0.0).normalize()])
    });
    let rings = steps(radius, spacing);
    let caps = (0..=rings).flat_map(|ring| {
        let points = around(radius * ring as f64 / rings as f64, spacing);
        let on =
            move |sign: f64, [x, y]: [f64; 2]| [Vector3::new(x, y, sign * half_height), Vector3::z() * sign];
        points.into_iter().flat_map(move |p| [on(1.0, p), on(-1.0, p)])
    });
    side.chain(caps).collect()
}

/// Parts of a length that are no longer than `spacing`.
fn steps(length: f64, spacing: f64) -> usize {
    (length / spacing).ceil().max(1.0) as usize
}

fn around(radius: f64, spacing: f64) -> Vec<[f64; 2]> {
    let count = (std::f64::consts::TAU * radius / spacing).ceil().max(1.0) as usize;
    let turn = |i: usize| (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
    (0..count).map(|i| [turn(i).0 * radius, turn(i).1 * radius]).collect()
}

/// Points on the boundary of the union of all solids, and on open meshes outside of them.
pub fn visible(objects: &[Object], spacing: f64) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for object in objects {
        for [point, normal] in surface(&object.shape, spacing) {
            let before = |sign: f64| object.centre + object.in_world(&(point + normal * (sign * 1e-7)));
            // Beside it too, since a point between two solids that abut is in neither.
            let beside = Vector3::new(0.4, 0.5, 0.3) * 1e-8;
            let is_free = |p: Point3<f64>| {
                [p - beside, p + beside].iter().all(|p| !objects.iter().any(|other| other.contains(p)))
            };
            if is_free(before(1.0)) || (is_open(&object.shape) && is_free(before(-1.0))) {
                points.push(object.centre + object.in_world(&point));
            }
        }
    }
    points
}
