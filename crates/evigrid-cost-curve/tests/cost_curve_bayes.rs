//! The mapper `cost-curve-bayes` against a slow, obvious twin: every pixel by itself in double precision, the
//! cells of each look's ray from sorted face crossings, a map of maxima, a sum over frames.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;

use common::volumes::{Shot, cells_of_ray, curve, shot, uniform};
use common::whole_curves::{self, ODD_CURVES};
use common::{RIG, spec};
use evigrid_cost_curve::{
    CostCurveBayes, CostCurveBayesSettings, MEAN_DIFFERENCE_FLOOR, first_obstacle, mean_difference,
};
use evigrid_grid::{Mapper, logit};
use proptest::prelude::*;

/// Error of the evidence of a cell by single precision and the polynomials, log-odds.
const TOLERANCE: f64 = 5e-4;
/// Evidence that is as good as none is not drawn.
const LEAST: f64 = 0.01;

/// The scale b of the noise, from its definition.
fn scale_by_hand(settings: &CostCurveBayesSettings, shot: &Shot) -> f64 {
    let (left, right) = (shot.frame.left(), shot.frame.right());
    let mut differences = Vec::new();
    for pixel in 0..RIG.width * RIG.height {
        let (x, y) = (pixel % RIG.width, pixel / RIG.width);
        let winner = shot.matches().disparity.values()[pixel];
        if confirmed(settings, shot, pixel) && winner <= x as f32 {
            let facing = right.row(y)[x - winner as usize];
            differences.push((f64::from(left.row(y)[x]) - f64::from(facing)).abs());
        }
    }
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    if mean > MEAN_DIFFERENCE_FLOOR { mean } else { MEAN_DIFFERENCE_FLOOR }
}

fn confirmed(settings: &CostCurveBayesSettings, shot: &Shot, pixel: usize) -> bool {
    let matches = shot.matches();
    let checked = !settings.left_right_check
        || matches.left_right_difference_px[pixel] <= settings.left_right_tolerance_px;
    checked && !matches.disparity.values()[pixel].is_nan()
}

/// Likelihoods p(E | d) of every hypothesis of a pixel, nearest first; 1/n of those without a cost.
fn likelihoods(settings: &CostCurveBayesSettings, costs: &[f64], scale: f64) -> Vec<f64> {
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let p: Vec<f64> =
        costs.iter().map(|c| if c.is_nan() { 0.0 } else { (-(c - least) / scale).exp() }).collect();
    let (sum, o, n) = (p.iter().sum::<f64>(), settings.outlier_share, costs.len() as f64);
    let measured = costs.iter().filter(|c| !c.is_nan()).count() as f64;
    let of_measured = |p: f64| (1.0 - o) * measured / n * p / sum + o / n;
    p.iter().zip(costs).map(|(p, c)| if c.is_nan() { 1.0 / n } else { of_measured(*p) }).collect()
}

/// Evidence of one pixel for all cells of a ray: ln odds of P over those of the prior.
fn pixel_by_hand(
    settings: &CostCurveBayesSettings,
    g: &[f64],
    depths: &[(f64, f64)],
    cells: &[([i64; 3], f64, f64)],
    end: f64,
) -> Vec<f64> {
    let mean_over = |enter: f64, leave: f64| {
        let part = |(&(near, far), g): (&(f64, f64), &f64)| (far.min(leave) - near.max(enter)).max(0.0) * g;
        let measured: f64 = depths.iter().map(|d| (d.1.min(leave) - d.0.max(enter)).max(0.0)).sum();
        let nothing = (leave - enter - measured).max(0.0) / g.len() as f64;
        (depths.iter().zip(g).map(part).sum::<f64>() + nothing) / (leave - enter)
    };
    let means: Vec<f64> = cells.iter().map(|&(_, enter, leave)| mean_over(enter, leave)).collect();
    let beyond: Vec<f64> = depths.iter().zip(g).filter(|((_, far), _)| *far > end).map(|(_, g)| *g).collect();
    let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
    let beyond = if beyond.is_empty() { 1.0 / g.len() as f64 } else { mean(&beyond) };
    let stops = settings.cell_prior / 2.0;
    let p = first_obstacle::stopping(&means, beyond, stops);
    p.iter().map(|p| logit(*p).clamp(-40.0, 40.0) - logit(stops)).collect()
}

