//! The cells that some ray of a frame leaves free.

use evigrid_grid::{FrameEvidence, ViewRays};
use multiversion::multiversion;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::projection::{CellProjection, crosses, pixel_at};
use super::reach::ReachImage;
use super::silhouette::Silhouette;
use crate::pixels::PixelBox;

/// Offers `free_key` to every cell that some ray crosses within the pixel's reach.
///
/// A cell of free space is crossed by hundreds of rays, and one of them decides: mostly that of the pixel in
/// the middle of the cell, else nearly always one of eight around it. Cells that have evidence already are
/// left out: no evidence is less than that of a free cell.
pub(crate) fn draw_free_space(
    rays: &ViewRays<'_>,
    reach: &ReachImage,
    free_key: i32,
    evidence: &FrameEvidence,
) {
    let projection = CellProjection::new(rays);
    let [layers, ..] = rays.box_in_grid();
    layers.into_par_iter().for_each(|i| draw_layer(rays, &projection, reach, i, free_key, evidence));
}

/// Offers `free_key` to the free cells with one index along x. Comparing takes fewer instructions from AVX
/// on; no result depends on it.
#[multiversion(targets("x86_64+avx2"))]
fn draw_layer(
    rays: &ViewRays<'_>,
    projection: &CellProjection,
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
fn is_free(rays: &ViewRays<'_>, projection: &CellProjection, reach: &ReachImage, cell: [usize; 3]) -> bool {
    let centre: [f64; 3] = std::array::from_fn(|a| cell[a] as f64 + 0.5 - rays.origin[a]);
    let place = projection.matrix * Vector3::from(centre);
    if place.z <= -projection.half_depth_m || place.z - projection.half_depth_m >= rays.max_depth_m {
        return false;
    }
    let steps = rays.steps_to(&cell.map(|index| index as i64));
    if pixel_reaches(rays, reach, centre, place, steps) {
        return true;
    }
    let Some(pixels) = projection.image_box(place, reach.size()) else { return false };
    if reach.row_bands(pixels, steps).next().is_none() {
        return false;
    }
    if projection.samples.iter().any(|s| pixel_reaches(rays, reach, centre, place + s, steps)) {
        return true;
    }
    let rays_end = place.z + projection.half_depth_m >= rays.max_depth_m;
    let silhouette = Silhouette::of_cell(rays, cell, rays_end);
    !silhouette.misses_image(reach.size()) && any_pixel_reaches(reach, &silhouette, pixels, steps)
}

/// Whether the pixel that sees a place within the cell reaches it. Its ray is only looked at in that depth,
/// so `false` decides nothing.
#[inline(always)]
fn pixel_reaches(
    rays: &ViewRays<'_>,
    reach: &ReachImage,
    centre: [f64; 3],
    place: Vector3<f64>,
    steps: i32,
) -> bool {
    pixel_at(rays, reach.size(), place)
        .is_some_and(|pixel| reach.at(pixel) >= steps && crosses(rays, centre, place.z, pixel))
}

/// Whether any pixel of the silhouette reaches as far as `steps`; `pixels` holds all of them.
#[inline(always)]
fn any_pixel_reaches(reach: &ReachImage, silhouette: &Silhouette, pixels: PixelBox, steps: i32) -> bool {
    // From the middle on: that is where a silhouette is widest.
    for part in pixels.halves() {
        for y in reach.row_bands(part, steps).flatten() {
            let seen = silhouette.columns(y, reach.size().width);
            if seen.is_some_and(|columns| reach.any_in_row(y, columns, steps)) {
                return true;
            }
        }
    }
    false
}
