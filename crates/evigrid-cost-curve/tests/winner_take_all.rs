//! The winner-take-all mapper against a slow, obvious twin: every pixel by itself, Elfes' closed form along
//! the cells of its ray, a map of maxima, a sum over frames.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;

use common::{RIG, Shot, accepted, all_are_refused, integrate, shot, spec};
use evigrid_core::{Disparity, Matches, Pose, level_camera};
use evigrid_cost_curve::{
    Deviation, PRIOR_TOLERANCE, WinnerTakeAll, WinnerTakeAllSettings, occupancy_from_weights,
};
use evigrid_grid::{Clamp, LogOddsGrid, RayWalk, logit, probability};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// Whether the last cell behind the measured one is worth drawing depends on the deviation, which the table
/// rounds: evidence this near [`PRIOR_TOLERANCE`] may be drawn or not. Log-odds.
const ROUNDED_TOLERANCE: f64 = 0.0025;
/// Error of a probability by rounding the deviation ([`evigrid_cost_curve::ProfileTable`]).
const ROUNDED_P: f64 = 0.006;

/// Elfes' profile for cells that lie `steps` in front of the measured one, from its definition: weights 2^-j
/// g_j over a ray that is long enough on both sides.
fn elfes(steps: i64, deviation: f64) -> f64 {
    let (front, behind) = (steps.max(0) as usize + 300, 200 + steps.min(0).unsigned_abs() as usize);
    let exponent = |k: usize| {
        let j = k as f64 - front as f64;
        -j * std::f64::consts::LN_2 - j * j / (2.0 * deviation * deviation)
    };
    let largest = (0..front + behind).map(exponent).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = (0..front + behind).map(|k| (exponent(k) - largest).exp()).collect();
    occupancy_from_weights(&weights)[(front as i64 - steps) as usize]
}

/// The evidence of one frame for each cell: the least and the most probability, which differ where evidence
/// may be drawn or not. The least is 0.5 where that is the only evidence, and so none at all may be drawn.
fn frame_by_hand(settings: &WinnerTakeAllSettings, shot: &Shot) -> BTreeMap<usize, Evidence> {
    let spec = spec();
    let mut best: BTreeMap<usize, Evidence> = BTreeMap::new();
    for pixel in (0..RIG.width * RIG.height).filter(|&p| accepted(settings, &shot.matches, p)) {
        let ray = RIG.ray((pixel % RIG.width) as f64, (pixel / RIG.width) as f64);
        // A point at infinity is as good as one a kilometre away.
        let disparity = f64::from(shot.matches.disparity.values()[pixel]);
        let depth = (RIG.baseline_m * RIG.focal_px / disparity).min(1000.0);
        let at = |z: f64| shot.pose * Point3::from(ray * z);
        let cells = |p: Point3<f64>| spec.to_cells(p.coords.into()).map(|v| v.floor() as i64);
        let direction = shot.pose.rotation * ray;
        let deviation = match settings.deviation {
            Deviation::Constant => settings.constant_variance_cells.sqrt(),
            Deviation::FollowsRange => {
                let dz = depth * depth / (RIG.baseline_m * RIG.focal_px) * settings.disparity_error_px;
                let along_ray = dz * ray.norm();
                let cells_per_metre = direction.normalize().abs().sum() / spec.cell_size_m();
                (along_ray * cells_per_metre).min(16.0)
            }
        };
        // The whole ray; what lies behind the measured cell counts as long as the evidence is worth drawing.
        let (measured, end) = (at(depth), at((depth + 40.0).min(settings.max_depth_m)));
        let (start, there) = (cells(Point3::from(shot.pose.translation.vector)), cells(measured));
        let from_start = |cell: [i64; 3]| -> i64 { (0..3).map(|a| (cell[a] - start[a]).abs()).sum() };
        for (cell, _) in RayWalk::new(&spec, shot.pose.translation.vector.into(), end.coords.into()) {
            let steps = from_start(there) - from_start(spec.voxel(cell).map(|v| v as i64));
            let p = if steps > 1500 { 0.0 } else { elfes(steps, deviation) };
            let beyond_tolerance = logit(p) - f64::from(PRIOR_TOLERANCE);
            if steps < 0 && beyond_tolerance < -ROUNDED_TOLERANCE {
                break;
            }
            let entry = best.entry(cell).or_default();
            entry.most = entry.most.max(p);
            if steps >= 0 || beyond_tolerance > ROUNDED_TOLERANCE {
                entry.least = Some(entry.least.map_or(p, |least| least.max(p)));
            }
        }
    }
    best
}

#[derive(Debug, Clone, Copy, Default)]
struct Evidence {
    least: Option<f64>,
    most: f64,
}

/// Checks one frame: the probability of every cell.
fn check_frame(settings: &WinnerTakeAllSettings, shot: &Shot) -> Result<LogOddsGrid, TestCaseError> {
    let by_hand = frame_by_hand(settings, shot);
    let mut mapper = WinnerTakeAll::new(spec(), *settings).unwrap();
    integrate(&mut mapper, shot);
    let bounds = [settings.min_probability, probability(f64::from(settings.clamp().max))];
    for cell in 0..spec().cell_count() {
        match (mapper.map().log_odds(cell), by_hand.get(&cell)) {
            (None, None | Some(Evidence { least: None, .. })) => {}
            (Some(l), Some(expected)) => {
                let within = |p: f64| p.clamp(bounds[0], bounds[1]);
                let (least, most) = (within(expected.least.unwrap_or(0.5)), within(expected.most));
                let found = probability(f64::from(l));
                prop_assert!(
                    found > least - ROUNDED_P && found < most + ROUNDED_P,
                    "cell {cell}: {found}, expected {least} to {most}"
                );
            }
            (found, expected) => prop_assert!(false, "cell {cell}: {found:?}, expected {expected:?}"),
        }
    }
    Ok(mapper.map().clone())
}

