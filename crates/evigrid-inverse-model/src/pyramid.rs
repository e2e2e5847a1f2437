//! Pyramids of disparity images (Andert 2009, eqs 14 to 16).

use evigrid_core::{MatchFilter, NO_MATCH};
use multiversion::multiversion;
use rayon::prelude::*;

/// The one of four pixels that stands for all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keep {
    /// The farthest, for lines (eq. 14).
    Smallest,
    /// The nearest, for rays (eq. 16).
    Largest,
}

/// A disparity image at several resolutions. Pixel (x, y) of layer i stands for the image point
/// (2^i x, 2^i y). Odd sizes round up; pixels without a believed match ([`NO_MATCH`]) are skipped, and a
/// pixel of which all four have none has none.
#[derive(Debug, Default)]
pub(crate) struct Pyramid {
    /// Layers 0, 1, …; layer 0 is left as it is where nobody asks for it.
    layers: Vec<PyramidLayer>,
}

/// One image of a pyramid.
#[derive(Debug, Default)]
pub(crate) struct PyramidLayer {
    pub width: usize,
    pub height: usize,
    values: Vec<f32>,
}

impl PyramidLayer {
    /// The disparity of a pixel, or [`NO_MATCH`].
    #[inline(always)]
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.width + x]
    }

    /// The disparities of a row, or [`NO_MATCH`].
    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..(y + 1) * self.width]
    }

    fn resize(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.values.resize(width * height, NO_MATCH);
    }
}

/// Rows of layer 1 that one task makes.
const ROWS_PER_TASK: usize = 16;

impl Pyramid {
    /// Builds all layers of an image of this size up to that of a single pixel. Layer 0, the filtered image
    /// itself, is stored only if `lowest`, the lowest layer that will be asked for, is not above it.
    pub fn build(&mut self, filter: MatchFilter<'_>, width: usize, height: usize, keep: Keep, lowest: i32) {
        let sizes = std::iter::successors(Some((width, height)), |&(w, h)| {
            (w > 1 || h > 1).then(|| (w.div_ceil(2), h.div_ceil(2)))
        });
        let count = sizes.clone().count();
        self.layers.truncate(count);
        self.layers.resize_with(count, PyramidLayer::default);
        for (layer, (w, h)) in self.layers.iter_mut().zip(sizes).skip(usize::from(lowest > 0 && count > 1)) {
            layer.resize(w, h);
        }
        if lowest <= 0 || count == 1 {
            let pixels = ROWS_PER_TASK * width;
            let tasks = self.layers[0].values.par_chunks_mut(pixels).enumerate();
            tasks.for_each(|(task, rows)| fill(filter, task * pixels, rows));
        }
        if let [_, first, ..] = self.layers.as_mut_slice() {
            let across = first.width;
            first.values.par_chunks_mut(ROWS_PER_TASK * across).enumerate().for_each(|(task, rows)| {
                for (row, y) in rows.chunks_exact_mut(across).zip(task * ROWS_PER_TASK..) {
                    let (upper, lower) = (2 * y, (2 * y + 1).min(height - 1));
                    reduce_filtered(filter, keep, width, upper, lower, row);
                }
            });
        }
        for i in 2..count {
            let (below, above) = self.layers.split_at_mut(i);
            reduce_layer(keep, &below[i - 1], &mut above[0]);
        }
    }

    /// The highest layer, a single pixel.
    pub fn top(&self) -> i32 {
        self.layers.len() as i32 - 1
    }

    /// Layer i >= 0, or the image for enlarged layers.
    #[inline(always)]
    pub fn layer(&self, i: i32) -> &PyramidLayer {
        &self.layers[i.max(0) as usize]
    }
}

/// Fills rows with the filtered image from the pixel `first` on.
#[multiversion(targets("x86_64+avx2"))]
fn fill(filter: MatchFilter<'_>, first: usize, rows: &mut [f32]) {
    filter.fill(first, rows);
}

/// Columns of an image that are filtered before they are reduced.
const COLUMNS: usize = 512;

/// Sets one row of layer 1 from two rows of the image, given by their numbers.
#[multiversion(targets("x86_64+avx2"))]
fn reduce_filtered(
    filter: MatchFilter<'_>,
    keep: Keep,
    width: usize,
    upper: usize,
    lower: usize,
    row: &mut [f32],
) {
    let (mut upper_part, mut lower_part) = ([NO_MATCH; COLUMNS], [NO_MATCH; COLUMNS]);
    for (part, first) in row.chunks_mut(COLUMNS / 2).zip((0..).step_by(COLUMNS)) {
        let columns = COLUMNS.min(width - first);
        filter.fill(upper * width + first, &mut upper_part[..columns]);
        filter.fill(lower * width + first, &mut lower_part[..columns]);
        reduce_rows(keep, &upper_part[..columns], &lower_part[..columns], part);
    }
}

