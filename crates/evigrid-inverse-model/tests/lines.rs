//! Line drawing against a direct transcription: every pixel by itself, the cells of its line from the
//! definition of Bresenham's line, eqs 1 to 11 in double precision, a map of maxima.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;

use common::{CELL_M, RIG, Shot, cell_at, shot, spec};
use evigrid_grid::{LogOddsGrid, RayWalk, probability};
use evigrid_inverse_model::{
    BlockPoint, Counters, InverseModelMapper, LayerTable, LinePyramidSettings, LineSettings, Measurement,
    NearPixels, SensorModel, TABLE_ERROR, Walk,
};
use proptest::prelude::*;

const MAX_DEPTH_M: f64 = 7.0;

fn model(near: NearPixels) -> SensorModel {
    SensorModel {
        k: 0.1,
        min_probability: 0.35,
        disparity_error_px: 0.5,
        motion_error_m: 0.0,
        near,
        max_peak: probability(5.0) - 0.5,
        max_depth_m: MAX_DEPTH_M,
    }
}

/// The cells of Bresenham's line from its definition, for comparison alone: N steps, N the largest difference
/// of the indices, and after n steps each index is the one nearest to n/N of its way; of two, the one farther
/// from the start.
fn line_by_definition(start: [i64; 3], end: [i64; 3]) -> Vec<[i64; 3]> {
    let ways: [i64; 3] = std::array::from_fn(|a| (end[a] - start[a]).abs());
    let steps = ways.into_iter().fold(0, i64::max);
    let after = |n: i64, a: usize| {
        // All indices of the way are tried. Distances are in units of 1/N.
        let distance = |moved: i64| (moved * steps - n * ways[a]).abs();
        let moved = (0..=ways[a]).rev().min_by_key(|&moved| distance(moved)).unwrap();
        start[a] + (end[a] - start[a]).signum() * moved
    };
    (0..=steps).map(|n| std::array::from_fn(|a| after(n, a))).collect()
}

/// An image by the book: P of every drawn cell, and the counts.
#[derive(Default)]
struct ByHand {
    cells: BTreeMap<usize, f64>,
    used: u64,
    lines: u64,
    drawn: u64,
}

impl ByHand {
    fn line(&mut self, shot: &Shot, model: &SensorModel, walk: Walk, x: f64, y: f64, disparity: f32) {
        let spec = spec();
        let disparity = f64::from(disparity);
        let Some(measured) = model.measure(&RIG, (x, y), disparity) else { return };
        let depth = RIG.depth_m(disparity).min(MAX_DEPTH_M);
        let (camera, end) = (shot.camera(), shot.point(x, y, depth));
        let flats: Vec<usize> = match walk {
            Walk::Bresenham => line_by_definition(cell_at(camera.into()), cell_at(end.coords.into()))
                .into_iter()
                .filter_map(|cell| spec.flat(cell))
                .collect(),
            Walk::Exact => RayWalk::new(&spec, camera.into(), end.coords.into()).map(|w| w.0).collect(),
        };
        self.lines += 1;
        self.drawn += flats.len() as u64;
        for flat in flats {
            let l = (nalgebra::Vector3::from(spec.centre_m(flat)) - camera).norm();
            let p = match measured {
                Measurement::Free { min_probability, .. } => min_probability,
                obstacle => probability(obstacle.max_log_odds(l, CELL_M).clamp(-5.0, 5.0)),
            };
            let entry = self.cells.entry(flat).or_insert(p);
            *entry = entry.max(p);
        }
    }
}

fn by_hand(shot: &Shot, near: NearPixels, walk: Walk) -> ByHand {
    let (mut hand, model) = (ByHand::default(), model(near));
    for (x, y) in (0..RIG.height).flat_map(|y| (0..RIG.width).map(move |x| (x, y))) {
        if let Some(d) = shot.believed(x, y) {
            hand.line(shot, &model, walk, x as f64, y as f64, d);
        }
    }
    hand.used = hand.lines;
    hand
}

/// A pixel of layer i, straight from its definition (eqs 14 and 15).
fn layer_pixel(shot: &Shot, i: i32, x: usize, y: usize) -> Option<f32> {
    if i <= 0 {
        return shot.believed(x >> -i, y >> -i);
    }
    let of = |v: usize, size: usize| v << i..((v + 1) << i).min(size);
    let rows = of(y, RIG.height).flat_map(|y| of(x, RIG.width).map(move |x| (x, y)));
    rows.filter_map(|(x, y)| shot.believed(x, y)).reduce(f32::min)
}