/// Checks every frame by itself, and all of them by the sum of their log-odds.
fn check(settings: WinnerTakeAllSettings, shots: &[Shot]) -> Result<(), TestCaseError> {
    let Clamp { min, max } = settings.clamp();
    let mut sum: BTreeMap<usize, f32> = BTreeMap::new();
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    for shot in shots {
        for (cell, l) in check_frame(&settings, shot)?.touched() {
            let entry = sum.entry(cell).or_insert(0.0);
            *entry = (*entry + l).clamp(min, max);
        }
        integrate(&mut mapper, shot);
    }
    for (cell, l) in mapper.map().touched() {
        prop_assert!((l - sum[&cell]).abs() < 1e-4, "cell {cell}: {l}, expected {}", sum[&cell]);
    }
    prop_assert_eq!(mapper.map().touched().count(), sum.len());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn equals_the_slow_twin(
        shots in prop::collection::vec(shot(), 1..4),
        follows_range: bool,
        left_right_check: bool,
        max_depth_m in 3.0..15.0_f64,
    ) {
        let deviation = if follows_range { Deviation::FollowsRange } else { Deviation::Constant };
        let base = WinnerTakeAllSettings::default();
        let settings = WinnerTakeAllSettings { deviation, left_right_check, max_depth_m, ..base };
        check(settings, &shots)?;
    }
}

/// A wall 6 m ahead fills the image: the cells of the wall are occupied, those in front of it free, those
/// behind it unknown.
#[test]
fn a_wall_by_geometry() {
    let n = RIG.width * RIG.height;
    // 6 m ahead is 6/0.4 = 15 cells: the middle of cell 15 is at 6.2 m.
    let d = RIG.disparity_px(6.2) as f32;
    let matches = Matches::from_disparity(Disparity::new(RIG.width, RIG.height, vec![d; n]).unwrap());
    let pose = Pose::from_parts(Vector3::zeros().into(), level_camera());
    let settings = WinnerTakeAllSettings { disparity_error_px: 0.005, ..WinnerTakeAllSettings::default() };
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    integrate(&mut mapper, &Shot { pose, matches });
    let mut walls = 0;
    for (cell, l) in mapper.map().touched() {
        let i = mapper.map().spec().voxel(cell)[0];
        assert!(i <= 15, "nothing is said of what lies behind a wall whose place is certain");
        assert_eq!(l > 0.0, i == 15, "cell {cell} in layer {i}: {l}");
        walls += usize::from(i == 15);
    }
    // The field of view at 6.2 m: 16/14 * 6.2 m wide, more than the grid's 6 m; 12/14 * 6.2 m high, more than
    // its 4 m.
    assert!(walls > 100, "{walls} of the 150 cells of the layer; pixels are wider than a cell there");
}

#[test]
fn log_odds_of_one_measurement_of_figure_1() {
    // Constant variance 5: P at the measured cell is 0.508414 (Fig. 1, from the closed form).
    let n = RIG.width * RIG.height;
    let mut disparity = vec![f32::NAN; n];
    // Column and row of the principal point do not hit a pixel: choose one and follow its ray.
    disparity[5 * RIG.width + 7] = RIG.disparity_px(8.1) as f32;
    let matches = Matches::from_disparity(Disparity::new(RIG.width, RIG.height, disparity).unwrap());
    let pose = Pose::from_parts(Vector3::zeros().into(), level_camera());
    let settings =
        WinnerTakeAllSettings { deviation: Deviation::Constant, ..WinnerTakeAllSettings::default() };
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    integrate(&mut mapper, &Shot { pose, matches });
    let cell =
        mapper.map().spec().cell_of((pose * Point3::from(RIG.ray(7.0, 5.0) * 8.1)).coords.into()).unwrap();
    let measured = mapper.map().log_odds(cell).unwrap();
    let expected = logit(0.508414);
    assert!((f64::from(measured) - expected).abs() < 2e-3, "{measured}, expected {expected}");
}

#[test]
fn impossible_settings_are_refused() {
    let base = WinnerTakeAllSettings::default();
    all_are_refused::<WinnerTakeAll>(&[
        WinnerTakeAllSettings { peak_ratio: 0.5, ..base },
        WinnerTakeAllSettings { peak_ratio: f64::NAN, ..base },
        WinnerTakeAllSettings { max_depth_m: 0.0, ..base },
        WinnerTakeAllSettings { disparity_error_px: -0.2, ..base },
        WinnerTakeAllSettings { constant_variance_cells: f64::INFINITY, ..base },
        WinnerTakeAllSettings { log_odds_bounds: [0.0, 5.0], ..base },
        WinnerTakeAllSettings { min_probability: 0.5, ..base },
    ]);
}
