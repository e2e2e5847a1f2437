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

/// The ground's disparities of every row, rounded, and the right image with every pixel moved to the column of the
/// left image in which ground at that place is seen.
///
/// A camera that rolls sees ground of several disparities in one row. Pixels of the left image within the reach of
/// a step between two of them are compared along the step of the right image's column, not of their own: that is a
/// difference of one pixel in a few columns.
#[derive(Debug, Default)]
pub(super) struct Shear {
    runs: Vec<Vec<Run>>,
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
        let rows = self.pixels.par_chunks_exact_mut(width + 2 * reach).zip(&mut self.runs);
        rows.enumerate().for_each(|(y, (out, runs))| {
            fill_runs(ground, y, width, runs);
            let pixels = right.row(y);
            let at = |column: isize| pixels[column.clamp(0, width as isize - 1) as usize];
            for run in runs.iter() {
                let columns = run.columns.clone().map(|x| x as isize);
                for (to, x) in out[reach..][run.columns.clone()].iter_mut().zip(columns) {
                    *to = at(x - run.shift);
                }
            }
            if let (Some(first), Some(last)) = (runs.first(), runs.last()) {
                for (n, to) in out[..reach].iter_mut().enumerate() {
                    *to = at(n as isize - reach as isize - first.shift);
                }
                for (n, to) in out[reach + width..].iter_mut().enumerate() {
                    *to = at((width + n) as isize - last.shift);
                }
            }
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

    /// The least and the largest whole disparity of the ground in a row, pixels.
    pub fn extent(&self, y: usize) -> [isize; 2] {
        let ends = [self.runs[y].first(), self.runs[y].last()].map(|run| run.map_or(0, |run| run.shift));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
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
                    // The column of the sheared image, whose own shift counts.
                    let column = x as isize - residual;
                    let inside = column.clamp(0, width as isize - 1);
                    let shift = ground.at(inside as f64, y as f64).round() as isize;
                    let expected = right.row(y)[(column - shift).clamp(0, width as isize - 1) as usize];
                    assert_eq!(shear.row(y, residual)[x], expected, "{x} {y} {residual}");
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
