//! The ground of a frame from its v-disparity (Labayrade, Aubert and Tarel 2002): in the histogram of disparities row
//! by row, level ground is a slanted line. The line that most pixels agree on is refined to a plane, so that pitch,
//! roll and height follow.
//!
//! The pair is matched at half its resolution: one pass of upright windows over a quarter of the pixels and half of
//! the disparities.

use evigrid_core::{DisparityPlane, GrayImage, Matches};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::block::{BlockMatcher, BlockMatchingSettings};
use crate::error::StereoError;
use crate::multi_scale::halve::halved;
use crate::multi_scale::settings::halved_hypotheses;

/// Edge of the upright windows, pixels of the half. Ground changes its disparity by a third of a pixel per row and
/// more, so that larger ones match it badly.
const WINDOW: usize = 7;
/// Bins per pixel of disparity, at half the resolution.
const BINS_PER_PX: f64 = 4.0;
/// A match is not used if another hypothesis costs less than 100 / (100 - this) times as much.
const UNIQUENESS_PERCENT: u32 = 10;
/// Distances from the plane within which pixels count, fit by fit, pixels of the full resolution.
const FIT_WITHIN_PX: [f64; 4] = [4.0, 2.0, 1.0, 1.0];
/// Least share of the pixels of the half that must lie on the ground.
const LEAST_SHARE: f64 = 0.04;
/// Slants of the rows that are tried, degrees; what is between them is left to the fit.
const ROLLS_DEG: [i32; 7] = [-6, -4, -2, 0, 2, 4, 6];
/// Steepest roll, as change per column over change per row: 20 degrees.
const MOST_ROLL: f64 = 0.36;

/// Finds the ground in the images of a pair.
#[derive(Debug)]
pub(super) struct VDisparity {
    matcher: BlockMatcher,
    largest_px: usize,
}

/// A match: column and row at full resolution, and the disparity there, pixels.
type Reading = [f64; 3];

impl VDisparity {
    /// `block`: disparities at full resolution.
    pub fn new(block: BlockMatchingSettings) -> Result<Self, StereoError> {
        let half = BlockMatchingSettings { window: WINDOW, ..halved_hypotheses(block) };
        let matcher = BlockMatcher::new(half)?.with_uniqueness(UNIQUENESS_PERCENT);
        Ok(Self { matcher, largest_px: half.min_disparity + half.disparities })
    }

    /// The ground; `None` if too few pixels agree on one.
    ///
    /// # Errors
    /// If the images differ in size.
    pub fn ground(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
    ) -> Result<Option<DisparityPlane>, StereoError> {
        if left.width().min(left.height()) / 2 < WINDOW {
            return Ok(None);
        }
        let (left, right) = (halved(left)?, halved(right)?);
        let matches = self.matcher.run(&left, &right, false, None)?.matches;
        let readings = readings(&matches);
        let least = (LEAST_SHARE * (left.width() * left.height()) as f64) as usize;
        let line = self.line(&matches);
        Ok(line.and_then(|line| plane(&readings, line, least)))
    }

    /// The line of the v-disparity that most pixels agree on, as a plane of the full resolution `[c, a, b]`: `c + a v +
    /// b u`. A camera that rolls sees level rows of the ground slanted; so rows are slanted by some angles.
    fn line(&self, matches: &Matches) -> Option<[f64; 3]> {
        let (rows, columns) = (matches.disparity.height(), matches.disparity.width());
        let middle = 0.5 * columns as f64;
        let best_of = |degrees: i32| {
            let slant = f64::from(degrees).to_radians().tan();
            let mut histogram = RowHistogram::new(rows, self.largest_px);
            for (pixel, disparity) in believed(matches) {
                let row = (pixel / columns) as f64 + slant * ((pixel % columns) as f64 - middle);
                histogram.count(row, disparity);
            }
            histogram.blur();
            let (votes, horizon, slope) = histogram.line()?;
            // Row v of the half is row 2 v + 0.5 of the image, and disparities double: slopes stay.
            let [horizon, middle] = [horizon, middle].map(|place| 2.0 * place + 0.5);
            let per_column = slope * slant;
            Some((votes, degrees, [-slope * horizon - per_column * middle, slope, per_column]))
        };
        let lines = ROLLS_DEG.into_par_iter().filter_map(best_of);
        // Equal votes go to the smaller angle, whichever thread comes first.
        lines.max_by_key(|(votes, degrees, _)| (*votes, -degrees.abs(), *degrees)).map(|(.., plane)| plane)
    }
}

