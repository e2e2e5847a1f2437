//! The winner-take-all mapper against a slow, obvious twin: every pixel by itself, Elfes' closed form along the cells
//! of its ray, a map of maxima, a sum over frames.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;

use evigrid_core::{Disparity, GrayImage, Matches, Pose, StereoRig};
use evigrid_cost_curve::{
    Deviation, PRIOR_TOLERANCE, WinnerTakeAll, WinnerTakeAllSettings, occupancy_from_weights,
};
use evigrid_grid::{GridSettings, GridSpec, Mapper, RayWalk, View, logit, probability};
use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

const RIG: StereoRig =
    StereoRig { width: 16, height: 12, focal_px: 14.0, centre_x_px: 7.5, centre_y_px: 5.5, baseline_m: 0.5 };

fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 12.0], y_m: [-3.0, 3.0], z_m: [-2.0, 2.0], cell_size_m: 0.4 };
    GridSpec::new(&settings).unwrap()
}

fn level_camera() -> UnitQuaternion<f64> {
    let columns = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns))
}

#[derive(Debug, Clone)]
struct Shot {
    pose: Pose,
    matches: Matches,
}

/// Elfes' profile for cells that lie `steps` in front of the measured one, from its definition: weights 2^-j g_j
/// over a ray that is long enough on both sides.
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

/// The probability that each cell of one frame gets, before fusion.
fn frame_by_hand(settings: &WinnerTakeAllSettings, shot: &Shot) -> BTreeMap<usize, f64> {
    let spec = spec();
    let mut best: BTreeMap<usize, f64> = BTreeMap::new();
    for pixel in 0..RIG.width * RIG.height {
        let d = f64::from(shot.matches.disparity.values()[pixel]);
        let ratio = f64::from(shot.matches.peak_ratio[pixel]);
        if d.is_nan() || ratio < settings.peak_ratio {
            continue;
        }
        let difference = shot.matches.left_right_difference_px[pixel];
        if settings.left_right_check && difference > settings.left_right_tolerance_px {
            continue;
        }
        let ray = RIG.ray((pixel % RIG.width) as f64, (pixel / RIG.width) as f64);
        // A point at infinity is as good as one a kilometre away.
        let depth = (RIG.baseline_m * RIG.focal_px / d).min(1000.0);
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
        // The whole ray; what lies behind the measured cell counts from where the evidence is worth drawing.
        let (measured, end) = (at(depth), at((depth + 40.0).min(settings.max_depth_m)));
        let (start, there) = (cells(Point3::from(shot.pose.translation.vector)), cells(measured));
        let from_start = |cell: [i64; 3]| -> i64 { (0..3).map(|a| (cell[a] - start[a]).abs()).sum() };
        for (cell, _) in RayWalk::new(&spec, shot.pose.translation.vector.into(), end.coords.into()) {
            let steps = from_start(there) - from_start(spec.voxel(cell).map(|v| v as i64));
            let p = if steps > 1500 { 0.0 } else { elfes(steps, deviation) };
            if steps < 0 && logit(p) < f64::from(PRIOR_TOLERANCE) {
                break;
            }
            let entry = best.entry(cell).or_insert(0.0);
            *entry = entry.max(p);
        }
    }
    best
}

fn check(settings: WinnerTakeAllSettings, shots: &[Shot]) -> Result<(), TestCaseError> {
    let image = GrayImage::new(RIG.width, RIG.height, vec![0; RIG.width * RIG.height]).unwrap();
    let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
    let clamp = settings.clamp();
    let (low, high) = (f64::from(clamp.min), f64::from(clamp.max));
    let least = settings.min_probability;
    // Several frames are compared on the sum of log-odds; one frame on the probability of every cell.
    for shot in shots {
        let by_hand = frame_by_hand(&settings, shot);
        let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
        let view = View {
            rig: &RIG,
            map_from_left: &shot.pose,
            left: &image,
            matches: &shot.matches,
            volume: None,
        };
        mapper.integrate(&view);
        for cell in 0..spec().cell_count() {
            if let Some(l) = mapper.map().log_odds(cell) {
                let entry = sum.entry(cell).or_insert(0.0);
                *entry = (*entry + f64::from(l)).clamp(low, high);
            }
            match (mapper.map().log_odds(cell), by_hand.get(&cell)) {
                (None, None) => {}
                (Some(l), Some(&p)) => {
                    let p = p.clamp(least, probability(high));
                    let found = probability(f64::from(l));
                    prop_assert!((found - p).abs() < 0.0061, "cell {cell}: {found}, expected {p}");
                }
                // Whether the last cell behind is worth drawing depends on the deviation, which the table rounds.
                (Some(l), None) => prop_assert!((0.0..0.0125).contains(&l), "cell {cell}: {l}, expected nothing"),
                (None, Some(&p)) => {
                    prop_assert!((0.0..0.0125).contains(&logit(p)), "cell {cell}: nothing, expected {p}");
                }
            }
        }
    }
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    for shot in shots {
        let (map_from_left, matches) = (&shot.pose, &shot.matches);
        mapper.integrate(&View { rig: &RIG, map_from_left, left: &image, matches, volume: None });
    }
    for (cell, l) in mapper.map().touched() {
        prop_assert!((f64::from(l) - sum[&cell]).abs() < 1e-4, "cell {cell}: {l}, expected {}", sum[&cell]);
    }
    prop_assert_eq!(mapper.map().touched().count(), sum.len());
    Ok(())
}

