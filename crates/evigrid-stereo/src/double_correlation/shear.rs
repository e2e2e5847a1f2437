//! The right image sheared so that the ground has disparity 0.

use std::ops::Range;

use evigrid_core::{DisparityPlane, GrayImage};
use rayon::prelude::*;

/// Columns of a row at which the ground has one whole disparity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub columns: Range<usize>,
    pub shift: isize,
}

/// The ground's disparities of every row, and the right image with every pixel moved to the column of the left image in
/// which ground at that place is seen; between pixels it is interpolated, so that all rows of a window fit as well.
///
/// A camera that rolls sees ground of several disparities in one row. Pixels of the left image within the reach of
/// a step between two of them are compared along the step of the right image's column, not of their own: that is a
/// difference of one pixel in a few columns.
#[derive(Debug, Default)]
pub(super) struct Shear {
    runs: Vec<Vec<Run>>,
    /// The least and the largest whole disparity around those of the ground, row by row.
    extents: Vec<[isize; 2]>,
    /// Rows of the image's width and `reach` pixels on both sides.
    pixels: Vec<u8>,
    reach: usize,
    width: usize,
}

impl Shear {
    /// Shears the right image; residual disparities of up to `reach` pixels will be asked for.
    pub fn fill(&mut self, right: &GrayImage, ground: &DisparityPlane, reach: usize) {
        let (width, height) = (right.width(), right.height());
        (self.reach, self.width) = (reach, width);
        self.runs.resize_with(height, Vec::new);
        self.pixels.resize((width + 2 * reach) * height, 0);
        let extent = |y: usize| {
            let ends = [0, width - 1].map(|x| ground.at(x as f64, y as f64));
            [ends[0].min(ends[1]).floor() as isize, ends[0].max(ends[1]).ceil() as isize]
        };
        self.extents.clear();
        self.extents.extend((0..height).map(extent));
        let rows = self.pixels.par_chunks_exact_mut(width + 2 * reach).zip(&mut self.runs);
        rows.enumerate().for_each(|(y, (out, runs))| {
            fill_runs(ground, y, width, runs);
            fill_row(right.row(y), ground, y, reach, out);
        });
    }

    /// The pixels that a row of the left image is compared with under a residual disparity.
    #[inline(always)]
    pub fn row(&self, y: usize, residual: isize) -> &[u8] {
        let start = y * (self.width + 2 * self.reach) + self.reach.wrapping_add_signed(-residual);
        &self.pixels[start..start + self.width]
    }

    /// The ground's whole disparities in a row, from left to right.
    pub fn runs(&self, y: usize) -> &[Run] {
        &self.runs[y]
    }

    /// Whole disparities that hold all of the ground's in a row between them, pixels.
    pub fn extent(&self, y: usize) -> [isize; 2] {
        self.extents[y]
    }
}

/// Grey levels of a row at the places of the ground, from `reach` pixels before its first on; those beyond the row are
/// that of its end.
fn fill_row(pixels: &[u8], ground: &DisparityPlane, y: usize, reach: usize, out: &mut [u8]) {
    let last = pixels.len() as isize - 1;
    let value = |place: f64| {
        let (whole, weight) = (place.floor(), ((place - place.floor()) * 256.0).round() as u32);
        let at = |column: isize| u32::from(pixels[column.clamp(0, last) as usize]);
        let (a, b) = (at(whole as isize), at(whole as isize + 1));
        (((256 - weight) * a + weight * b + 128) >> 8) as u8
    };
    let column = |n: usize| n as f64 - reach as f64;
    if ground.per_column != 0.0 {
        for (n, out) in out.iter_mut().enumerate() {
            *out = value(column(n) - ground.at(column(n), y as f64));
        }
        return;
    }
    // One shift for the whole row: its inside, side by side, and its ends.
    let start = column(0) - ground.at(0.0, y as f64);
    let (whole, weight) = (start.floor() as isize, ((start - start.floor()) * 256.0).round() as u32);
    let n = out.len() as isize;
    let inside = (-whole).clamp(0, n)..(last - whole).clamp(0, n);
    let inside = inside.start as usize..inside.end.max(inside.start) as usize;
    for at in (0..inside.start).chain(inside.end..out.len()) {
        out[at] = value(start + at as f64);
    }
    if !inside.is_empty() {
        let first = (inside.start as isize + whole) as usize;
        let (near, far) = (&pixels[first..][..inside.len()], &pixels[first + 1..][..inside.len()]);
        for ((out, &near), &far) in out[inside].iter_mut().zip(near).zip(far) {
            *out = (((256 - weight) * u32::from(near) + weight * u32::from(far) + 128) >> 8) as u8;
        }
    }
}

/// Cuts a row where the rounded disparity of the ground changes.
fn fill_runs(ground: &DisparityPlane, y: usize, width: usize, runs: &mut Vec<Run>) {
    runs.clear();
    let shift = |x: usize| ground.at(x as f64, y as f64).round() as isize;
    if ground.per_column == 0.0 {
        return runs.push(Run { columns: 0..width, shift: shift(0) });
    }
    for x in 0..width {
        let here = shift(x);
        match runs.last_mut() {
            Some(run) if run.shift == here => run.columns.end = x + 1,
            _ => runs.push(Run { columns: x..x + 1, shift: here }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(per_column: f64) -> DisparityPlane {
        DisparityPlane { at_centre_px: 0.0, per_column, per_row: 0.4, centre_px: [10.0, 3.0] }
    }

    #[test]
    fn ground_lies_at_disparity_0() {
        let (width, height) = (20, 12);
        let right = GrayImage::new(width, height, (0..240).map(|n| (n * 7 % 251) as u8).collect()).unwrap();
        for per_column in [0.0, 0.1, -0.06] {
            let (ground, mut shear) = (plane(per_column), Shear::default());
            shear.fill(&right, &ground, 3);
            for y in 0..height {
                for (x, residual) in (0..width).flat_map(|x| (-3..=3).map(move |r| (x, r))) {
                    // The place in the right image of what the sheared image's column shows.
                    let column = x as f64 - residual as f64;
                    let place = column - ground.at(column, y as f64);
                    let at = |c: f64| f64::from(right.row(y)[c.clamp(0.0, 19.0) as usize]);
                    let share = place - place.floor();
                    let expected = (1.0 - share) * at(place.floor()) + share * at(place.floor() + 1.0);
                    let found = f64::from(shear.row(y, residual)[x]);
                    assert!((found - expected).abs() < 1.0, "{x} {y} {residual}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn runs_cover_a_row_once() {
        let mut runs = Vec::new();
        fill_runs(&plane(0.1), 5, 20, &mut runs);
        // 0.4 * 2 + 0.1 (x - 10): -0.2 at x = 0, 0.5 from x = 7 on, 1.5 from x = 17 on.
        let expected = [(0..7, 0), (7..17, 1), (17..20, 2)];
        assert_eq!(runs, expected.map(|(columns, shift)| Run { columns, shift }));
        fill_runs(&plane(0.0), 5, 20, &mut runs);
        assert_eq!(runs, [Run { columns: 0..20, shift: 1 }]);
    }
}