/// How often each disparity is found in each row, at half the resolution.
struct RowHistogram {
    rows: usize,
    largest_px: usize,
    bins: usize,
    counts: Vec<u32>,
}

impl RowHistogram {
    fn new(rows: usize, largest_px: usize) -> Self {
        let bins = (largest_px as f64 * BINS_PER_PX) as usize + 2;
        Self { rows, largest_px, bins, counts: vec![0; rows * bins] }
    }

    fn count(&mut self, row: f64, disparity: f64) {
        let bin = (disparity * BINS_PER_PX).round() as usize;
        if row > -0.5 && (row.round() as usize) < self.rows && bin < self.bins {
            self.counts[row.round() as usize * self.bins + bin] += 1;
        }
    }

    /// Makes every bin the sum of those within half a pixel of it.
    fn blur(&mut self) {
        let reach = (0.5 * BINS_PER_PX) as usize;
        let mut sums = vec![0; self.bins];
        for row in self.counts.chunks_exact_mut(self.bins) {
            for (bin, sum) in sums.iter_mut().enumerate() {
                *sum = row[bin.saturating_sub(reach)..(bin + reach + 1).min(row.len())].iter().sum();
            }
            row.copy_from_slice(&sums);
        }
    }

    /// Pixels within half a pixel of the line that leaves disparity 0 at a row, in every second row.
    fn votes(&self, horizon: f64, slope: f64) -> u64 {
        let first = horizon.max(-1.0) as usize + 1;
        let in_row = |row: usize| {
            let bin = (slope * (row as f64 - horizon) * BINS_PER_PX).round() as usize;
            u64::from(if bin < self.bins { self.counts[row * self.bins + bin] } else { 0 })
        };
        (first..self.rows).step_by(2).map(in_row).sum()
    }

    /// The line with the most votes: these, its horizon and its slope. Horizons from as much above the image as it is
    /// high to a tenth above its last row; from 2 pixels in the last row on.
    fn line(&self) -> Option<(u64, f64, f64)> {
        let rows = self.rows as f64;
        let horizons =
            (0..self.rows / 2).map(|n| (4 * n) as f64 - rows).filter(|horizon| *horizon < 0.9 * rows);
        let lines = horizons.flat_map(|horizon| {
            let below = rows - 1.0 - horizon;
            (2..self.largest_px).step_by(2).map(move |px| (horizon, px as f64 / below))
        });
        let votes = lines.map(|(horizon, slope)| (self.votes(horizon, slope), horizon, slope));
        votes.max_by_key(|(votes, ..)| *votes).filter(|(votes, ..)| *votes > 0)
    }
}

/// Pixels whose match is unique and confirmed by the right image, with their disparities at half the resolution.
fn believed(matches: &Matches) -> impl Iterator<Item = (usize, f64)> {
    let pixels = matches.disparity.values().iter().zip(&matches.left_right_difference_px).enumerate();
    let believed = pixels.filter(|(_, (disparity, difference))| !disparity.is_nan() && **difference <= 1);
    believed.map(|(pixel, (disparity, _))| (pixel, f64::from(*disparity).max(0.0)))
}

fn readings(matches: &Matches) -> Vec<Reading> {
    let width = matches.disparity.width();
    let at = |pixel: usize| [pixel % width, pixel / width].map(|place| 2.0 * place as f64 + 0.5);
    believed(matches).map(|(pixel, disparity)| [at(pixel)[0], at(pixel)[1], 2.0 * disparity]).collect()
}

/// The plane `d = c + a v + b u` of least squares through the readings near it, from the line on; `None`
/// if fewer than `least` agree, or it is not that of ground.
fn plane(readings: &[Reading], line: [f64; 3], least: usize) -> Option<DisparityPlane> {
    let mut plane = Vector3::from(line);
    for within_px in FIT_WITHIN_PX {
        let (mut normal, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0);
        for [u, v, disparity] in readings {
            let row = Vector3::new(1.0, *v, *u);
            let expected = plane.dot(&row);
            if expected > 0.0 && (disparity - expected).abs() <= within_px {
                normal += row * row.transpose();
                right += row * *disparity;
                count += 1;
            }
        }
        if count < least.max(3) {
            return None;
        }
        plane = normal.cholesky()?.solve(&right);
    }
    let [at_centre_px, per_row, per_column] = plane.into();
    let is_ground = per_row > 0.0 && per_column.abs() <= MOST_ROLL * per_row;
    is_ground.then_some(DisparityPlane { at_centre_px, per_column, per_row, centre_px: [0.0, 0.0] })
}