/// The least and the most that a frame may say of a cell: looks that say next to nothing of it do not count,
/// and rounding decides which those are.
fn frame_by_hand(settings: &CostCurveBayesSettings, shot: &Shot) -> BTreeMap<usize, [f64; 2]> {
    let scale = scale_by_hand(settings, shot);
    let mut evidence = BTreeMap::new();
    let edge = if settings.look_px > 0 { settings.look_px } else { 7 };
    for (x0, y0) in
        (0..RIG.height).step_by(edge).flat_map(|y| (0..RIG.width).step_by(edge).map(move |x| (x, y)))
    {
        let (x1, y1) = ((x0 + edge).min(RIG.width), (y0 + edge).min(RIG.height));
        let middle = |a: usize, b: usize| 0.5 * (a + b - 1) as f64;
        let far = |d: usize| if d == 0 { f64::INFINITY } else { RIG.depth_m(d as f64 - 0.5) };
        let disparities = curve(shot.volume(), 0, 0).0;
        let depths: Vec<_> = disparities.iter().map(|&d| (RIG.depth_m(d as f64 + 0.5), far(d))).collect();
        let end = settings.max_depth_m;
        let cells = cells_of_ray(shot, middle(x0, x1), middle(y0, y1), end);
        let mut all = Vec::new();
        for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
            if confirmed(settings, shot, y * RIG.width + x) {
                let g = likelihoods(settings, &curve(shot.volume(), x, y).1, scale);
                all.push(pixel_by_hand(settings, &g, &depths, &cells, end));
            }
        }
        if all.is_empty() {
            continue;
        }
        for (i, (cell, ..)) in cells.iter().enumerate() {
            let Some(flat) = spec().flat(*cell) else { continue };
            let mean = all.iter().map(|pixel| pixel[i]).sum::<f64>() / all.len() as f64;
            let log_odds = ((1.0 + mean.exp()) / 2.0).ln();
            let [least, most]: &mut [f64; 2] = evidence.entry(flat).or_insert([f64::NEG_INFINITY; 2]);
            if log_odds.abs() > LEAST - TOLERANCE {
                *most = most.max(log_odds);
            }
            if log_odds.abs() > LEAST + TOLERANCE {
                *least = least.max(log_odds);
            }
        }
    }
    evidence
}

fn check(settings: CostCurveBayesSettings, shots: &[Shot]) -> Result<(), TestCaseError> {
    let (prior, bounds) = (logit(settings.cell_prior) as f32, settings.clamp());
    let mut mapper = CostCurveBayes::new(spec(), settings).unwrap();
    let mut sum: BTreeMap<usize, f32> = BTreeMap::new();
    for shot in shots {
        let by_hand = frame_by_hand(&settings, shot);
        // Wide bounds, to see the evidence itself.
        let wide = CostCurveBayesSettings { log_odds_bounds: [-40.0, 40.0], ..settings };
        let mut single = CostCurveBayes::new(spec(), wide).unwrap();
        single.integrate(&shot.view()).unwrap();
        for cell in 0..spec().cell_count() {
            let [least, most] = by_hand.get(&cell).copied().unwrap_or([f64::NEG_INFINITY; 2]);
            match single.map().log_odds(cell) {
                None => {
                    prop_assert!(least == f64::NEG_INFINITY, "cell {}: nothing, expected {}", cell, least)
                }
                Some(found) => {
                    let l = f64::from(found) - logit(settings.cell_prior);
                    let slack = TOLERANCE * (1.0 + l.abs());
                    let within = l > least - slack && l < most + slack;
                    prop_assert!(
                        within,
                        "cell {cell} {:?}: {l}, expected {least} to {most}",
                        spec().voxel(cell)
                    );
                }
            }
        }
        mapper.integrate(&shot.view()).unwrap();
        for (cell, l) in single.map().touched() {
            let entry = sum.entry(cell).or_insert(prior);
            *entry = (*entry + (l - prior)).clamp(bounds.min, bounds.max);
        }
    }
    for (cell, l) in mapper.map().touched() {
        prop_assert!((l - sum[&cell]).abs() < 1e-4, "cell {cell}: {l}, expected {}", sum[&cell]);
    }
    prop_assert_eq!(mapper.map().touched().count(), sum.len());
    Ok(())
}

fn settings() -> impl Strategy<Value = CostCurveBayesSettings> {
    (0.01..0.3_f64, 0.001..0.3_f64, 0..6_usize, any::<bool>(), 0..3_u16, 1.0..16.0_f64).prop_map(
        |(cell_prior, outlier_share, look_px, left_right_check, left_right_tolerance_px, max_depth_m)| {
            CostCurveBayesSettings {
                look_px,
                cell_prior,
                outlier_share,
                left_right_check,
                left_right_tolerance_px,
                max_depth_m,
                ..CostCurveBayesSettings::default()
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn equals_the_slow_twin(settings in settings(), shots in prop::collection::vec(shot(), 1..3)) {
        check(settings, &shots)?;
    }

    #[test]
    fn the_scale_is_the_mean_difference(settings in settings(), shot in shot()) {
        let left_right_px = settings.left_right_check.then_some(settings.left_right_tolerance_px);
        let (left, right) = (shot.frame.left(), shot.frame.right());
        let found = mean_difference(left, right, shot.matches(), left_right_px);
        prop_assert!((found - scale_by_hand(&settings, &shot)).abs() < 1e-9);
    }

    #[test]
    fn any_number_of_threads_makes_the_same_map(
        settings in settings(),
        shots in prop::collection::vec(shot(), 1..3),
    ) {
        whole_curves::any_number_of_threads_makes_the_same_map::<CostCurveBayes>(&settings, &shots);
    }
}

#[test]
fn bad_input_gives_a_map_all_the_same() {
    for (curve, smallest) in ODD_CURVES {
        // Identical images and constant ones.
        for images in [[80, 80], [0, 255]] {
            check(CostCurveBayesSettings::default(), &[uniform(curve, smallest, images)]).unwrap();
        }
    }
    whole_curves::no_measurement_says_nothing::<CostCurveBayes>();
}
