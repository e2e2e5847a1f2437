//! Ray tracing (Andert 2009, sections V-B and VI-C): from cells to the pixels that see them.

use std::ops::Range;

use multiversion::multiversion;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::filter::INVALID;
use crate::gaussian_table::{FastModel, GaussianTable};
use crate::image_grid::ImageGrid;
use crate::pyramid::Pyramid;
use crate::window::{Projection, Window};
use evigrid_grid::ViewRays;

/// How the largest disparity around a cell's image is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// In all pixels of the cell's window (step 2c).
    Window,
    /// In four pixels of the fitting layer (section VI-C).
    Pyramid,
}

/// What all cells of one image share.
#[derive(Debug)]
pub(crate) struct RayContext<'a> {
    pub camera: ViewRays<'a>,
    pub model: FastModel,
    pub table: &'a GaussianTable,
    /// P of free space, p_min.
    pub free: f32,
    pub projection: Projection,
    /// Of the largest disparities; layer 0 is the image.
    pub pyramid: &'a Pyramid,
    pub search: Search,
    pub image: &'a ImageGrid,
}

/// Sets every cell of the sensor's box to L^(s(l)) of the nearest that is seen around it: steps 1 and 2. Returned is the number of
/// pixels that were looked at.
pub(crate) fn trace_rays(context: &RayContext<'_>) -> u64 {
    let [layers, columns, levels] = context.camera.box_in_grid();
    let across = columns.len();
    let row =
        |n: usize| trace_row(context, layers.start + n / across, columns.start + n % across, levels.clone());
    (0..layers.len() * across).into_par_iter().map(row).sum()
}

/// The cells with these indices along x and y.
#[multiversion(targets("x86_64+avx2"))]
fn trace_row(context: &RayContext<'_>, i: usize, j: usize, levels: Range<usize>) -> u64 {
    let RayContext { camera, projection, image, .. } = context;
    let centre = |k: usize| {
        let cell = [i, j, k];
        Vector3::from_fn(|a, _| cell[a] as f64 + 0.5 - camera.origin[a])
    };
    let [layer_stride, column_stride, _] = camera.spec.strides();
    let mut pixels = 0;
    for k in levels {
        let centre = centre(k);
        let place = projection.matrix * centre;
        // Step 2b: the image point of the cell's centre.
        let Some(point) = projection.image_point(&place) else { continue };
        // Step 2c: the largest disparity around it.
        let (disparity, looked_at) = match context.search {
            Search::Window => {
                let Some(window) = projection.window(&place) else { continue };
                (largest_in_window(context.pyramid, window), pixels_of(window))
            }
            Search::Pyramid => largest_of_four(context, point, place.z),
        };
        pixels += looked_at;
        // Steps 2a, 2d and 2e.
        if let Some(p) = probability(context, disparity, &centre, place.z) {
            image.offer(i * layer_stride + j * column_stride + k, p);
        }
    }
    pixels
}

/// P of a cell, given the largest disparity around its image; `None` where that says nothing (L = 0).
#[inline(always)]
fn probability(context: &RayContext<'_>, disparity: f32, centre: &Vector3<f64>, depth: f64) -> Option<f32> {
    let camera = &context.camera;
    if disparity == INVALID {
        return None;
    }
    let measured = camera.rig.depth_m(f64::from(disparity));
    if measured > camera.max_depth_m {
        return (depth <= camera.max_depth_m).then_some(context.free);
    }
    // l, and l per depth, which is that of the ray through the cell's centre.
    let range = centre.norm();
    let profile = context.model.profile(measured, range / depth);
    Some(context.table.max_probability(&profile, range as f32)).filter(|&p| p != 0.5)
}

fn pixels_of([[left, right], [top, bottom]]: Window) -> u64 {
    ((right - left + 1) * (bottom - top + 1)) as u64
}

/// d^ of all pixels of a window; INVALID if none has a measurement.
#[inline(always)]
fn largest_in_window(pyramid: &Pyramid, [[left, right], [top, bottom]]: Window) -> f32 {
    let image = pyramid.layer(0);
    let mut largest = INVALID;
    for y in top..=bottom {
        let row = &image.row(y)[left..=right];
        let mut lanes = [INVALID; 8];
        let mut chunks = row.chunks_exact(8);
        for chunk in &mut chunks {
            for (lane, &d) in lanes.iter_mut().zip(chunk) {
                *lane = if d > *lane { d } else { *lane };
            }
        }
        let rest = chunks.remainder().iter();
        largest = lanes.iter().chain(rest).fold(largest, |most, &d| if d > most { d } else { most });
    }
    largest
}

/// d^ of the four pixels of the fitting layer i >= 0, from floor(x / 2^i), floor(y / 2^i) on; and that they are four. At the
/// image's end the last ones are taken twice.
#[inline(always)]
fn largest_of_four(context: &RayContext<'_>, [x, y]: [f64; 2], depth: f64) -> (f32, u64) {
    let pyramid = context.pyramid;
    // Eq. 13 for the cell's own depth: dp = z 2^i / f within (c/2, c], so i is the exponent of c f / z.
    let pixels_per_cell = context.camera.spec.cell_size_m() * context.camera.rig.focal_px / depth;
    let i = exponent(pixels_per_cell).clamp(0, pyramid.top());
    let layer = pyramid.layer(i);
    let at = |v: f64| (v.max(0.0) as usize) >> i;
    let (left, top) = (at(x), at(y));
    let (right, bottom) = ((left + 1).min(layer.width - 1), (top + 1).min(layer.height - 1));
    let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
    let largest =
        corners.iter().map(|&(x, y)| layer.at(x, y)).fold(INVALID, |most, d| if d > most { d } else { most });
    (largest, 4)
}

/// floor(log2 v) of a positive number that is not tiny.
#[inline(always)]
fn exponent(v: f64) -> i32 {
    ((v.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_is_the_logarithm() {
        for v in [0.1, 0.5, 0.999, 1.0, 1.5, 2.0, 700.0, 1024.0] {
            assert_eq!(exponent(v), v.log2().floor() as i32);
        }
    }
}