/// Sets one layer from the one below it. At the end of an odd image the last row counts twice.
#[multiversion(targets("x86_64+avx2"))]
fn reduce_layer(keep: Keep, below: &PyramidLayer, layer: &mut PyramidLayer) {
    for (row, y) in layer.values.chunks_exact_mut(layer.width).zip(0..) {
        reduce_rows(keep, below.row(2 * y), below.row((2 * y + 1).min(below.height - 1)), row);
    }
}

/// Sets a row from two rows of the layer below.
#[inline(always)]
fn reduce_rows(keep: Keep, upper: &[f32], lower: &[f32], row: &mut [f32]) {
    match keep {
        Keep::Smallest => reduce_by(upper, lower, row, smaller),
        Keep::Largest => reduce_by(upper, lower, row, larger),
    }
}

/// Sets a row from two rows of the layer below; `of` picks one of two disparities.
#[inline(always)]
fn reduce_by(upper: &[f32], lower: &[f32], row: &mut [f32], of: impl Fn(f32, f32) -> f32) {
    let odd = upper.len() % 2 == 1;
    if let (true, Some(last), Some(&up), Some(&low)) = (odd, row.last_mut(), upper.last(), lower.last()) {
        *last = of(up, low);
    }
    for ((to, up), low) in row.iter_mut().zip(upper.chunks_exact(2)).zip(lower.chunks_exact(2)) {
        *to = of(of(up[0], low[0]), of(up[1], low[1]));
    }
}

/// The smaller of two disparities; [`NO_MATCH`] counts as larger than all of them. As unsigned numbers the
/// bits of numbers from 0 on are in order, and those of [`NO_MATCH`] above them.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    f32::from_bits(a.to_bits().min(b.to_bits()))
}

/// The larger of two disparities; [`NO_MATCH`] is below all of them.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_core::{Disparity, MatchLimits, Matches};
    use proptest::prelude::*;

    /// The valid pixels of the 2^i x 2^i block that layer i's pixel stands for.
    fn block(image: &[f32], width: usize, height: usize, i: i32, x: usize, y: usize) -> Vec<f32> {
        let of = |v: usize, size: usize| v << i..((v + 1) << i).min(size);
        let rows = of(y, height).flat_map(|y| of(x, width).map(move |x| image[y * width + x]));
        rows.filter(|d| !d.is_nan()).collect()
    }

    proptest! {
        #[test]
        fn each_pixel_is_the_extreme_of_its_block(
            (height, width) in prop_oneof![(1..20_usize, 500..1040_usize), (1..90_usize, 1..40_usize)],
            seed: u64,
            holes in 0..10_u64,
        ) {
            let random = |n: usize| {
                (n as u64 + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33
            };
            let image: Vec<f32> = (0..width * height)
                .map(|n| if random(n) % 10 < holes { f32::NAN } else { (random(n + 7777) % 50) as f32 })
                .collect();
            let matches = Matches::from_disparity(Disparity::new(width, height, image.clone()).unwrap());
            let limits = MatchLimits { peak_ratio: 1.5, left_right_px: Some(0), too_near_px: f64::INFINITY };
            let mut pyramid = Pyramid::default();
            let picks = [(Keep::Smallest, f32::min as fn(f32, f32) -> f32), (Keep::Largest, f32::max)];
            for (keep, pick) in picks {
                let filter = MatchFilter::new(&matches, &limits);
                pyramid.build(filter, width, height, keep, 0);
                let mut upper = Pyramid::default();
                upper.build(filter, width, height, keep, 1);
                for i in 1..=pyramid.top() {
                    prop_assert_eq!(&pyramid.layer(i).values, &upper.layer(i).values);
                }
                let top = pyramid.layer(pyramid.top());
                prop_assert_eq!((top.width, top.height), (1, 1));
                for i in 0..=pyramid.top() {
                    let layer = pyramid.layer(i);
                    prop_assert_eq!(layer.width, width.div_ceil(1 << i));
                    prop_assert_eq!(layer.height, height.div_ceil(1 << i));
                    for (x, y) in (0..layer.height).flat_map(|y| (0..layer.width).map(move |x| (x, y))) {
                        let block = block(&image, width, height, i, x, y);
                        let expected = block.into_iter().reduce(pick).unwrap_or(NO_MATCH);
                        prop_assert_eq!(layer.at(x, y), expected, "layer {} at {}, {}", i, x, y);
                    }
                }
            }
        }
    }
}
