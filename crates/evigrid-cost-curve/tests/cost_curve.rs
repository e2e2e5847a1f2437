//! The cost-curve mapper against a slow, obvious twin: every pixel by itself in double precision, the cells
//! of its ray from sorted face crossings, a map of maxima, a sum over frames.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;

use common::volumes::{SCALE, Shot, TOUCH_M, cells_of_ray, curve, shot, uniform};
use common::whole_curves::{self, ODD_CURVES};
use common::{RIG, all_are_refused, spec};
use evigrid_cost_curve::{
    CostCurve, CostCurveSettings, CostExponent, CostUnit, HypothesesToCells, free_space_costs,
    pixel_variance, whole_curve,
};
use evigrid_grid::{Clamp, Mapper, logit};
use proptest::prelude::*;

/// Error of the evidence of a cell by single precision and the polynomials, log-odds.
const TOLERANCE: f64 = 2e-4;
/// The least and the most that one frame may say of a cell, log-odds; they differ where rounding decides
/// whether a hypothesis touches the cell.
type Evidence = BTreeMap<usize, [f64; 2]>;

fn frame_by_hand(settings: &CostCurveSettings, shot: &Shot) -> Evidence {
    let winners = &shot.matches().disparity;
    let variance = settings.variance_factor * pixel_variance(shot.frame.left(), shot.frame.right(), winners);
    let exponent = CostExponent::new(settings.cost_unit, variance, SCALE.window_pixels);
    let free_costs = free_space_costs(shot.volume(), winners);
    let mut evidence = Evidence::new();
    for (x, y) in (0..RIG.height).flat_map(|y| (0..RIG.width).map(move |x| (x, y))) {
        let (disparities, costs) = curve(shot.volume(), x, y);
        let confirmed =
            shot.matches().left_right_difference_px[y * RIG.width + x] <= settings.left_right_tolerance_px;
        if costs.iter().all(|c| c.is_nan()) || (settings.left_right_check && !confirmed) {
            continue;
        }
        let mut p = whole_curve::likelihood(&costs, exponent);
        if let Some(costs_of) = free_costs.filter(|_| settings.free_space_model) {
            let free = whole_curve::free_space_likelihood(&costs, costs_of.mean, costs_of.variance);
            p = whole_curve::with_free_space(&p, &free);
        }
        let far = |d: usize| if d == 0 { f64::INFINITY } else { RIG.depth_m(d as f64 - 0.5) };
        let depths: Vec<_> = disparities.iter().map(|&d| (RIG.depth_m(d as f64 + 0.5), far(d))).collect();
        let end = depths.last().unwrap().1.min(settings.max_depth_m);
        let profile = match settings.hypotheses_to_cells {
            HypothesesToCells::PerDisparity => per_disparity(shot, x, y, &depths, &p, end),
            HypothesesToCells::SpreadOverCells => spread(shot, x, y, &depths, &p, end),
        };
        for (cell, [least, most]) in profile {
            let Some(flat) = spec().flat(cell) else { continue };
            let entry = evidence.entry(flat).or_insert([f64::NEG_INFINITY; 2]);
            let Clamp { min, max } = settings.evidence_bounds();
            let within = |p: f64| logit(p).clamp(f64::from(min), f64::from(max));
            *entry = [entry[0].max(within(least)), entry[1].max(within(most))];
        }
    }
    evidence
}

type Profile = Vec<([i64; 3], [f64; 2])>;

/// Reading 1: the largest P of the hypotheses whose depths the cell's part of the ray overlaps; 0 in front of
/// all.
fn per_disparity(shot: &Shot, x: usize, y: usize, depths: &[(f64, f64)], p: &[f64], end: f64) -> Profile {
    let occupied = whole_curve::profile(p);
    let cells = cells_of_ray(shot, x as f64, y as f64, end);
    let largest = |enter: f64, leave: f64, least_overlap: f64| {
        let met = depths
            .iter()
            .zip(&occupied)
            .filter(|((near, far), _)| far.min(leave) - near.max(enter) > least_overlap);
        met.map(|(_, p)| *p).fold(0.0, f64::max)
    };
    cells.iter().map(|&(cell, a, b)| (cell, [TOUCH_M, -TOUCH_M].map(|o| largest(a, b, o)))).collect()
}

/// Reading 2: each p in equal shares to the cells in its depths (at most 1 in all: with eq. 6, p does not sum
/// up to 1), then eqs 4 and 5 along the cells.
fn spread(shot: &Shot, x: usize, y: usize, depths: &[(f64, f64)], p: &[f64], end: f64) -> Profile {
    let farthest = depths.iter().map(|d| d.1).filter(|d| d.is_finite()).fold(end, f64::max);
    let cells = cells_of_ray(shot, x as f64, y as f64, farthest);
    let mut shares = vec![0.0; cells.len()];
    for (&(near, far), p) in depths.iter().zip(p).filter(|((_, far), _)| far.is_finite()) {
        let met: Vec<_> =
            (0..cells.len()).filter(|&c| far.min(cells[c].2) - near.max(cells[c].1) > 0.0).collect();
        met.iter().for_each(|&c| shares[c] = (shares[c] + p / met.len() as f64).min(1.0));
    }
    let drawn = cells.iter().zip(whole_curve::profile(&shares)).filter(|(cell, _)| cell.1 < end);
    drawn.map(|(&(cell, ..), p)| (cell, [p, p])).collect()
}

