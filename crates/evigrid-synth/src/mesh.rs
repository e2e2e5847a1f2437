//! Triangle meshes with a tree of their own.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::ray::{Contact, LocalRay};
use crate::tree::Tree;

/// Triangles in the local frame of a shape.
#[derive(Clone)]
pub struct Mesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    tree: Tree,
    bounds: [Vector3<f64>; 2],
    /// Every edge has exactly one triangle on either side, both turned alike: the mesh has an inside.
    is_closed: bool,
}

impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mesh").field("triangles", &self.triangles.len()).finish_non_exhaustive()
    }
}

impl Mesh {
    /// A mesh of vertices (metres) and triangles, each three vertex numbers from 0,
    /// anticlockwise seen from outside.
    ///
    /// # Errors
    /// If there are no triangles, or one names a vertex that does not exist or has
    /// no area; the message says which.
    pub fn new(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, String> {
        if triangles.is_empty() {
            return Err("expected at least one triangle, found none".to_owned());
        }
        for (i, corners) in triangles.iter().enumerate() {
            if let Some(missing) = corners.iter().find(|&&c| c as usize >= vertices.len()) {
                let count = vertices.len();
                return Err(format!("triangle {i}: expected vertex numbers below {count}, found {missing}"));
            }
            let [a, b, c] = corners.map(|c| vertices[c as usize]);
            if (b - a).cross(&(c - a)).norm_squared() == 0.0 {
                return Err(format!("triangle {i}: expected an area above zero"));
            }
        }
        let corners = |t: &[u32; 3]| t.map(|c| vertices[c as usize]);
        let tree = Tree::new(triangles.iter().map(|t| {
            let [a, b, c] = corners(t);
            [a.inf(&b).inf(&c), a.sup(&b).sup(&c)]
        }));
        let used = || triangles.iter().flat_map(corners);
        let bounds = [
            used().fold(Vector3::repeat(f64::INFINITY), |m, v| m.inf(&v)),
            used().fold(Vector3::repeat(f64::NEG_INFINITY), |m, v| m.sup(&v)),
        ];
        let is_closed = is_closed(&triangles);
        Ok(Self { vertices, triangles, tree, bounds, is_closed })
    }

    /// Lowest and highest coordinates, metres.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        self.bounds
    }

    /// Whether the mesh has an inside.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The corners of a triangle, metres.
    pub fn triangle(&self, index: u32) -> [Vector3<f64>; 3] {
        self.triangles[index as usize].map(|c| self.vertices[c as usize])
    }

    /// The triangles whose bounds touch the box from `low` to `high`, in no particular order.
    pub fn near(&self, low: &Vector3<f64>, high: &Vector3<f64>) -> impl Iterator<Item = u32> {
        self.tree.near(low, high)
    }

    /// How many triangles there are.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Where the ray first meets a triangle, from either side, nearer than `max_m`. The normal is the
    /// triangle's own for a closed mesh; an open one turns it against the ray.
    pub fn cast(&self, ray: &LocalRay, max_m: f64) -> Option<Contact> {
        let meet = |index: u32, _| cast_triangle(&self.triangle(index), ray);
        let (index, range_m) = self.tree.first(ray, max_m, None, meet)?;
        let [a, b, c] = self.triangle(index);
        let normal = (b - a).cross(&(c - a)).normalize();
        let turned = !self.is_closed && normal.dot(&ray.direction) > 0.0;
        Some(Contact { range_m, normal: if turned { -normal } else { normal } })
    }

    /// Whether a closed mesh contains the point: a ray from it leaves the mesh before it enters it.
    pub fn contains(&self, p: &Vector3<f64>) -> bool {
        let within = (0..3).all(|a| self.bounds[0][a] < p[a] && p[a] < self.bounds[1][a]);
        if !within || !self.is_closed {
            return false;
        }
        // A direction that no edge of a reasonable mesh is parallel to.
        let direction = Vector3::new(0.301_511, 0.904_534, -0.301_677).normalize();
        let ray = LocalRay { origin: *p, direction };
        self.cast(&ray, f64::INFINITY).is_some_and(|contact| contact.normal.dot(&direction) > 0.0)
    }
}

/// Whether every edge occurs once in either direction.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let sorted = |turn: fn(u32, u32) -> (u32, u32)| {
        let edges = triangles.par_iter().flat_map_iter(|&[a, b, c]| [turn(a, b), turn(b, c), turn(c, a)]);
        let mut edges: Vec<(u32, u32)> = edges.collect();
        edges.par_sort_unstable();
        edges
    };
    let forward = sorted(|a, b| (a, b));
    forward.windows(2).all(|pair| pair[0] != pair[1]) && forward == sorted(|a, b| (b, a))
}

/// Distance to a triangle, from either side (Moeller and Trumbore 1997).
fn cast_triangle(&[a, b, c]: &[Vector3<f64>; 3], ray: &LocalRay) -> Option<f64> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(&e2);
    let determinant = e1.dot(&p);
    if determinant == 0.0 {
        return None;
    }
    let inverse = 1.0 / determinant;
    let to_origin = ray.origin - a;
    let u = to_origin.dot(&p) * inverse;
    let q = to_origin.cross(&e1);
    let v = ray.direction.dot(&q) * inverse;
    // A little over the border, so that no ray slips between two neighbours.
    const OVERLAP: f64 = 1e-12;
    let range_m = e2.dot(&q) * inverse;
    (u >= -OVERLAP && v >= -OVERLAP && u + v <= 1.0 + OVERLAP && range_m > 0.0).then_some(range_m)
}
