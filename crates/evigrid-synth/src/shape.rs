//! Solid shapes: where a ray meets them, what is inside them, and the coordinates of their surfaces.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::mesh::Mesh;
use crate::ray::{Contact, LocalRay};

/// A solid about the origin of its local frame. An open mesh is the one exception: it has no inside.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A box with its faces across the local axes; half its lengths, metres.
    Box { half: Vector3<f64> },
    /// A cylinder about the local z axis, metres.
    Cylinder { radius: f64, half_height: f64 },
    /// A sphere, metres.
    Sphere { radius: f64 },
    /// Triangles.
    Mesh(Arc<Mesh>),
}

/// The coordinates that a texture has at a surface point.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePoint {
    /// Which side of the shape it is; every side has a texture of its own.
    pub side: u32,
    /// Coordinates (u, v) on that side, metres: u level and v up on upright sides, (x, y) on level ones.
    pub uv: [f64; 2],
    /// Directions in which u and v grow.
    pub tangents: [Vector3<f64>; 2],
}

impl Shape {
    /// Lowest and highest coordinates in the local frame, metres.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let half = match self {
            Self::Box { half } => *half,
            Self::Cylinder { radius, half_height } => Vector3::new(*radius, *radius, *half_height),
            Self::Sphere { radius } => Vector3::repeat(*radius),
            Self::Mesh(mesh) => return mesh.bounds(),
        };
        [-half, half]
    }

    /// Where the ray first meets the surface nearer than `max_m`.
    pub fn cast(&self, ray: &LocalRay, max_m: f64) -> Option<Contact> {
        let contact = match self {
            Self::Box { half } => cast_box(half, ray),
            Self::Cylinder { radius, half_height } => cast_cylinder(*radius, *half_height, ray),
            Self::Sphere { radius } => cast_sphere(*radius, ray),
            Self::Mesh(mesh) => return mesh.cast(ray, max_m),
        };
        contact.filter(|c| c.range_m < max_m)
    }

    /// Whether the point is inside.
    pub fn contains(&self, p: &Vector3<f64>) -> bool {
        match self {
            Self::Box { half } => (0..3).all(|a| p[a].abs() < half[a]),
            Self::Cylinder { radius, half_height } => {
                p.z.abs() < *half_height && p.x * p.x + p.y * p.y < radius * radius
            }
            Self::Sphere { radius } => p.norm_squared() < radius * radius,
            Self::Mesh(mesh) => mesh.contains(p),
        }
    }

    /// The texture coordinates of the point `p` of the surface with this outward normal.
    pub fn surface_point(&self, p: &Vector3<f64>, normal: &Vector3<f64>) -> SurfacePoint {
        let (axis, is_positive) = dominant_axis(normal);
        match self {
            Self::Cylinder { radius, .. } if axis != 2 => {
                let along = Vector3::new(-p.y, p.x, 0.0) / *radius;
                SurfacePoint {
                    side: 0,
                    uv: [radius * libm::atan2(p.y, p.x), p.z],
                    tangents: [along, Vector3::z()],
                }
            }
            _ => {
                let [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
                let unit = |a: usize| Vector3::from_fn(|row, _| if row == a { 1.0 } else { 0.0 });
                SurfacePoint {
                    side: 2 * axis as u32 + u32::from(is_positive),
                    uv: [p[u], p[v]],
                    tangents: [unit(u), unit(v)],
                }
            }
        }
    }
}

/// The axis along which a normal is longest, and whether it points in the positive direction.
fn dominant_axis(normal: &Vector3<f64>) -> (usize, bool) {
    let axis = normal.iamax();
    (axis, normal[axis] > 0.0)
}

/// The slab method (Kay and Kajiya 1986).
fn cast_box(half: &Vector3<f64>, ray: &LocalRay) -> Option<Contact> {
    let (mut enter, mut enter_axis) = (f64::NEG_INFINITY, 0);
    let (mut leave, mut leave_axis) = (f64::INFINITY, 0);
    for a in 0..3 {
        let inverse = 1.0 / ray.direction[a];
        let reach = half[a].copysign(inverse);
        let (near, far) = ((-reach - ray.origin[a]) * inverse, (reach - ray.origin[a]) * inverse);
        // A ray within a face plane gives NaN, which fails both comparisons.
        if near > enter {
            (enter, enter_axis) = (near, a);
        }
        if far < leave {
            (leave, leave_axis) = (far, a);
        }
    }
    if enter > leave || leave <= 0.0 {
        return None;
    }
    let (range_m, axis, sign) = if enter > 0.0 {
        (enter, enter_axis, -ray.direction[enter_axis].signum())
    } else {
        (leave, leave_axis, ray.direction[leave_axis].signum())
    };
    let normal = Vector3::from_fn(|row, _| if row == axis { sign } else { 0.0 });
    Some(Contact { range_m, normal })
}

/// Both ends of the chord that a ray cuts from a sphere or an endless cylinder: a t^2 + 2 b t + c = 0.
fn chord(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || a == 0.0 {
        return None;
    }
    // The root without cancellation first, the other from the product of both, c / a.
    let q = -(b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    Some([first.min(second), first.max(second)])
}

fn cast_sphere(radius: f64, ray: &LocalRay) -> Option<Contact> {
    let ends = chord(1.0, ray.origin.dot(&ray.direction), ray.origin.norm_squared() - radius * radius)?;
    let range_m = ends.into_iter().find(|&t| t > 0.0)?;
    Some(Contact { range_m, normal: (ray.origin + ray.direction * range_m) / radius })
}

fn cast_cylinder(radius: f64, half_height: f64, ray: &LocalRay) -> Option<Contact> {
    let (o, d) = (&ray.origin, &ray.direction);
    let a = d.x * d.x + d.y * d.y;
    let c = o.x * o.x + o.y * o.y - radius * radius;
    let [enter, leave] = match chord(a, o.x * d.x + o.y * d.y, c) {
        Some(ends) => ends,
        None if a == 0.0 && c < 0.0 => [f64::NEG_INFINITY, f64::INFINITY],
        None => return None,
    };
    let inverse = 1.0 / d.z;
    let reach = half_height.copysign(inverse);
    let (bottom, top) = ((-reach - o.z) * inverse, (reach - o.z) * inverse);
    // A level ray in the plane of a cap gives NaN; it grazes.
    if bottom.is_nan() || top.is_nan() {
        return None;
    }
    let (first, last) = (enter.max(bottom), leave.min(top));
    if first > last || last <= 0.0 {
        return None;
    }
    let side = |t: f64| Vector3::new(o.x + t * d.x, o.y + t * d.y, 0.0) / radius;
    let cap = |sign: f64| Vector3::new(0.0, 0.0, sign);
    Some(if first > 0.0 {
        let normal = if enter >= bottom { side(first) } else { cap(-d.z.signum()) };
        Contact { range_m: first, normal }
    } else {
        let normal = if leave <= top { side(last) } else { cap(d.z.signum()) };
        Contact { range_m: last, normal }
    })
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
