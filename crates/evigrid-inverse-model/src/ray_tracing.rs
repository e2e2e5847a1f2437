//! Ray tracing (Andert 2009, sections V-B and VI-C): from cells to the pixels that see them.

use std::ops::Range;

use evigrid_core::NO_MATCH;
use evigrid_grid::ViewRays;
use multiversion::multiversion;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::gaussian_table::{FastModel, GaussianTable};
use crate::image_grid::ImageGrid;
use crate::pyramid::Pyramid;
use crate::window::{Window, WindowProjection};

/// How the largest disparity around a cell's image is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// In all pixels of the cell's window (step 2c).
    Window,
    /// In four pixels of the fitting layer (section VI-C).
    Pyramid,
}

/// The image that rays are traced in: everything that all cells have in common.
#[derive(Debug)]
pub(crate) struct RayContext<'a> {
    /// The rays of the pixels.
    pub camera: ViewRays<'a>,
    /// From depths to profiles.
    pub model: FastModel,
    /// From profiles to P.
    pub table: &'a GaussianTable,
    /// P of free space, p_min.
    pub free: f32,
    /// From cells to the pixels that see them.
    pub projection: WindowProjection,
    /// The pyramid of the largest disparities; layer 0 is the image.
    pub pyramid: &'a Pyramid,
    /// How the largest disparity is found.
    pub search: Search,
    /// The grid that is drawn into.
    pub image: &'a ImageGrid,
}

/// Sets every cell of the sensor's box to L^(s(l)) of the nearest that is seen around it: steps 1 and 2.
/// Returns the number of pixels that were looked at.
pub(crate) fn trace_rays(context: &RayContext<'_>) -> u64 {
    let [layers, columns, levels] = context.camera.box_in_grid();
    let across = columns.len();
    let row =
        |n: usize| trace_row(context, layers.start + n / across, columns.start + n % across, levels.clone());
    (0..layers.len() * across).into_par_iter().map(row).sum()
}

/// Traces the cells with these indices along x and y; returns the number of pixels that were looked at.
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

/// Probability P of a cell, given the largest disparity around its image; `None` where that says nothing.
#[inline(always)]
fn probability(context: &RayContext<'_>, disparity: f32, centre: &Vector3<f64>, depth: f64) -> Option<f32> {
    let camera = &context.camera;
    if disparity == NO_MATCH {
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

/// The number of a window's pixels.
fn pixels_of(window: Window) -> u64 {
    ((window.right - window.left + 1) * (window.bottom - window.top + 1)) as u64
}

/// Largest disparity d^ of all pixels of a window; [`NO_MATCH`] if none has one.
#[inline(always)]
fn largest_in_window(pyramid: &Pyramid, window: Window) -> f32 {
    let image = pyramid.layer(0);
    let mut largest = NO_MATCH;
    for y in window.top..=window.bottom {
        let row = &image.row(y)[window.left..=window.right];
        let mut lanes = [NO_MATCH; 8];
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

/// Largest disparity d^ of the four pixels of the fitting layer i >= 0, from floor(x / 2^i), floor(y / 2^i)
/// on; and the number of pixels, four. At the image's end the last ones are taken twice.
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
    let largest = corners
        .iter()
        .map(|&(x, y)| layer.at(x, y))
        .fold(NO_MATCH, |most, d| if d > most { d } else { most });
    (largest, 4)
}

/// Exponent floor(log2 v) of a positive number that is not tiny.
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
