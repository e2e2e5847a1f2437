//! Fig. 3: the matching costs of free space, on a pair whose true disparity is known.

use anyhow::{Context, Result};
use evigrid_core::{CostVolume, Disparity, NO_COST, Pose};
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};

use super::moments::{Counts, Moments};
use crate::chart::{Axis, Corner, DARK, GREEN, Marks, Panel, SKY, Series, Sheet, rectangle};
use crate::job::Job;
use crate::table::rounded;

const DATASET: &str = "middlebury-cones";
/// The pair's largest true disparity is 55 px.
const STEREO: BlockMatchingSettings = BlockMatchingSettings { window: 7, min_disparity: 0, disparities: 64 };
/// The largest sum of 49 absolute differences, and the width of a bar of the histogram.
const LARGEST: usize = 49 * 255;
const BIN: usize = 150;
/// Costs beyond this are so few that the picture ends here.
const SHOWN: f64 = 5000.0;

/// Costs in front of the true surface, and on it.
struct Costs {
    free: Counts,
    surface: Counts,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let (_, dir) = job.dataset(DATASET)?.ok_or_else(|| job.missing(DATASET))?;
    let frame = evigrid_replay::open(&dir)?.frame(0, &Pose::identity())?;
    let truth = evigrid_replay::middlebury_truth(&dir)?;
    let matching = BlockMatcher::new(STEREO)?.run(frame.left(), frame.right(), true, None)?;
    let costs = costs(&matching.volume.context("no costs were kept")?, &truth);
    let (free, surface) = (costs.free.moments(), costs.surface.moments());
    let header = ["cost_from", "cost_below", "free_space_share", "normal_share", "true_position_share"];
    job.write_table(&header, (0..LARGEST).step_by(BIN).map(|from| row(&costs, &free, from)))?;
    let statistics =
        ["costs", "count", "mean", "variance", "skewness", "excess_kurtosis", "distance_to_normal", "paper"];
    let rows = [
        statistics_row("free space (d > true disparity)", &costs.free, &free, "about normal"),
        statistics_row("true position", &costs.surface, &surface, ""),
    ];
    job.write_more("statistics", &statistics, rows)?;
    job.write_picture(&picture(&costs, &free))
}

/// The costs of the whole disparity nearest to the true one, and of all larger ones,
/// which are in visible free space.
fn costs(volume: &CostVolume, truth: &Disparity) -> Costs {
    let mut costs = Costs { free: Counts::up_to(LARGEST), surface: Counts::up_to(LARGEST) };
    for y in 0..volume.height() {
        for (x, &d_true) in truth.row(y).iter().enumerate().filter(|(_, d)| !d.is_nan()) {
            for (index, cost) in volume.curve(x, y).enumerate().filter(|(_, cost)| *cost != NO_COST) {
                let d = (volume.min_disparity() + index) as f32;
                if d > d_true.round() {
                    costs.free.add(usize::from(cost));
                }
                if d == d_true.round() {
                    costs.surface.add(usize::from(cost));
                }
            }
        }
    }
    costs
}

/// Share of a normal distribution between two whole numbers, which stand for all that rounds to them.
fn normal_share(normal: &Moments, from: usize, to: usize) -> f64 {
    normal.below(to as f64 - 0.5) - normal.below(from as f64 - 0.5)
}

fn row(costs: &Costs, normal: &Moments, from: usize) -> [String; 5] {
    let to = from + BIN;
    let shares = [costs.free.share(from, to), normal_share(normal, from, to), costs.surface.share(from, to)];
    let [free, normal, surface] = shares.map(|share| rounded(share, 6));
    [from.to_string(), to.to_string(), free, normal, surface]
}

fn statistics_row(name: &str, counts: &Counts, m: &Moments, paper: &str) -> [String; 8] {
    let [skewness, kurtosis, distance] =
        [m.skewness, m.excess_kurtosis, m.distance_to_normal].map(|v| rounded(v, 4));
    let (mean, variance) = (rounded(m.mean, 1), rounded(m.variance, 0));
    let count = counts.total().to_string();
    [name.to_owned(), count, mean, variance, skewness, kurtosis, distance, paper.to_owned()]
}

fn picture(costs: &Costs, free: &Moments) -> Sheet {
    let bins: Vec<usize> = (0..LARGEST).step_by(BIN).filter(|from| (*from as f64) < SHOWN).collect();
    let bar = |from: usize, share: f64| rectangle([from as f64, (from + BIN) as f64], [0.0, 100.0 * share]);
    let free_bars = bins.iter().map(|&b| bar(b, costs.free.share(b, b + BIN))).collect();
    let middle = |b: usize| b as f64 + 0.5 * BIN as f64;
    let line = |share: &dyn Fn(usize) -> f64| bins.iter().map(|&b| (middle(b), 100.0 * share(b))).collect();
    let highest = bins.iter().map(|&b| costs.surface.share(b, b + BIN)).fold(0.0, f64::max);
    let panel = Panel {
        x: Axis::new("SAD over 7x7 pixels (grey levels)", 0.0, SHOWN),
        y: Axis::new("% of the costs, per 150 grey levels", 0.0, 105.0 * highest),
        series: vec![
            Series::new("free space: nearer than the true surface", SKY, Marks::Areas(free_bars)),
            Series::new(
                "normal distribution, same mean and variance",
                DARK,
                Marks::Line(line(&|b| normal_share(free, b, b + BIN))),
            ),
            Series::new(
                "on the true surface",
                GREEN,
                Marks::Line(line(&|b| costs.surface.share(b, b + BIN))),
            ),
        ],
        legend: Some(Corner::UpperRight),
        ..Panel::default()
    };
    Sheet {
        title: "Fig. 3: matching costs of free space, Middlebury Cones".into(),
        notes: vec![
            format!(
                "mean {:.0}, deviation {:.0}, skewness {:.2} (normal: 0), excess kurtosis {:.2} (normal: 0)",
                free.mean,
                free.variance.sqrt(),
                free.skewness,
                free.excess_kurtosis
            ),
            format!(
                "the paper: \"indicates a normal distribution\"; the cumulative shares differ by up to \
                 {:.1} %",
                100.0 * free.distance_to_normal
            ),
        ],
        columns: 1,
        panel: (820, 460),
        panels: vec![panel],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::CostScale;

    #[test]
    fn what_is_nearer_than_the_truth_is_free() {
        // Hypotheses 0, 1, 2 of three pixels: [disparity][column].
        let scale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };
        let volume = CostVolume::new(3, 1, 0, 3, scale, vec![9, 9, 9, 4, 5, 6, NO_COST, 7, 8]).unwrap();
        let truth = Disparity::new(3, 1, vec![0.0, 1.25, f32::NAN]).unwrap();
        let costs = costs(&volume, &truth);
        // Pixel 0: 4 is free, 9 is on the surface; pixel 1: 7 is free, 5 is on the surface.
        assert_eq!((costs.free.total(), costs.free.moments().mean), (2, 5.5));
        assert_eq!((costs.surface.total(), costs.surface.moments().mean), (2, 7.0));
    }
}
