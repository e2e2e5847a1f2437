//! How a cube lies to a shape: decided in double precision, without samples.

use nalgebra::{Matrix3, Point3, Vector3};

use super::cylinder::cylinder_touches;
use crate::mesh::Mesh;
use crate::scene::Object;
use crate::shape::Shape;

/// A cube with its faces across the axes of the map frame, its surface included.
#[derive(Debug, Clone, Copy)]
pub struct Cube {
    /// Its centre, metres.
    pub centre: Point3<f64>,
    /// Half its edge, metres.
    pub half_m: f64,
}

/// How a cube lies to a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// They have no point in common.
    Apart,
    /// They have points in common, and the cube has points that are not inside the shape.
    Cut,
    /// The cube is wholly inside the shape.
    Inside,
}

/// Cross products of edges shorter than this (squared, of unit vectors) have no direction; the edges are
/// parallel, and the faces' own normals decide.
const PARALLEL: f64 = 1e-18;

impl Cube {
    /// Lowest and highest coordinates, metres.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let half = Vector3::repeat(self.half_m);
        [self.centre.coords - half, self.centre.coords + half]
    }

    /// How the cube lies to the shape of an object. An open mesh has no inside.
    pub fn relation(&self, object: &Object) -> Relation {
        match &object.shape {
            Shape::Box { half } => self.to_box(half, object),
            Shape::Sphere { radius } => self.to_sphere(*radius, &object.centre),
            Shape::Cylinder { radius, half_height } => {
                let corners = self.corners().map(|corner| object.local_point(&corner));
                if corners.iter().all(|corner| object.shape.contains(corner)) {
                    return Relation::Inside;
                }
                if cylinder_touches(*radius, *half_height, &corners) {
                    Relation::Cut
                } else {
                    Relation::Apart
                }
            }
            Shape::Mesh(mesh) => self.to_mesh(mesh, object),
        }
    }

    /// The corners; number i is on the upper side along axis a if bit a of i is set.
    fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|i| {
            let sign = |axis: usize| if i >> axis & 1 == 1 { self.half_m } else { -self.half_m };
            self.centre + Vector3::new(sign(0), sign(1), sign(2))
        })
    }

    fn to_sphere(self, radius: f64, centre: &Point3<f64>) -> Relation {
        let away = (self.centre - centre).abs();
        let half = Vector3::repeat(self.half_m);
        let (nearest, farthest) = ((away - half).sup(&Vector3::zeros()), away + half);
        if farthest.norm_squared() < radius * radius {
            Relation::Inside
        } else if nearest.norm_squared() <= radius * radius {
            Relation::Cut
        } else {
            Relation::Apart
        }
    }

    /// Separating axes of two boxes (Gottschalk, Lin and Manocha 1996).
    fn to_box(self, half: &Vector3<f64>, object: &Object) -> Relation {
        // The columns are the cube's axes in the frame of the box.
        let axes: &Matrix3<f64> = &object.local_from_world;
        let centre = object.local_point(&self.centre);
        let reach = axes.abs() * Vector3::repeat(self.half_m);
        if (0..3).all(|a| centre[a].abs() + reach[a] < half[a]) {
            return Relation::Inside;
        }
        if (0..3).any(|a| centre[a].abs() - reach[a] > half[a]) {
            return Relation::Apart;
        }
        let separates = |axis: &Vector3<f64>| {
            let reach = half.dot(&axis.abs()) + self.half_m * axes.tr_mul(axis).abs().sum();
            centre.dot(axis).abs() > reach
        };
        for cube_axis in axes.column_iter() {
            if separates(&cube_axis.into_owned()) {
                return Relation::Apart;
            }
            for own in 0..3 {
                let axis = cube_axis.cross(&unit(own));
                if axis.norm_squared() > PARALLEL && separates(&axis) {
                    return Relation::Apart;
                }
            }
        }
        Relation::Cut
    }

    fn to_mesh(self, mesh: &Mesh, object: &Object) -> Relation {
        let centre = object.local_point(&self.centre);
        let reach = object.local_from_world.abs() * Vector3::repeat(self.half_m);
        let on_surface = mesh.near(&(centre - reach), &(centre + reach)).any(|index| {
            let corners = mesh.triangle(index).map(|v| object.centre + object.in_world(&v) - self.centre);
            triangle_touches(&corners, self.half_m)
        });
        if on_surface {
            Relation::Cut
        } else if mesh.contains(&centre) {
            Relation::Inside
        } else {
            Relation::Apart
        }
    }
}

/// Whether a triangle touches the cube about the origin (Akenine-Moeller 2001).
fn triangle_touches(corners: &[Vector3<f64>; 3], half_m: f64) -> bool {
    let separates = |axis: &Vector3<f64>| {
        let at = corners.map(|corner| corner.dot(axis));
        let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
        let reach = half_m * axis.abs().sum();
        low > reach || high < -reach
    };
    if (0..3).any(|a| separates(&unit(a))) {
        return false;
    }
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c];
    if separates(&edges[0].cross(&edges[1]).normalize()) {
        return false;
    }
    !edges.iter().map(|edge| edge.normalize()).any(|edge| {
        (0..3).map(|a| edge.cross(&unit(a))).any(|axis| axis.norm_squared() > PARALLEL && separates(&axis))
    })
}

fn unit(axis: usize) -> Vector3<f64> {
    Vector3::from_fn(|row, _| if row == axis { 1.0 } else { 0.0 })
}

#[cfg(test)]
#[path = "touch_tests.rs"]
mod tests;
