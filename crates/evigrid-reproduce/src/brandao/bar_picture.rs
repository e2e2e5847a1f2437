//! Maps of the bars from the front and from above.

use std::collections::BTreeMap;

use super::bar_maps::BarMap;
use super::bar_score::NEAR_CELLS;
use super::bars::{BARS_Y_M, Bars, FOOT_M, RADIUS_M};
use crate::chart::{Axis, BLUE, DARK, GREY, Marks, ORANGE, Panel, Point, Series, rectangle};

/// Cells so near the plane of the bars are seen from the front, metres.
const SLAB_M: f64 = 0.15;
/// The part of the world that is shown: to the left and right of the middle bar, upwards, and from before to
/// behind, metres.
/// A metre is as long along both axes of a panel of [`PANEL`].
const FRONT_Y_M: f64 = 1.5;
const FRONT_Z_M: [f64; 2] = [0.0, 2.4];
const ABOVE_Y_M: f64 = 3.0;
const ABOVE_X_M: [f64; 2] = [-1.8, 3.0];
pub const PANEL: (u32, u32) = (500, 418);

/// Occupied cells as areas: what is right and what is in the air. In the world's frame, its y to the left.
#[derive(Debug, Clone, Default)]
pub struct BarViews {
    front: [Vec<Vec<Point>>; 2],
    above: [Vec<Vec<Point>>; 2],
}

/// The index of what is in the air; 0 is what is right.
const AIR: usize = 1;

impl BarViews {
    pub fn new(bars: &Bars, log_odds: &[f32]) -> Self {
        let c = bars.spec.cell_size_m();
        // By level and half cells to the right; by column. What is right is drawn over what is not.
        let mut front: BTreeMap<(usize, i64), usize> = BTreeMap::new();
        let mut above: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for cell in (0..log_odds.len()).filter(|&cell| log_odds[cell] > 0.0) {
            let place = bars.in_world(cell);
            if place.z < FOOT_M {
                continue;
            }
            let kind = if bars.is_far_from_surfaces(cell, NEAR_CELLS) { AIR } else { 0 };
            let [i, j, k] = bars.spec.voxel(cell);
            if place.x.abs() <= SLAB_M && place.y.abs() <= FRONT_Y_M {
                let shown = front.entry((k, (-2.0 * place.y / c).round() as i64)).or_insert(kind);
                *shown = kind.min(*shown);
            }
            if place.y.abs() <= ABOVE_Y_M && (ABOVE_X_M[0]..=ABOVE_X_M[1]).contains(&place.x) {
                let shown = above.entry((i, j)).or_insert(kind);
                *shown = kind.min(*shown);
            }
        }
        Self { front: front_areas(bars, &front), above: above_areas(bars, &above) }
    }
}

/// Runs of cells that touch, level by level.
fn front_areas(bars: &Bars, cells: &BTreeMap<(usize, i64), usize>) -> [Vec<Vec<Point>>; 2] {
    let c = bars.spec.cell_size_m();
    let area = |level: usize, from: i64, to: i64| {
        // The first column of the grid has the flat indices of the levels.
        let foot = bars.in_world(level).z - 0.5 * c;
        rectangle([0.5 * (from - 1) as f64 * c, 0.5 * (to + 1) as f64 * c], [foot, foot + c])
    };
    let keys = cells.iter().map(|(&(level, at), &kind)| (level, at, kind));
    areas(keys, 2, area)
}

/// Runs of columns along y.
fn above_areas(bars: &Bars, columns: &BTreeMap<(usize, usize), usize>) -> [Vec<Vec<Point>>; 2] {
    let footprint = |i: usize, j: i64| {
        let flat = bars.spec.flat([i as i64, j, 0]).unwrap_or_default();
        bars.footprint(flat).map(|[x, y]| (-y, x))
    };
    let area = |i: usize, from: i64, to: i64| {
        let ([a, b, ..], [.., c, d]) = (footprint(i, from), footprint(i, to));
        vec![a, b, c, d]
    };
    areas(columns.iter().map(|(&(i, j), &kind)| (i, j as i64, kind)), 1, area)
}

/// One area for each run of neighbours (`step` apart) of a kind along a line, by kind. The keys are sorted.
fn areas(
    keys: impl Iterator<Item = (usize, i64, usize)>,
    step: i64,
    area: impl Fn(usize, i64, i64) -> Vec<Point>,
) -> [Vec<Vec<Point>>; 2] {
    let mut areas = <[Vec<Vec<Point>>; 2]>::default();
    let mut run: Option<(usize, i64, i64, usize)> = None;
    for (line, at, kind) in keys {
        match &mut run {
            Some((l, _, to, k)) if (*l, *k) == (line, kind) && at - *to <= step => *to = at,
            _ => {
                let done = run.replace((line, at, at, kind));
                done.iter().for_each(|&(l, from, to, k)| areas[k].push(area(l, from, to)));
            }
        }
    }
    run.iter().for_each(|&(l, from, to, k)| areas[k].push(area(l, from, to)));
    areas
}

impl BarMap {
    /// From the front, where gaps show.
    pub fn front(&self) -> Panel {
        let truth = BARS_Y_M.map(|y| rectangle([-y - RADIUS_M, -y + RADIUS_M], [0.0, 2.0])).to_vec();
        Panel {
            title: self.reading.name.clone(),
            x: Axis::new("metres to the right, seen from the front", -FRONT_Y_M, FRONT_Y_M),
            y: Axis::new("height (m)", FRONT_Z_M[0], FRONT_Z_M[1]),
            series: layers(&self.views.front, truth),
            legend: None,
        }
    }

    /// From above, where outliers show.
    pub fn above(&self) -> Panel {
        let truth: Vec<Point> = BARS_Y_M.iter().map(|y| (-y, 0.0)).collect();
        let mut series = layers(&self.views.above, Vec::new());
        series.push(Series::new("", DARK, Marks::Rings(truth, 3)));
        let title = format!(
            "worst bar {:.0} % there, {} gaps, {} outliers around the bars",
            100.0 * self.score.worst_bar(),
            self.score.gaps,
            self.score.outliers_around
        );
        Panel {
            title,
            x: Axis::new("metres to the right, seen from above", -ABOVE_Y_M, ABOVE_Y_M),
            y: Axis::new("metres behind the bars", ABOVE_X_M[0], ABOVE_X_M[1]),
            series,
            legend: None,
        }
    }
}

/// The truth below, what is in the air, and what is right.
fn layers([right, air]: &[Vec<Vec<Point>>; 2], truth: Vec<Vec<Point>>) -> Vec<Series> {
    vec![
        Series::new("", ORANGE, Marks::Areas(air.clone())),
        Series::new("", BLUE, Marks::Areas(right.clone())),
        Series::new("", GREY, Marks::Areas(truth)),
    ]
}
