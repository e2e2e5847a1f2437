//! From the summed path costs of a row to its disparities, peak ratios and left-right differences.

use evigrid_core::NO_COST;

use super::job::Job;
use super::pixel_costs::CHUNK;
use crate::winner::{LANES, RowCosts, Winners, is_unique, parabola_vertex, peak_ratio};

/// Output rows of one half of the image.
pub(super) struct OutRows<'a> {
    pub disparity: &'a mut [f32],
    pub peak_ratio: &'a mut [f32],
    pub left_right: &'a mut [u16],
    pub volume: Option<&'a mut [u16]>,
}

/// Working memory of the search in one row.
#[derive(Debug, Default)]
pub(super) struct RowSearch {
    /// The sums of [`LANES`] pixels, `[hypothesis][pixel]`.
    tile: Vec<u16>,
    /// Winners of the row's pixels.
    index: Vec<u16>,
    /// Lowest sum and its hypothesis of every pixel of the right image, from the last column to the first,
    /// and of as many more as hypotheses may point out of it.
    right_lowest: Vec<u16>,
    right_index: Vec<u16>,
    /// 0, 1, 2, ...
    numbers: Vec<u16>,
}

impl RowSearch {
    pub fn resize(&mut self, job: &Job<'_>) {
        self.tile.resize(job.padded * LANES, NO_COST);
        self.index.resize(job.shape.width + LANES, 0);
        let facing = job.shape.width + job.shape.min_disparity + job.padded;
        self.right_lowest.resize(facing, NO_COST);
        self.right_index.resize(facing, u16::MAX);
        self.numbers.clear();
        self.numbers.extend(0..job.padded as u16);
    }

    /// Finishes a row. `sums` and `others` are the path costs that two passes have summed,
    /// `[column][hypothesis]`; values for missing hypotheses mean nothing. The total is left in `sums`.
    #[inline(always)]
    pub fn finish_row(
        &mut self,
        job: &Job<'_>,
        sums: &mut [u16],
        others: &[u16],
        out: &mut OutRows<'_>,
        row: usize,
    ) {
        let (width, padded) = (job.shape.width, job.padded);
        sums.iter_mut().zip(others).for_each(|(sum, other)| *sum = sum.wrapping_add(*other));
        for (x, curve) in sums.chunks_exact_mut(padded).enumerate() {
            curve[job.hypotheses(x)..].fill(NO_COST);
        }
        self.search_right(job, sums);
        let place = row * width..(row + 1) * width;
        let ratio = &mut out.peak_ratio[place.clone()];
        let mut volume = out.volume.as_mut().map(|volume| {
            let len = job.shape.volume_row_len();
            &mut volume[row * len..(row + 1) * len]
        });
        for x in (0..width).step_by(LANES) {
            let lanes = LANES.min(width - x);
            self.fill_tile(&sums[x * padded..(x + lanes) * padded], padded);
            let winners = self.search_tile(job);
            self.index[x..x + LANES].copy_from_slice(&winners.index);
            for i in 0..lanes {
                ratio[x + i] = peak_ratio(winners.first[i], winners.second[i]);
            }
            if let Some(volume) = &mut volume {
                self.copy_tile(job, x, lanes, volume);
            }
        }
        self.write_row(job, sums, ratio, &mut out.disparity[place.clone()], &mut out.left_right[place]);
    }

    /// The lowest sums of the right image's pixels. Hypotheses come from small to large, so ties go to the
    /// smaller.
    #[inline(always)]
    fn search_right(&mut self, job: &Job<'_>, sums: &[u16]) {
        self.right_lowest.fill(NO_COST);
        self.right_index.fill(u16::MAX);
        for (x, curve) in sums.chunks_exact(job.padded).enumerate() {
            let facing = job.facing(x)..job.facing(x) + job.padded;
            let lowest = &mut self.right_lowest[facing.clone()];
            let index = &mut self.right_index[facing];
            let costs = curve.as_chunks::<CHUNK>().0.iter().zip(self.numbers.as_chunks::<CHUNK>().0);
            let kept = lowest.as_chunks_mut::<CHUNK>().0.iter_mut().zip(index.as_chunks_mut::<CHUNK>().0);
            for ((cost, numbers), (lowest, index)) in costs.zip(kept) {
                for i in 0..CHUNK {
                    let lower = if cost[i] < lowest[i] { u16::MAX } else { 0 };
                    index[i] = (numbers[i] & lower) | (index[i] & !lower);
                    lowest[i] = lowest[i].min(cost[i]);
                }
            }
        }
    }

    /// Turns the sums of up to [`LANES`] pixels over.
    #[inline(always)]
    fn fill_tile(&mut self, sums: &[u16], padded: usize) {
        for (i, curve) in sums.chunks_exact(padded).enumerate() {
            for (lanes, cost) in self.tile.as_chunks_mut::<LANES>().0.iter_mut().zip(curve) {
                lanes[i] = *cost;
            }
        }
    }

    /// Winners and minima of the tile; a first minimum of [`NO_COST`] where there is none or it is not
    /// unique.
    #[inline(always)]
    fn search_tile(&self, job: &Job<'_>) -> Winners {
        let costs = RowCosts { costs: &self.tile, stride: LANES, disparities: job.shape.disparities };
        let mut winners = costs.search(0);
        if job.uniqueness_percent > 0 {
            let runners_up = costs.runners_up(0, &winners.index);
            for (first, runner_up) in winners.first.iter_mut().zip(runners_up) {
                if !is_unique(*first, runner_up, job.uniqueness_percent) {
                    *first = NO_COST;
                }
            }
        }
        winners
    }

    /// Copies the tile into a row of the volume: the mean over the paths, rounded to the nearest, halves up.
    #[inline(always)]
    fn copy_tile(&self, job: &Job<'_>, x: usize, lanes: usize, volume: &mut [u16]) {
        let (half, shift) = (job.settings.paths as u16 / 2, job.settings.paths.trailing_zeros());
        let rows = volume.chunks_exact_mut(job.shape.width).zip(self.tile.as_chunks::<LANES>().0);
        for (row, sums) in rows {
            let mut means = [0_u16; LANES];
            for i in 0..LANES {
                let mean = sums[i].saturating_add(half) >> shift;
                means[i] = if sums[i] == NO_COST { NO_COST } else { mean };
            }
            row[x..x + lanes].copy_from_slice(&means[..lanes]);
        }
    }

    #[inline(always)]
    fn write_row(
        &self,
        job: &Job<'_>,
        sums: &[u16],
        ratio: &[f32],
        disparity: &mut [f32],
        left_right: &mut [u16],
    ) {
        for x in 0..job.shape.width {
            if ratio[x].is_nan() {
                (disparity[x], left_right[x]) = (f32::NAN, u16::MAX);
                continue;
            }
            let index = self.index[x];
            let at = usize::from(index);
            let curve = &sums[x * job.padded..(x + 1) * job.padded];
            let vertex = match at.checked_sub(1).and_then(|below| curve.get(below..below + 3)) {
                Some(&[before, cost, after]) => parabola_vertex(before, cost, after),
                _ => 0.0,
            };
            disparity[x] = (job.shape.min_disparity + at) as f32 + vertex;
            left_right[x] = index.abs_diff(self.right_index[job.facing(x) + at]);
        }
    }
}