fn shot() -> impl Strategy<Value = Shot> {
    let n = RIG.width * RIG.height;
    let disparity = prop_oneof![1 => Just(f32::NAN), 1 => Just(0.0_f32), 8 => 0.3..7.0_f32];
    let matches = (
        prop::collection::vec(disparity, n),
        prop::collection::vec(1.0..4.0_f32, n),
        prop::collection::vec(0..4_u16, n),
    );
    (matches, [-1.0..3.0_f64, -1.0..1.0, -0.5..0.5], [-0.2..0.2_f64, -0.2..0.2, -0.5..0.5]).prop_map(
        |((disparity, mut peak_ratio, left_right_difference_px), at, turn)| {
            for (ratio, d) in peak_ratio.iter_mut().zip(&disparity) {
                *ratio = if d.is_nan() { f32::NAN } else { *ratio };
            }
            let disparity = Disparity::new(RIG.width, RIG.height, disparity).unwrap();
            let turn = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
            let pose = Pose::from_parts(Vector3::from(at).into(), turn * level_camera());
            Shot { pose, matches: Matches { disparity, peak_ratio, left_right_difference_px } }
        },
    )
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
        let settings =
            WinnerTakeAllSettings { deviation, left_right_check, max_depth_m, ..WinnerTakeAllSettings::default() };
        check(settings, &shots)?;
    }
}

/// A wall 6 m ahead fills the image: the cells of the wall are occupied, those in front of it free, those behind it
/// unknown.
#[test]
fn a_wall_by_geometry() {
    let n = RIG.width * RIG.height;
    // 6 m ahead is 6/0.4 = 15 cells: the middle of cell 15 is at 6.2 m.
    let d = RIG.disparity_px(6.2) as f32;
    let matches = Matches::from_disparity(Disparity::new(RIG.width, RIG.height, vec![d; n]).unwrap());
    let pose = Pose::from_parts(Vector3::zeros().into(), level_camera());
    let image = GrayImage::new(RIG.width, RIG.height, vec![0; n]).unwrap();
    let settings = WinnerTakeAllSettings { disparity_error_px: 0.005, ..WinnerTakeAllSettings::default() };
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    mapper.integrate(&View { rig: &RIG, map_from_left: &pose, left: &image, matches: &matches, volume: None });
    let mut walls = 0;
    for (cell, l) in mapper.map().touched() {
        let i = mapper.map().spec().voxel(cell)[0];
        assert!(i <= 15, "nothing is said of what lies behind a wall whose place is certain");
        assert_eq!(l > 0.0, i == 15, "cell {cell} in layer {i}: {l}");
        walls += usize::from(i == 15);
    }
    // The field of view at 6.2 m: 16/14 * 6.2 m wide, more than the grid's 6 m; 12/14 * 6.2 m high, more than its 4 m.
    assert!(walls > 100, "{walls} of the 150 cells of the layer; pixels are wider than a cell there");
}

#[test]
fn log_odds_of_one_measurement_of_figure_1() {
    // Constant variance 5: P at the measured cell is 0.508414 (digest of Fig. 1).
    let n = RIG.width * RIG.height;
    let mut disparity = vec![f32::NAN; n];
    // Column and row of the principal point do not hit a pixel: choose one and follow its ray.
    disparity[5 * RIG.width + 7] = RIG.disparity_px(8.1) as f32;
    let matches = Matches::from_disparity(Disparity::new(RIG.width, RIG.height, disparity).unwrap());
    let pose = Pose::from_parts(Vector3::zeros().into(), level_camera());
    let image = GrayImage::new(RIG.width, RIG.height, vec![0; n]).unwrap();
    let settings =
        WinnerTakeAllSettings { deviation: Deviation::Constant, ..WinnerTakeAllSettings::default() };
    let mut mapper = WinnerTakeAll::new(spec(), settings).unwrap();
    mapper.integrate(&View { rig: &RIG, map_from_left: &pose, left: &image, matches: &matches, volume: None });
    let cell = mapper.map().spec().cell_of((pose * Point3::from(RIG.ray(7.0, 5.0) * 8.1)).coords.into()).unwrap();
    let measured = mapper.map().log_odds(cell).unwrap();
    let expected = logit(0.508414);
    assert!((f64::from(measured) - expected).abs() < 2e-3, "{measured}, expected {expected}");
}

#[test]
fn impossible_settings_are_refused() {
    let base = WinnerTakeAllSettings::default();
    for bad in [
        WinnerTakeAllSettings { peak_ratio: 0.5, ..base },
        WinnerTakeAllSettings { peak_ratio: f64::NAN, ..base },
        WinnerTakeAllSettings { max_depth_m: 0.0, ..base },
        WinnerTakeAllSettings { disparity_error_px: -0.2, ..base },
        WinnerTakeAllSettings { constant_variance_cells: f64::INFINITY, ..base },
        WinnerTakeAllSettings { log_odds_bounds: [0.0, 5.0], ..base },
        WinnerTakeAllSettings { min_probability: 0.5, ..base },
    ] {
        let error = WinnerTakeAll::new(spec(), bad).unwrap_err().to_string();
        assert!(error.starts_with("winner-take-all."), "{error}");
    }
}
