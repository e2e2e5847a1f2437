//! From cells to the pixels that see them.

use evigrid_grid::ViewRays;
use nalgebra::{Matrix3, Vector3};

use crate::pixels::{ImageSize, Pixel, PixelBox, Span};

/// Projection of a grid's cells into the image of one frame. Places are relative to the camera; a projected
/// place is (u z, v z, z) for pixel (u, v) and depth z in metres.
pub(crate) struct CellProjection {
    /// The matrix that projects a place.
    pub matrix: Matrix3<f64>,
    /// The projected corners of a cell, relative to its projected centre.
    corners: [Vector3<f64>; 8],
    /// Eight projected places within a cell, on the way from the centre to the corners, relative to its
    /// projected centre.
    pub samples: [Vector3<f64>; 8],
    /// Half a cell's extent in depth, metres.
    pub half_depth_m: f64,
}

impl CellProjection {
    /// The projection of one frame.
    pub fn new(rays: &ViewRays<'_>) -> Self {
        let matrix = rays.projection();
        let half = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -0.5 } else { 0.5 };
        let corners = std::array::from_fn(|n| matrix * Vector3::from_fn(|a, _| half(n, a)));
        let half_depth_m = corners.iter().map(|c: &Vector3<f64>| c.z).fold(0.0, f64::max);
        Self { matrix, corners, samples: corners.map(|c| c * 0.6), half_depth_m }
    }

    /// The pixels around the image of a whole cell, given its projected centre; `None` if it lies outside the
    /// image.
    #[inline(always)]
    pub fn image_box(&self, place: Vector3<f64>, size: ImageSize) -> Option<PixelBox> {
        // The image of a cell that comes this near the camera's plane is not bounded by that of its corners.
        if place.z <= 1.001 * self.half_depth_m {
            return Some(PixelBox::whole(size));
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in &self.corners {
            let [u, v, depth]: [f64; 3] = (place + corner).into();
            for (axis, pixel) in [u / depth, v / depth].into_iter().enumerate() {
                low[axis] = if pixel < low[axis] { pixel } else { low[axis] };
                high[axis] = if pixel > high[axis] { pixel } else { high[axis] };
            }
        }
        let within = |axis: usize, size: usize| {
            let (low, high) = (low[axis].max(0.0), high[axis].min((size - 1) as f64));
            (low <= high).then_some(Span { first: low as usize, last: high as usize })
        };
        Some(PixelBox { columns: within(0, size.width)?, rows: within(1, size.height)? })
    }
}

/// The pixel that sees a projected place, if any ray gets there.
#[inline(always)]
pub(crate) fn pixel_at(rays: &ViewRays<'_>, size: ImageSize, place: Vector3<f64>) -> Option<Pixel> {
    let depth = place.z;
    if depth <= 0.0 || depth >= rays.max_depth_m {
        return None;
    }
    let (x, y) = (place.x / depth + 0.5, place.y / depth + 0.5);
    let inside = !(x < 0.0 || y < 0.0 || x >= size.width as f64 || y >= size.height as f64);
    inside.then_some(Pixel { x: x as usize, y: y as usize })
}

/// Whether a pixel's ray, in a certain depth, lies within the cell around a centre (relative to the camera,
/// in cells).
#[inline(always)]
pub(crate) fn crosses(rays: &ViewRays<'_>, centre: [f64; 3], depth_m: f64, pixel: Pixel) -> bool {
    let direction = rays.direction(pixel.x as f64, pixel.y as f64);
    (0..3).all(|a| (depth_m * direction[a] - centre[a]).abs() < 0.5)
}