fn check(settings: CostCurveSettings, shots: &[Shot]) -> Result<(), TestCaseError> {
    let bounds = settings.clamp();
    let mut mapper = CostCurve::new(spec(), settings).unwrap();
    let mut sum: BTreeMap<usize, f32> = BTreeMap::new();
    for shot in shots {
        let by_hand = frame_by_hand(&settings, shot);
        let mut single = CostCurve::new(spec(), settings).unwrap();
        single.integrate(&shot.view()).unwrap();
        for cell in 0..spec().cell_count() {
            match (single.map().log_odds(cell), by_hand.get(&cell)) {
                (None, None) => {}
                (Some(found), Some([least, most])) => {
                    let l = f64::from(found);
                    prop_assert!(
                        l > least - TOLERANCE && l < most + TOLERANCE,
                        "cell {cell} {:?}: {found}, expected {least} to {most}",
                        spec().voxel(cell)
                    );
                    let entry = sum.entry(cell).or_insert(0.0);
                    *entry = (*entry + found).clamp(bounds.min, bounds.max);
                }
                (found, expected) => prop_assert!(false, "cell {cell}: {found:?}, expected {expected:?}"),
            }
        }
        mapper.integrate(&shot.view()).unwrap();
    }
    for (cell, l) in mapper.map().touched() {
        prop_assert_eq!(l.to_bits(), sum[&cell].to_bits());
    }
    prop_assert_eq!(mapper.map().touched().count(), sum.len());
    Ok(())
}

fn settings() -> impl Strategy<Value = CostCurveSettings> {
    let units =
        prop_oneof![Just(CostUnit::GreyLevels), Just(CostUnit::UnitIntensities), Just(CostUnit::Homogeneous)];
    let readings = prop_oneof![
        3 => Just(HypothesesToCells::PerDisparity),
        1 => Just(HypothesesToCells::SpreadOverCells),
    ];
    let bounds = prop_oneof![Just(0.0067), 0.01..0.45_f64];
    let rest = (0.02..2.0_f64, any::<[bool; 2]>(), 1.0..16.0_f64);
    (units, readings, bounds, rest).prop_map(
        |(cost_unit, hypotheses_to_cells, min_probability, (variance_factor, [free, check], max_depth_m))| {
            CostCurveSettings {
                cost_unit,
                variance_factor,
                free_space_model: free,
                hypotheses_to_cells,
                left_right_check: check,
                max_depth_m,
                min_probability,
                ..CostCurveSettings::default()
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn equals_the_slow_twin(settings in settings(), shots in prop::collection::vec(shot(), 1..3)) {
        check(settings, &shots)?;
    }

    #[test]
    fn any_number_of_threads_makes_the_same_map(
        settings in settings(),
        shots in prop::collection::vec(shot(), 1..3),
    ) {
        whole_curves::any_number_of_threads_makes_the_same_map::<CostCurve>(&settings, &shots);
    }
}

#[test]
fn bad_input_gives_a_map_all_the_same() {
    for (curve, smallest) in ODD_CURVES {
        // Identical images and constant ones: no variance.
        for images in [[80, 80], [0, 255]] {
            for hypotheses_to_cells in [HypothesesToCells::PerDisparity, HypothesesToCells::SpreadOverCells] {
                for (unit, free_space_model) in [(CostUnit::GreyLevels, true), (CostUnit::Homogeneous, false)]
                {
                    let settings = CostCurveSettings {
                        cost_unit: unit,
                        free_space_model,
                        hypotheses_to_cells,
                        ..CostCurveSettings::default()
                    };
                    check(settings, &[uniform(curve, smallest, images)]).unwrap();
                }
            }
        }
    }
    whole_curves::no_measurement_says_nothing::<CostCurve>();
}

#[test]
fn a_view_without_costs_is_refused() {
    whole_curves::a_view_without_costs_is_refused::<CostCurve>();
}

/// A wall whose disparity all pixels agree on: its depths are occupied, what is in front is free, what is
/// behind is touched and undecided.
#[test]
fn a_wall_by_geometry() {
    // b f = 7: disparity 1 stands for 4.67 m to 14 m, 2 for 2.8 m to 4.67 m, 3 for 2 m to 2.8 m.
    let shot = uniform(&[9000, 9000, 0, 9000], 0, [80, 80]);
    let mut mapper = CostCurve::new(spec(), CostCurveSettings::default()).unwrap();
    mapper.integrate(&shot.view()).unwrap();
    let mut counts = [0; 3];
    for (cell, l) in mapper.map().touched() {
        let [low, high] = [0.0, 1.0].map(|f| (mapper.map().spec().voxel(cell)[0] as f64 + f) * 0.4 - 0.1);
        if high < 2.8 {
            counts[0] += 1;
            assert!(l < -4.9, "free from {low} m: {l}");
        } else if low > 4.67 {
            counts[1] += 1;
            assert!(l.abs() < 1e-3, "hidden from {low} m: {l}");
        } else {
            counts[2] += 1;
            assert!(l > 4.9, "occupied from {low} m: {l}");
        }
    }
    assert!(counts.iter().all(|n| *n > 100), "{counts:?}");
}

#[test]
fn impossible_settings_are_refused() {
    let base = CostCurveSettings::default();
    all_are_refused::<CostCurve>(&[
        CostCurveSettings { variance_factor: 0.0, ..base },
        CostCurveSettings { variance_factor: f64::NAN, ..base },
        CostCurveSettings { max_depth_m: -1.0, ..base },
        CostCurveSettings { min_probability: 0.5, ..base },
        CostCurveSettings { min_probability: 0.0, ..base },
        CostCurveSettings { max_probability: 1.0, ..base },
        CostCurveSettings { log_odds_bounds: [0.0, 5.0], ..base },
        CostCurveSettings { log_odds_bounds: [-5.0, f32::INFINITY], ..base },
    ]);
}