/// How pyramids of lines are drawn.
#[derive(Clone, Copy)]
struct Layers {
    lowest: i32,
    finer: i32,
    /// 0.5 for the centres of blocks, 0 for their corners.
    off: f64,
}

/// The recursion of section VI-B.
fn descend(hand: &mut ByHand, shot: &Shot, layers: Layers, i: i32, x: usize, y: usize) {
    let Layers { lowest, finer, off } = layers;
    let size = |v: usize, i: i32| if i <= 0 { v << -i } else { v.div_ceil(1 << i) };
    if x >= size(RIG.width, i) || y >= size(RIG.height, i) {
        return;
    }
    let Some(d) = layer_pixel(shot, i, x, y) else { return };
    hand.used += 1;
    let depth = RIG.depth_m(f64::from(d)).min(MAX_DEPTH_M);
    if i == lowest || depth * f64::from(i + finer).exp2() / RIG.focal_px <= CELL_M {
        let at = |v: usize| (v as f64 + off) * f64::from(i).exp2() - off;
        hand.line(shot, &model(NearPixels::Limit), Walk::Bresenham, at(x), at(y), d);
    } else {
        for (x, y) in [(2 * x, 2 * y), (2 * x + 1, 2 * y), (2 * x, 2 * y + 1), (2 * x + 1, 2 * y + 1)] {
            descend(hand, shot, layers, i - 1, x, y);
        }
    }
}

fn check(hand: &ByHand, found: &LogOddsGrid, counters: &Counters) -> Result<(), TestCaseError> {
    for flat in 0..spec().cell_count() {
        match (found.log_odds(flat), hand.cells.get(&flat)) {
            (None, None) => {}
            (Some(l), Some(&p)) => {
                let off = (probability(f64::from(l)) - p).abs();
                prop_assert!(off < TABLE_ERROR + 2e-4, "cell {flat}: {l}, expected P {p}, off {off}");
            }
            (l, p) => prop_assert!(false, "cell {flat}: {l:?}, expected {p:?}"),
        }
    }
    prop_assert_eq!(counters.used_pixels, hand.used);
    prop_assert_eq!(counters.coordinate_transfers, hand.used + 1);
    prop_assert_eq!(counters.lines, hand.lines);
    prop_assert_eq!(counters.cells_drawn, hand.drawn);
    prop_assert_eq!(counters.different_cells, hand.cells.len() as u64);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn lines_are_drawn_by_the_book(shot in shot(), reject: bool, exact: bool) {
        let near = if reject { NearPixels::Reject } else { NearPixels::Limit };
        let walk = if exact { Walk::Exact } else { Walk::Bresenham };
        let settings = LineSettings { max_depth_m: MAX_DEPTH_M, near, walk, ..LineSettings::default() };
        let mut mapper = InverseModelMapper::line(spec(), settings).unwrap();
        let (found, counters) = shot.with(|view| mapper.single_image(view));
        check(&by_hand(&shot, near, walk), &found, &counters)?;
    }

    #[test]
    fn pyramids_of_lines_are_drawn_by_the_book(
        shot in shot(),
        lowest_layer in -3..=0_i32,
        finer_layers in 0..3_i32,
        centre: bool,
    ) {
        let (block_point, off) = if centre { (BlockPoint::Centre, 0.5) } else { (BlockPoint::Corner, 0.0) };
        let settings = LinePyramidSettings {
            max_depth_m: MAX_DEPTH_M,
            lowest_layer,
            block_point,
            finer_layers,
            ..LinePyramidSettings::default()
        };
        let mut mapper = InverseModelMapper::line_pyramid(spec(), settings).unwrap();
        let (found, counters) = shot.with(|view| mapper.single_image(view));
        let mut hand = ByHand::default();
        let layers = Layers { lowest: lowest_layer, finer: finer_layers, off };
        descend(&mut hand, &shot, layers, 5, 0, 0);
        check(&hand, &found, &counters)?;
    }
}

#[test]
fn the_layers_of_the_test_are_those_of_the_table() {
    let table = LayerTable::new(RIG.baseline_m, CELL_M);
    for (d, i) in [(1.0, -1), (2.6, 1), (60.0, 5)] {
        assert_eq!(table.layer(d), i);
    }
}
