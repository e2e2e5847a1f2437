//! The cost of a single pixel under every hypothesis, from planes of bytes that are computed once per pair.

use evigrid_core::GrayImage;
use rayon::prelude::*;

use super::settings::{PixelCost, SemiGlobalSettings};
use crate::buffers::Shape;
use crate::pre_filter::sobel_x;

/// Hypotheses that are treated side by side; curves are padded to multiples of it.
pub(super) const CHUNK: usize = 32;
/// Largest number of bytes per pixel that a kind of cost compares.
pub(super) const MAX_PLANES: usize = 6;

/// The planes of both images. Rows of the right image are reversed, so that the pixels x - d of one x lie in
/// a row, and go on with the first pixel where x - d is outside.
#[derive(Debug, Default)]
pub(super) struct Planes {
    left: Vec<u8>,
    right: Vec<u8>,
    width: usize,
    right_len: usize,
    planes: usize,
}

/// One row of the planes.
#[derive(Clone, Copy)]
pub(super) struct PlaneRow<'a> {
    left: &'a [u8],
    right: &'a [u8],
    width: usize,
    right_len: usize,
}

impl Planes {
    /// Computes the planes of a pair.
    pub fn fill(&mut self, settings: &SemiGlobalSettings, shape: Shape, left: &GrayImage, right: &GrayImage) {
        self.width = shape.width;
        self.right_len = shape.width + shape.min_disparity + shape.disparities.next_multiple_of(CHUNK);
        self.planes = plane_count(settings.pixel_cost);
        let (left_len, right_len) = (self.planes * self.width, self.planes * self.right_len);
        self.left.resize(shape.height * left_len, 0);
        self.right.resize(shape.height * right_len, 0);
        self.left.par_chunks_mut(left_len).enumerate().for_each(|(y, row)| fill_row(settings, left, y, row));
        self.right.par_chunks_mut(right_len).enumerate().for_each_init(Vec::new, |plain, (y, row)| {
            plain.resize(left_len, 0);
            fill_row(settings, right, y, plain);
            let planes = plain.chunks_exact(shape.width).zip(row.chunks_exact_mut(self.right_len));
            planes.for_each(|(plain, row)| reverse(plain, row));
        });
    }

    /// The planes of row `y`.
    pub fn row(&self, y: usize) -> PlaneRow<'_> {
        let (left_len, right_len) = (self.planes * self.width, self.planes * self.right_len);
        PlaneRow {
            left: &self.left[y * left_len..(y + 1) * left_len],
            right: &self.right[y * right_len..(y + 1) * right_len],
            width: self.width,
            right_len: self.right_len,
        }
    }
}

impl PlaneRow<'_> {
    /// Bytes of the left pixel `x`, one per plane.
    #[inline(always)]
    pub fn left<C: Cost>(&self, x: usize) -> [u8; MAX_PLANES] {
        let mut bytes = [0; MAX_PLANES];
        for (p, byte) in bytes.iter_mut().take(C::PLANES).enumerate() {
            *byte = self.left[p * self.width + x];
        }
        bytes
    }

    /// Bytes of the right pixels that `n` hypotheses compare with left pixel `x`, one run per plane. Planes
    /// that the kind of cost does not have repeat the first.
    #[inline(always)]
    pub fn right<C: Cost>(&self, x: usize, min_disparity: usize, n: usize) -> [&[[u8; CHUNK]]; MAX_PLANES] {
        let start = self.width - 1 - x + min_disparity;
        let mut planes = [&[][..]; MAX_PLANES];
        for (p, plane) in planes.iter_mut().enumerate() {
            let first = if p < C::PLANES { p * self.right_len } else { 0 };
            *plane = self.right[first + start..first + start + n].as_chunks().0;
        }
        planes
    }
}

fn reverse(plain: &[u8], row: &mut [u8]) {
    let first = plain.first().copied().unwrap_or(0);
    let (inside, outside) = row.split_at_mut(plain.len());
    inside.iter_mut().zip(plain.iter().rev()).for_each(|(to, from)| *to = *from);
    outside.fill(first);
}

fn plane_count(cost: PixelCost) -> usize {
    match cost {
        PixelCost::AbsoluteDifference => AbsoluteDifference::PLANES,
        PixelCost::BirchfieldTomasi => BirchfieldTomasi::PLANES,
        PixelCost::Census => Census::PLANES,
    }
}

/// The planes of row `y` of one image, `[plane][column]`.
fn fill_row(settings: &SemiGlobalSettings, image: &GrayImage, y: usize, row: &mut [u8]) {
    let width = image.width();
    match settings.pixel_cost {
        PixelCost::AbsoluteDifference => row.copy_from_slice(image.row(y)),
        PixelCost::BirchfieldTomasi => {
            let (sobel, grey) = row.split_at_mut(3 * width);
            sobel_x(image, y, settings.sobel_cap, &mut sobel[..width]);
            half_way(sobel);
            grey[..width].copy_from_slice(image.row(y));
            half_way(grey);
        }
        PixelCost::Census => census(image, y, row),
    }
}

