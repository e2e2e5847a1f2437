//! The free space of one frame, cell by cell instead of ray by ray.

use evigrid_grid::{FrameEvidence, ViewRays};
use multiversion::multiversion;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::reach::ReachImage;
use crate::silhouette::Silhouette;

/// Offers `free_key` to every cell that some ray crosses within the pixel's reach.
///
/// A cell of free space is crossed by hundreds of rays, and one of them decides: mostly that of the pixel in the
/// middle of the cell, else nearly always one of eight around it. Cells that have evidence already are left out: no evidence is less than that of a free cell.
pub(crate) fn draw_free_space(
    rays: &ViewRays<'_>,
    reach: &ReachImage,
    free_key: i32,
    evidence: &FrameEvidence,
) {
    let projection = Projection::new(rays);
    let [layers, ..] = rays.box_in_grid();
    layers.into_par_iter().for_each(|i| draw_layer(rays, &projection, reach, i, free_key, evidence));
}

/// The same for the cells with one index along x. Comparing takes fewer instructions from AVX on; no result depends on
/// it.
#[multiversion(targets("x86_64+avx2"))]
fn draw_layer(
    rays: &ViewRays<'_>,
    projection: &Projection,
    reach: &ReachImage,
    i: usize,
    free_key: i32,
    evidence: &FrameEvidence,
) {
    let [_, columns, levels] = rays.box_in_grid();
    let [layer_stride, column_stride, _] = rays.spec.strides();
    for j in columns {
        for k in levels.clone() {
            let flat = i * layer_stride + j * column_stride + k;
            if evidence.is_empty(flat) && is_free(rays, projection, reach, [i, j, k]) {
                evidence.offer(flat, free_key);
            }
        }
    }
}

/// Whether some ray crosses the cell within the pixel's reach.
#[inline(always)]
fn is_free(rays: &ViewRays<'_>, projection: &Projection, reach: &ReachImage, cell: [usize; 3]) -> bool {
    let centre: [f64; 3] = std::array::from_fn(|a| cell[a] as f64 + 0.5 - rays.origin[a]);
    let place = projection.matrix * Vector3::from(centre);
    if place.z <= -projection.half_depth_m || place.z - projection.half_depth_m >= rays.max_depth_m {
        return false;
    }
    let steps = rays.steps_to(&cell.map(|index| index as i64));
    if pixel_reaches(rays, reach, centre, place, steps) {
        return true;
    }
    let Some([columns, rows]) = projection.image_box(place, reach.size()) else { return false };
    if reach.row_bands(columns, rows, steps).next().is_none() {
        return false;
    }
    if projection.samples.iter().any(|s| pixel_reaches(rays, reach, centre, place + s, steps)) {
        return true;
    }
    let rays_end = place.z + projection.half_depth_m >= rays.max_depth_m;
    let silhouette = Silhouette::of_cell(rays, cell, rays_end);
    !silhouette.misses_image(reach.size()) && any_pixel_reaches(reach, &silhouette, columns, rows, steps)
}

/// Whether the pixel that sees a place within the cell reaches it. Its ray is only looked at in that depth, so `false`
/// decides nothing.
#[inline(always)]
fn pixel_reaches(
    rays: &ViewRays<'_>,
    reach: &ReachImage,
    centre: [f64; 3],
    place: Vector3<f64>,
    steps: i32,
) -> bool {
    pixel_at(rays, reach.size(), place)
        .is_some_and(|(x, y)| reach.at(x, y) >= steps && crosses(rays, centre, place.z, (x, y)))
}

/// The pixel that sees a place, if any ray gets there.
#[inline(always)]
pub(crate) fn pixel_at(
    rays: &ViewRays<'_>,
    (width, height): (usize, usize),
    place: Vector3<f64>,
) -> Option<(usize, usize)> {
    let depth = place.z;
    if depth <= 0.0 || depth >= rays.max_depth_m {
        return None;
    }
    let (x, y) = (place.x / depth + 0.5, place.y / depth + 0.5);
    let inside = !(x < 0.0 || y < 0.0 || x >= width as f64 || y >= height as f64);
    inside.then_some((x as usize, y as usize))
}

/// Whether a pixel's ray lies within the cell around a centre (relative to the camera) in a certain depth.
#[inline(always)]
pub(crate) fn crosses(rays: &ViewRays<'_>, centre: [f64; 3], depth: f64, (x, y): (usize, usize)) -> bool {
    let direction = rays.direction(x as f64, y as f64);
    (0..3).all(|a| (depth * direction[a] - centre[a]).abs() < 0.5)
}

/// The same for every pixel of the silhouette, all of which lie within these columns and rows (first and last).
#[inline(always)]
fn any_pixel_reaches(
    reach: &ReachImage,
    silhouette: &Silhouette,
    columns: [usize; 2],
    [top, bottom]: [usize; 2],
    steps: i32,
) -> bool {
    // From the middle on: that is where a silhouette is widest.
    let middle = top.midpoint(bottom);
    for part in [[middle, bottom], [top, middle]] {
        for y in reach.row_bands(columns, part, steps).flatten() {
            let seen = silhouette.columns(y, reach.size().0);
            if seen.is_some_and(|columns| reach.any_in_row(y, columns, steps)) {
                return true;
            }
        }
    }
    false
}

/// From places relative to the camera to the image.
pub(crate) struct Projection {
    /// (u z, v z, z) of a place: pixel (u, v), depth z.
    pub matrix: Matrix3<f64>,
    /// The same of a cell's corners, relative to its centre.
    corners: [Vector3<f64>; 8],
    /// The same of eight places within it, on the way from the centre to the corners.
    pub samples: [Vector3<f64>; 8],
    /// Half a cell's extent in depth, metres.
    pub half_depth_m: f64,
}

impl Projection {
    pub fn new(rays: &ViewRays<'_>) -> Self {
        let matrix = rays.projection();
        let half = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -0.5 } else { 0.5 };
        let corners = std::array::from_fn(|n| matrix * Vector3::from_fn(|a, _| half(n, a)));
        let half_depth_m = corners.iter().map(|c: &Vector3<f64>| c.z).fold(0.0, f64::max);
        Self { matrix, corners, samples: corners.map(|c| c * 0.6), half_depth_m }
    }

    /// The columns and rows of the image, first and last, that hold the whole cell around a projected place; `None`
    /// if it lies outside the image.
    #[inline(always)]
    pub fn image_box(&self, place: Vector3<f64>, (width, height): (usize, usize)) -> Option<[[usize; 2]; 2]> {
        // The image of a cell that comes this near the camera's plane is not bounded by that of its corners.
        if place.z <= 1.001 * self.half_depth_m {
            return Some([[0, width - 1], [0, height - 1]]);
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
            (low <= high).then_some([low as usize, high as usize])
        };
        Some([within(0, width)?, within(1, height)?])
    }
}
