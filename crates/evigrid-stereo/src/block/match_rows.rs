//! Costs and winners of the rows of one band.

use evigrid_core::NO_COST;
use multiversion::multiversion;

use super::bands::Band;
use super::job::Job;
use crate::rows::{Halves, RowPair, add_differences, slide_differences, window_sums};
use crate::winner::{LANES, RowCosts, is_unique, peak_ratio};

/// Working memory of one task.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Sum of absolute differences down the window, `[disparity][column]`.
    columns: Vec<u16>,
    /// Costs of the current row, `[disparity][stride]`.
    pub costs: Vec<u16>,
    halves: Halves,
    /// Winner of every pixel of the current row, and of the right image's pixels.
    pub left_index: Vec<u16>,
    right_index: Vec<u16>,
}

impl Scratch {
    pub fn reset(&mut self, job: &Job<'_>) {
        let (d, w) = (job.settings.disparities, job.width());
        self.columns.clear();
        self.columns.resize(d * w, 0);
        self.costs.clear();
        self.costs.resize(d * job.stride(), NO_COST);
        self.left_index.clear();
        self.left_index.resize(w + LANES, 0);
        self.right_index.clear();
        self.right_index.resize(w + LANES, 0);
    }
}

/// Matches the rows of one band. The vector code is chosen for the processor at run time; all arithmetic is
/// on integers or single divisions, so every choice gives the same bytes.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2", "aarch64+neon"))]
pub(super) fn match_rows(job: &Job<'_>, mut band: Band<'_>, scratch: &mut Scratch) {
    scratch.reset(job);
    let width = job.width();
    for (i, y) in (band.first_row..).take(band.disparity.len() / width).enumerate() {
        update_columns(job, y, i == 0, scratch);
        update_costs(job, scratch);
        let row = i * width..(i + 1) * width;
        search_row(
            job,
            scratch,
            &mut band.disparity[row.clone()],
            &mut band.peak_ratio[row.clone()],
            &mut band.left_right[row],
        );
        if let Some(volume) = &mut band.volume {
            let len = job.shape().volume_row_len();
            copy_costs(job, scratch, &mut volume[i * len..(i + 1) * len]);
        }
    }
}

/// Column sums for the window around row `y`.
#[inline(always)]
pub(crate) fn update_columns(job: &Job<'_>, y: usize, first: bool, scratch: &mut Scratch) {
    let (radius, width) = (job.settings.radius(), job.width());
    for (d, columns) in scratch.columns.chunks_exact_mut(width).enumerate() {
        let shift = (job.settings.min_disparity + d).min(width);
        let columns = &mut columns[shift..];
        // Column x of the left image faces x - d of the right.
        let pair =
            |y: usize| RowPair { left: &job.left.row(y)[shift..], right: &job.right.row(y)[..width - shift] };
        if first {
            for y in y - radius..=y + radius {
                add_differences(columns, pair(y));
            }
        } else {
            slide_differences(columns, pair(y + radius), pair(y - radius - 1));
        }
    }
}

/// Costs of the current row from its column sums.
#[inline(always)]
pub(crate) fn update_costs(job: &Job<'_>, scratch: &mut Scratch) {
    let (window, radius, width) = (job.settings.window, job.settings.radius(), job.width());
    let (shift_bits, stride) = (job.settings.cost_shift(), job.stride());
    let columns = scratch.columns.chunks_exact(width);
    for (d, (columns, costs)) in columns.zip(scratch.costs.chunks_exact_mut(stride)).enumerate() {
        let shift = job.settings.min_disparity + d;
        if shift + window <= width {
            let fits = shift + radius..width - radius;
            window_sums(&columns[shift..], window, shift_bits, &mut scratch.halves, &mut costs[fits]);
        }
    }
}

/// Disparity, peak ratio and left-right difference of the current row.
#[inline(always)]
pub(crate) fn search_row(
    job: &Job<'_>,
    scratch: &mut Scratch,
    disparity: &mut [f32],
    ratio: &mut [f32],
    left_right: &mut [u16],
) {
    let (width, min_disparity) = (job.width(), job.settings.min_disparity);
    let costs =
        RowCosts { costs: &scratch.costs, stride: job.stride(), disparities: job.settings.disparities };
    for x in (0..width).step_by(LANES) {
        let winners = costs.search(x);
        scratch.left_index[x..x + LANES].copy_from_slice(&winners.index);
        scratch.right_index[x..x + LANES].copy_from_slice(&costs.search_right(x, min_disparity));
        for i in 0..LANES.min(width - x) {
            ratio[x + i] = peak_ratio(winners.first[i], winners.second[i]);
        }
        if job.uniqueness_percent > 0 {
            let runners_up = costs.runners_up(x, &winners.index);
            for i in 0..LANES.min(width - x) {
                if !is_unique(winners.first[i], runners_up[i], job.uniqueness_percent) {
                    ratio[x + i] = f32::NAN;
                }
            }
        }
    }
    for x in 0..width {
        if ratio[x].is_nan() {
            (disparity[x], left_right[x]) = (f32::NAN, u16::MAX);
            continue;
        }
        let index = scratch.left_index[x];
        let whole = min_disparity + usize::from(index);
        disparity[x] = whole as f32 + costs.vertex(x, usize::from(index));
        left_right[x] = index.abs_diff(scratch.right_index[x - whole]);
    }
}

/// Copies the current row's costs into the volume.
#[inline(always)]
fn copy_costs(job: &Job<'_>, scratch: &Scratch, volume: &mut [u16]) {
    let rows = scratch.costs.chunks_exact(job.stride());
    for (costs, row) in rows.zip(volume.chunks_exact_mut(job.width())) {
        row.copy_from_slice(&costs[..job.width()]);
    }
}
