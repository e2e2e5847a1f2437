//! Costs, winners and classes of the rows of one band.

use evigrid_core::NO_COST;
use multiversion::multiversion;

use super::job::DoubleJob;
use crate::block::bands::Band;
use crate::block::match_rows::{Scratch as Upright, search_row, update_columns, update_costs};
use crate::rows::{Halves, RowPair, add_differences, slide_differences, window_sums};
use crate::winner::parabola_vertex;

/// Working memory of one task.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Of upright windows; its costs become the lower ones of both.
    upright: Upright,
    road: Road,
}

/// Sums and costs of windows that follow the ground, `[residual disparity][column]`.
#[derive(Debug, Default)]
struct Road {
    columns: Vec<u16>,
    costs: Vec<u16>,
    halves: Halves,
}

impl Road {
    fn reset(&mut self, job: &DoubleJob<'_>) {
        let residuals = job.residuals().count();
        self.columns.clear();
        self.columns.resize(residuals * job.width(), 0);
        self.costs.clear();
        self.costs.resize(residuals * job.width(), NO_COST);
    }

    /// Column sums for the window around row `y`.
    #[inline(always)]
    fn update_columns(&mut self, job: &DoubleJob<'_>, y: usize, first: bool) {
        let radius = job.upright.settings.radius();
        for (residual, columns) in job.residuals().zip(self.columns.chunks_exact_mut(job.width())) {
            let pair = |y| RowPair { left: job.upright.left.row(y), right: job.shear.row(y, residual) };
            if first {
                (y - radius..=y + radius).for_each(|y| add_differences(columns, pair(y)));
            } else {
                slide_differences(columns, pair(y + radius), pair(y - radius - 1));
            }
        }
    }

    /// Costs of the current row from its column sums.
    #[inline(always)]
    fn update_costs(&mut self, job: &DoubleJob<'_>) {
        let block = &job.upright.settings;
        let (width, radius) = (job.width(), block.radius());
        for (columns, costs) in self.columns.chunks_exact(width).zip(self.costs.chunks_exact_mut(width)) {
            let fits = radius..width - radius;
            window_sums(columns, block.window, block.cost_shift(), &mut self.halves, &mut costs[fits]);
        }
    }
}

/// Matches the rows of one band. The vector code is chosen for the processor at run time; all arithmetic is
/// on integers or single divisions, so every choice gives the same bytes.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2", "aarch64+neon"))]
pub(super) fn match_rows(job: &DoubleJob<'_>, band: Band<'_>, is_road: &mut [bool], scratch: &mut Scratch) {
    let Scratch { upright, road } = scratch;
    upright.reset(&job.upright);
    road.reset(job);
    let width = job.width();
    for (i, y) in (band.first_row..).take(band.disparity.len() / width).enumerate() {
        update_columns(&job.upright, y, i == 0, upright);
        update_costs(&job.upright, upright);
        road.update_columns(job, y, i == 0);
        road.update_costs(job);
        merge(job, y, road, &mut upright.costs);
        let row = i * width..(i + 1) * width;
        let disparity = &mut band.disparity[row.clone()];
        let (ratio, left_right) = (&mut band.peak_ratio[row.clone()], &mut band.left_right[row.clone()]);
        search_row(&job.upright, upright, disparity, ratio, left_right);
        classify(job, y, &RowResult { upright, road }, disparity, &mut is_road[row]);
    }
}

/// The costs of a row after the merge, and those of the road alone.
struct RowResult<'a> {
    upright: &'a Upright,
    road: &'a Road,
}

/// Lowers the upright costs of row `y` to those of the road where these are lower.
#[inline(always)]
fn merge(job: &DoubleJob<'_>, y: usize, road: &Road, costs: &mut [u16]) {
    let stride = job.upright.stride();
    job.for_each_road_run(y, |run| {
        let of_road = &road.costs[run.number * job.width()..][run.columns.clone()];
        let merged = &mut costs[run.hypothesis * stride..][run.columns];
        for (cost, road) in merged.iter_mut().zip(of_road) {
            *cost = (*cost).min(*road);
        }
    });
}

/// Tells which winners of row `y` are the road's, and puts their sub-pixel parts right, or off.
#[inline(always)]
fn classify(job: &DoubleJob<'_>, y: usize, row: &RowResult<'_>, disparity: &mut [f32], is_road: &mut [bool]) {
    let (min_disparity, stride) = (job.upright.settings.min_disparity, job.upright.stride());
    let index = &row.upright.left_index[..job.width()];
    is_road.fill(false);
    if !job.settings.sub_pixel {
        for (disparity, &index) in disparity.iter_mut().zip(index) {
            let whole = (min_disparity + usize::from(index)) as f32;
            *disparity = if disparity.is_nan() { f32::NAN } else { whole };
        }
    }
    job.for_each_road_run(y, |run| {
        let costs = &row.upright.costs[run.hypothesis * stride..][run.columns.clone()];
        let of_road = &row.road.costs[run.number * job.width()..][run.columns.clone()];
        let winners = &index[run.columns.clone()];
        let classes = &mut is_road[run.columns.clone()];
        for (((class, winner), cost), road) in classes.iter_mut().zip(winners).zip(costs).zip(of_road) {
            *class |= (usize::from(*winner) == run.hypothesis) & (cost == road);
        }
        if job.settings.sub_pixel {
            for x in run.columns.filter(|&x| usize::from(index[x]) == run.hypothesis && is_road[x]) {
                let whole = (min_disparity + run.hypothesis) as f32;
                let fraction = job.ground_fraction(x, y) + vertex(row.road, job.width(), run.number, x);
                disparity[x] = (whole + fraction).max(0.0);
            }
        }
    });
}

/// Offset of the lowest cost between whole residual disparities.
#[inline(always)]
fn vertex(road: &Road, width: usize, number: usize, x: usize) -> f32 {
    let cost = |number: usize| road.costs.get(number * width + x).copied().unwrap_or(NO_COST);
    parabola_vertex(if number == 0 { NO_COST } else { cost(number - 1) }, cost(number), cost(number + 1))
}
