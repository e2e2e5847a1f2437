//! Which readings a scale keeps, and what it takes from the next coarser scale.

use std::ops::RangeInclusive;

use evigrid_core::Matches;
use rayon::prelude::*;

use crate::buffers::Buffers;

/// Coarse neighbours whose disparities differ by more belong to different surfaces; nothing is interpolated
/// between them. Coarse pixels.
const MAX_STEP_PX: f32 = 1.0;

/// What a match must keep to be reliable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Largest left-right difference, pixels of the scale.
    pub left_right_px: u16,
    /// Smallest texture, grey levels.
    pub texture: usize,
}

/// The finished matches of the next coarser scale, and the disparities that the finer one may take.
pub(super) struct Coarser<'a> {
    pub matches: &'a Matches,
    pub range: RangeInclusive<f32>,
}

/// A match of one pixel.
struct Reading {
    disparity: f32,
    peak_ratio: f32,
    left_right: u16,
}

impl Reading {
    const NONE: Self = Self { disparity: f32::NAN, peak_ratio: f32::NAN, left_right: u16::MAX };
}

/// Keeps the reliable matches of a scale and gives the other pixels the reading of the coarser scale, or
/// none. `texture` has a value for every pixel, or is empty where nobody asks for texture.
pub(super) fn keep_or_fill(
    out: &mut Buffers,
    width: usize,
    limits: Limits,
    texture: &[u32],
    coarser: Option<&Coarser<'_>>,
) {
    let rows = out.disparity.par_chunks_mut(width).zip(out.peak_ratio.par_chunks_mut(width));
    let rows = rows.zip(out.left_right.par_chunks_mut(width)).enumerate();
    rows.for_each(|(y, ((disparity, peak_ratio), left_right))| {
        for x in 0..width {
            let is_textured = texture.get(y * width + x).is_none_or(|&sum| sum as usize >= limits.texture);
            if is_textured && !disparity[x].is_nan() && left_right[x] <= limits.left_right_px {
                continue;
            }
            let reading = coarser.and_then(|coarser| coarser.at(x, y)).unwrap_or(Reading::NONE);
            disparity[x] = reading.disparity;
            peak_ratio[x] = reading.peak_ratio;
            left_right[x] = reading.left_right;
        }
    });
}

impl Coarser<'_> {
    /// The reading for pixel (x, y) of the finer scale: that of the coarse pixel that covers it, in finer
    /// pixels. The disparity is interpolated between the four coarse pixels around it, of which those without
    /// a reading and those of other surfaces count as the one that covers it.
    fn at(&self, x: usize, y: usize) -> Option<Reading> {
        let disparity = &self.matches.disparity;
        let (width, height) = (disparity.width(), disparity.height());
        let (across, down) = (x / 2, y / 2);
        let own = (across < width && down < height).then(|| disparity.row(down)[across])?;
        let (beside, over) = (nearest_other(x, width), nearest_other(y, height));
        let alike = |x: usize, y: usize| {
            let value = disparity.row(y)[x];
            if (value - own).abs() <= MAX_STEP_PX { value } else { own }
        };
        // The finer pixel's centre lies a quarter of a coarse pixel from that of the coarse one.
        let edges = alike(beside, down) + alike(across, over);
        let doubled = (9.0 * own + 3.0 * edges + alike(beside, over)) / 8.0;
        let pixel = down * width + across;
        self.range.contains(&doubled).then(|| Reading {
            disparity: doubled,
            peak_ratio: self.matches.peak_ratio[pixel],
            left_right: self.matches.left_right_difference_px[pixel].saturating_mul(2),
        })
    }
}

/// Along one axis, the coarse pixel that is second nearest to a finer one; at the image's end the nearest.
fn nearest_other(fine: usize, coarse_len: usize) -> usize {
    let coarse = fine / 2;
    if fine.is_multiple_of(2) { coarse.saturating_sub(1) } else { (coarse + 1).min(coarse_len - 1) }
}
