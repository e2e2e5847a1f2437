//! The pixels that a cell is seen in (Andert 2009, section V-B, step 2c).

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use evigrid_grid::ViewRays;

/// The cube whose image is searched for the largest disparity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WindowCube {
    /// The cell itself.
    Cell,
    /// A cube of 1 m around the cell's centre, whatever the cell size: the counts of Table I can only come
    /// from that.
    Metre,
}

/// Projection of the cubes around cells into the image of one frame. Places are relative to the camera; a
/// projected place is (x z, y z, z) for image point (x, y) and depth z in metres.
#[derive(Debug, Clone)]
pub(crate) struct WindowProjection {
    /// The matrix that projects a place.
    pub matrix: Matrix3<f64>,
    /// The projected corners of a cube, relative to its projected centre: x z, y z and z of all eight.
    corners: [[f64; 8]; 3],
    /// Half the cube's extent in depth, metres.
    half_depth_m: f64,
    /// Last column and row.
    last: [f64; 2],
}

/// A rectangle of pixels, by its outermost columns and rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub left: usize,
    pub right: usize,
    pub top: usize,
    pub bottom: usize,
}

/// The numbers from one to another.
#[derive(Debug, Clone, Copy)]
struct Interval {
    low: f64,
    high: f64,
}

impl WindowProjection {
    /// The projection of one frame, for cubes with an edge of so many cells.
    pub fn new(camera: &ViewRays<'_>, edge_cells: f64) -> Self {
        let matrix = camera.projection();
        let half = |corner: usize, axis: usize| {
            if corner >> axis & 1 == 0 { -0.5 * edge_cells } else { 0.5 * edge_cells }
        };
        let corner = |n: usize| matrix * Vector3::from_fn(|a, _| half(n, a));
        let corners = std::array::from_fn(|row| std::array::from_fn(|n| corner(n)[row]));
        let last = [camera.rig.width, camera.rig.height].map(|size| (size - 1) as f64);
        let half_depth_m = (0..8).map(|n| corner(n).z).fold(0.0, f64::max);
        Self { matrix, corners, half_depth_m, last }
    }

    /// The image point of a place, if it lies in the image: within half a pixel of its outermost pixels.
    #[inline(always)]
    pub fn image_point(&self, place: &Vector3<f64>) -> Option<[f64; 2]> {
        if place.z <= 0.0 {
            return None;
        }
        let point = [place.x / place.z, place.y / place.z];
        let inside = |v: f64, last: f64| (v >= -0.5) & (v < last + 0.5);
        (inside(point[0], self.last[0]) & inside(point[1], self.last[1])).then_some(point)
    }

    /// The pixels within the rectangle around the images of the eight corners, cut to the image; the whole
    /// image if a corner lies at or behind the camera's plane. `None` if no pixel lies in it.
    #[inline(always)]
    pub fn window(&self, place: &Vector3<f64>) -> Option<Window> {
        if place.z <= self.half_depth_m {
            let [right, bottom] = self.last.map(|last| last as usize);
            return Some(Window { left: 0, right, top: 0, bottom });
        }
        let [xs, ys, zs] = &self.corners;
        let inverse: [f64; 8] = std::array::from_fn(|n| 1.0 / (place.z + zs[n]));
        let x = span(&std::array::from_fn(|n| (place.x + xs[n]) * inverse[n]));
        let y = span(&std::array::from_fn(|n| (place.y + ys[n]) * inverse[n]));
        let ((left, right), (top, bottom)) = (cut(x, self.last[0])?, cut(y, self.last[1])?);
        Some(Window { left, right, top, bottom })
    }
}

/// The interval from the smallest to the largest of eight numbers.
#[inline(always)]
fn span(values: &[f64; 8]) -> Interval {
    let (mut low, mut high) = (*values, *values);
    for half in [4, 2, 1] {
        for n in 0..half {
            low[n] = if low[n + half] < low[n] { low[n + half] } else { low[n] };
            high[n] = if high[n + half] > high[n] { high[n + half] } else { high[n] };
        }
    }
    Interval { low: low[0], high: high[0] }
}

/// The whole numbers nearest to the ends of an interval, cut to the range from 0 to `last`; `None` if it lies
/// outside.
#[inline(always)]
fn cut(interval: Interval, last: f64) -> Option<(usize, usize)> {
    // Below 0 the whole number does not matter; within the image, cutting off is rounding down.
    let (low, high) = ((interval.low + 0.5).max(0.0), interval.high + 0.5);
    (low < last + 1.0 && high >= 0.0).then_some((low as usize, high.min(last) as usize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_cut_to_the_image() {
        for (low, high, expected) in [
            (3.4, 4.6, Some((3, 5))),
            (-2.0, 0.2, Some((0, 0))),
            (-2.0, -0.6, None),
            // In the outer half of the last column.
            (20.1, 20.4, Some((20, 20))),
            (20.2, 21.7, Some((20, 20))),
            (20.6, 21.7, None),
            (-5.0, 50.0, Some((0, 20))),
            (f64::NEG_INFINITY, f64::INFINITY, Some((0, 20))),
        ] {
            assert_eq!(cut(Interval { low, high }, 20.0), expected, "{low} to {high}");
        }
    }
}
