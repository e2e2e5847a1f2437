//! Whether several solids together fill a cube.

use nalgebra::{Matrix3, Point3, Vector3};

use super::touch::Cube;
use crate::scene::Object;
use crate::shape::Shape;

/// Parts of a cube's edge in whose middles air is looked for.
const PARTS: usize = 10;
/// How far from the corners of a pocket air is looked for, metres: narrower cracks are no openings.
const POCKET_M: f64 = 2e-4;
/// How far from a point on an interface both solids are looked for, metres.
const NUDGE_M: f64 = 1e-7;

/// Whether some point of the cube is in none of these objects, each of which touches and none of which
/// contains it; open meshes do not count.
///
/// Air is looked for at the corners of the cube; then, since every pocket between plane faces has a corner
/// where three planes meet, a little beside all points where planes of the cube, of boxes and of caps meet in
/// threes; at last, for the sake of curved faces and meshes, at 12 x 12 x 12 points: the middles of tenths of
/// the edge, and the faces.
pub fn has_air(cube: &Cube, objects: &[&Object]) -> bool {
    let solids: Vec<&Object> = objects.iter().copied().filter(|object| !is_open(&object.shape)).collect();
    let middles = (0..PARTS).map(|part| (2 * part + 1) as f64 / PARTS as f64 - 1.0);
    // The faces first: there is the air above ground and beside walls.
    let places: Vec<f64> = [1.0, -1.0].into_iter().chain(middles).map(|v| v * cube.half_m).collect();
    let point = |x: f64, y: f64, z: f64| cube.centre + Vector3::new(x, y, z);
    let at = |places: &[f64]| {
        places
            .iter()
            .any(|&z| places.iter().any(|&y| places.iter().any(|&x| is_air(&point(x, y, z), &solids))))
    };
    solids.len() < 2 || at(&places[..2]) || has_pocket(cube, &solids) || at(&places)
}

/// Whether a shape is a surface without an inside.
pub fn is_open(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(mesh) if !mesh.is_closed())
}

/// Whether a point is in none of the solids. On the interface of two it is in neither,
/// but its surroundings are not air.
fn is_air(point: &Point3<f64>, solids: &[&Object]) -> bool {
    // A direction along which no face of a reasonable world lies.
    let nudge = Vector3::new(0.543_21, 0.612_34, 0.574_45) * NUDGE_M;
    [*point, point + nudge, point - nudge].iter().all(|p| !solids.iter().any(|solid| solid.contains(p)))
}

/// All points q, from the cube's centre, with normal . q = offset.
struct Plane {
    normal: Vector3<f64>,
    offset: f64,
}

fn has_pocket(cube: &Cube, solids: &[&Object]) -> bool {
    let planes = planes(cube, solids);
    let count = planes.len();
    let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
    let mut triples = pairs.flat_map(|(i, j)| (0..j).map(move |k| [i, j, k]));
    triples.any(|triple| has_air_beside(cube, solids, triple.map(|index| &planes[index])))
}

/// The planes of the cube's own faces, and of all plane faces of solids that cut it.
fn planes(cube: &Cube, solids: &[&Object]) -> Vec<Plane> {
    let unit = |a: usize| Vector3::from_fn(|row, _| if row == a { 1.0 } else { 0.0 });
    let own = (0..6).map(|side| Plane {
        normal: unit(side / 2),
        offset: if side % 2 == 0 { cube.half_m } else { -cube.half_m },
    });
    let of_solid = |solid: &&Object| {
        let (axes, half) = match solid.shape {
            Shape::Box { half } => (0..3, half),
            Shape::Cylinder { half_height, .. } => (2..3, Vector3::repeat(half_height)),
            Shape::Sphere { .. } | Shape::Mesh(_) => (0..0, Vector3::zeros()),
        };
        let centre = solid.local_point(&cube.centre);
        let rows = solid.local_from_world;
        let face = move |a: usize, sign: f64| Plane {
            normal: rows.row(a).transpose(),
            offset: sign * half[a] - centre[a],
        };
        axes.flat_map(move |a| [face(a, 1.0), face(a, -1.0)])
    };
    let cuts = |plane: &Plane| plane.offset.abs() <= cube.half_m * plane.normal.abs().sum();
    own.chain(solids.iter().flat_map(of_solid).filter(cuts)).collect()
}

/// Whether there is air in the cube next to the point where three planes meet, in
/// one of the eight corners there.
fn has_air_beside(cube: &Cube, solids: &[&Object], planes: [&Plane; 3]) -> bool {
    let normals = Matrix3::from_rows(&planes.map(|plane| plane.normal.transpose()));
    if normals.determinant().abs() < 1e-6 {
        return false;
    }
    let Some(inverse) = normals.try_inverse() else { return false };
    let is_in_cube = |p: &Vector3<f64>| p.amax() <= cube.half_m * (1.0 + 1e-9);
    let corner = inverse * Vector3::from(planes.map(|plane| plane.offset));
    is_in_cube(&corner)
        && (0..8).any(|signs| {
            let sign = |bit: usize| if signs >> bit & 1 == 1 { 1.0 } else { -1.0 };
            // Not in the very middle of the corner, where a further plane may pass.
            let direction = inverse * Vector3::new(sign(0), 0.83 * sign(1), 1.21 * sign(2));
            let beside = corner + direction.normalize() * POCKET_M;
            let point = cube.centre + beside;
            is_in_cube(&beside) && !solids.iter().any(|solid| solid.contains(&point))
        })
}

#[cfg(test)]
#[path = "air_tests.rs"]
mod tests;