/// Fills the second and third plane of a row: the lowest and the highest value within half a pixel to either
/// side, linearly interpolated, rounded down.
fn half_way(row: &mut [u8]) {
    let width = row.len() / 3;
    let (values, bounds) = row.split_at_mut(width);
    let (low, high) = bounds.split_at_mut(width);
    let bounds = |value: u8, before: u8, after: u8| {
        let between = |other: u8| ((u16::from(value) + u16::from(other)) / 2) as u8;
        let (before, after) = (between(before), between(after));
        (value.min(before).min(after), value.max(before).max(after))
    };
    let last = width - 1;
    (low[0], high[0]) = bounds(values[0], values[0], values[1.min(last)]);
    (low[last], high[last]) = bounds(values[last], values[last.saturating_sub(1)], values[last]);
    if last > 1 {
        let inner = low[1..last].iter_mut().zip(&mut high[1..last]);
        let values = values[..last - 1].iter().zip(&values[1..last]).zip(&values[2..]);
        for ((low, high), ((before, value), after)) in inner.zip(values) {
            (*low, *high) = bounds(*value, *before, *after);
        }
    }
}

/// Fills a row of planes with a bit for each of the 24 neighbours in 5 x 5 pixels: whether it is darker than
/// the centre, 8 bits to a plane; the border is repeated outwards.
fn census(image: &GrayImage, y: usize, row: &mut [u8]) {
    let (width, height) = (image.width(), image.height());
    let rows: [&[u8]; 5] = std::array::from_fn(|k| image.row((y + k).saturating_sub(2).min(height - 1)));
    for x in 0..width {
        let centre = rows[2][x];
        let mut bits = 0_u32;
        for (j, row) in rows.iter().enumerate() {
            for i in 0..5 {
                if (i, j) != (2, 2) {
                    let darker = row[(x + i).saturating_sub(2).min(width - 1)] < centre;
                    bits = bits << 1 | u32::from(darker);
                }
            }
        }
        for (plane, byte) in bits.to_le_bytes().into_iter().take(Census::PLANES).enumerate() {
            row[plane * width + x] = byte;
        }
    }
}

/// A kind of cost: of one left pixel against many right ones.
pub(super) trait Cost {
    /// Number of bytes per pixel that it compares.
    const PLANES: usize;
    /// The costs against a chunk of right pixels, given as one chunk per plane.
    fn costs(left: &[u8; MAX_PLANES], right: [&[u8; CHUNK]; MAX_PLANES]) -> [u8; CHUNK];
}

pub(super) struct AbsoluteDifference;
pub(super) struct BirchfieldTomasi;
pub(super) struct Census;

impl Cost for AbsoluteDifference {
    const PLANES: usize = 1;

    #[inline(always)]
    fn costs(left: &[u8; MAX_PLANES], right: [&[u8; CHUNK]; MAX_PLANES]) -> [u8; CHUNK] {
        let mut out = [0; CHUNK];
        for i in 0..CHUNK {
            out[i] = left[0].abs_diff(right[0][i]);
        }
        out
    }
}

impl Cost for BirchfieldTomasi {
    const PLANES: usize = 6;

    #[inline(always)]
    fn costs(left: &[u8; MAX_PLANES], right: [&[u8; CHUNK]; MAX_PLANES]) -> [u8; CHUNK] {
        let mut out = [0; CHUNK];
        for i in 0..CHUNK {
            // Distance of a value from the other image's interval, either way round; the lesser counts.
            let distance = |p: usize| {
                let [l, l_low, l_high] = [left[p], left[p + 1], left[p + 2]];
                let [r, r_low, r_high] = [right[p][i], right[p + 1][i], right[p + 2][i]];
                let to_right = l.saturating_sub(r_high).max(r_low.saturating_sub(l));
                let to_left = r.saturating_sub(l_high).max(l_low.saturating_sub(r));
                to_right.min(to_left)
            };
            out[i] = distance(0) + distance(3) / 4;
        }
        out
    }
}

impl Cost for Census {
    const PLANES: usize = 3;

    #[inline(always)]
    fn costs(left: &[u8; MAX_PLANES], right: [&[u8; CHUNK]; MAX_PLANES]) -> [u8; CHUNK] {
        let mut out = [0; CHUNK];
        for i in 0..CHUNK {
            for p in 0..Self::PLANES {
                out[i] += (left[p] ^ right[p][i]).count_ones() as u8;
            }
        }
        out
    }
}
