//! Whether a cube touches a cylinder.

use nalgebra::{Vector2, Vector3};

/// Whether a cube with these corners touches the cylinder about the z axis between the heights -`half_height`
/// and `half_height`. Corners that differ in one bit of their number are joined by an edge.
///
/// Of the cube only the part between the planes of the caps counts. Seen along the axis that part is a convex
/// polygon, and the question is whether it comes as near to the origin as the radius.
pub fn cylinder_touches(radius: f64, half_height: f64, corners: &[Vector3<f64>; 8]) -> bool {
    let inside = corners.iter().filter(|c| c.z.abs() <= half_height).map(Vector3::xy);
    let mut seen: Vec<Vector2<f64>> = inside.collect();
    for (i, a) in corners.iter().enumerate() {
        for b in (0..3).map(|bit| i | 1 << bit).filter(|&other| other != i).map(|other| &corners[other]) {
            for cap in [-half_height, half_height] {
                if (a.z < cap) != (b.z < cap) {
                    seen.push((a + (b - a) * ((cap - a.z) / (b.z - a.z))).xy());
                }
            }
        }
    }
    let near = radius * radius;
    seen.iter().any(|p| p.norm_squared() <= near)
        || surrounds_origin(&seen)
        || seen.iter().enumerate().any(|(i, a)| seen[..i].iter().any(|b| to_segment(a, b) <= near))
}

/// Whether the origin is inside the convex hull of the points: no line through it and one of them has all
/// others on one side. On the border either answer may come.
fn surrounds_origin(points: &[Vector2<f64>]) -> bool {
    !points.is_empty() && !points.iter().any(|a| points.iter().all(|b| a.perp(b) >= 0.0))
}

/// Squared distance of the origin to the segment from `a` to `b`.
fn to_segment(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let along = b - a;
    let length = along.norm_squared();
    let share = if length > 0.0 { (-a.dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * share).norm_squared()
}
