//! The free space of one frame for several maps at once, by the steps of [`crate::free_space`] for one map.

use std::cell::Cell;

use evigrid_grid::ViewRays;
use multiversion::multiversion;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::nested::NestedEvidence;
use super::nested_reach::NestedReach;
use crate::free_space::{CellProjection, Silhouette, crosses, pixel_at};
use crate::pixels::PixelBox;

/// Offers `free_key` to every cell that some ray crosses within the pixel's reach, at the highest level of
/// such a ray.
pub(crate) fn draw_free_space(
    rays: &ViewRays<'_>,
    reach: &NestedReach,
    free_key: i32,
    evidence: &NestedEvidence,
) {
    let projection = CellProjection::new(rays);
    let [layers, ..] = rays.box_in_grid();
    layers.into_par_iter().for_each(|i| draw_layer(rays, &projection, reach, i, free_key, evidence));
}

/// Offers `free_key` to the free cells with one index along x, each at its level.
#[multiversion(targets("x86_64+avx2"))]
fn draw_layer(
    rays: &ViewRays<'_>,
    projection: &CellProjection,
    reach: &NestedReach,
    i: usize,
    free_key: i32,
    evidence: &NestedEvidence,
) {
    let [_, columns, levels] = rays.box_in_grid();
    let [layer_stride, column_stride, _] = rays.spec.strides();
    let all = evidence.levels() as i32;
    for j in columns {
        for k in levels.clone() {
            let flat = i * layer_stride + j * column_stride + k;
            // What has evidence already has no less than that of a free cell.
            let known = evidence.level(flat) as i32;
            let free =
                if known < all { free_level(rays, projection, reach, [i, j, k], known, all) } else { 0 };
            if free > known {
                evidence.offer(flat, free as usize, free_key);
            }
        }
    }
}

/// The highest level of the rays that cross the cell within their pixel's reach. Only more than `known` is of
/// interest, and there is no more than `all`.
#[inline(always)]
fn free_level(
    rays: &ViewRays<'_>,
    projection: &CellProjection,
    reach: &NestedReach,
    cell: [usize; 3],
    known: i32,
    all: i32,
) -> i32 {
    let centre: [f64; 3] = std::array::from_fn(|a| cell[a] as f64 + 0.5 - rays.origin[a]);
    let place = projection.matrix * Vector3::from(centre);
    if place.z <= -projection.half_depth_m || place.z - projection.half_depth_m >= rays.max_depth_m {
        return 0;
    }
    let steps = rays.steps_to(&cell.map(|index| index as i64));
    let level = Cell::new(known.max(pixel_level(rays, reach, centre, place, steps)));
    if level.get() == all {
        return all;
    }
    let Some(pixels) = projection.image_box(place, reach.size()) else { return level.get() };
    if reach.row_bands(pixels, steps, &level).next().is_none() {
        return level.get();
    }
    for sample in &projection.samples {
        level.set(level.get().max(pixel_level(rays, reach, centre, place + sample, steps)));
    }
    if level.get() == all {
        return all;
    }
    let rays_end = place.z + projection.half_depth_m >= rays.max_depth_m;
    let silhouette = Silhouette::of_cell(rays, cell, rays_end);
    if !silhouette.misses_image(reach.size()) {
        raise_to_pixels(reach, &silhouette, pixels, steps, &level, all);
    }
    level.get()
}

/// The level of the pixel that sees a place within the cell, if it reaches it; else 0. Its ray is only looked
/// at in that depth, so 0 decides nothing.
#[inline(always)]
fn pixel_level(
    rays: &ViewRays<'_>,
    reach: &NestedReach,
    centre: [f64; 3],
    place: Vector3<f64>,
    steps: i32,
) -> i32 {
    let Some(pixel) = pixel_at(rays, reach.size(), place) else { return 0 };
    let level = reach.level_at(pixel, steps);
    if level > 0 && crosses(rays, centre, place.z, pixel) { level } else { 0 }
}

/// Raises `level`, up to `all`, to the highest of the silhouette's pixels that reach as far as `steps`;
/// `pixels` holds all of the silhouette.
#[inline(always)]
fn raise_to_pixels(
    reach: &NestedReach,
    silhouette: &Silhouette,
    pixels: PixelBox,
    steps: i32,
    level: &Cell<i32>,
    all: i32,
) {
    // From the middle on: that is where a silhouette is widest.
    for part in pixels.halves() {
        for y in reach.row_bands(part, steps, level).flatten() {
            let Some(columns) = silhouette.columns(y, reach.size().width) else { continue };
            level.set(level.get().max(reach.level_in_row(y, columns, steps)));
            if level.get() == all {
                return;
            }
        }
    }
}
