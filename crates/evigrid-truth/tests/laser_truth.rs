//! The laser truth against a slow, obvious twin and against geometry.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;

use evigrid_core::{LaserScan, Pose};
use evigrid_grid::{GridSettings, GridSpec};
use evigrid_truth::{LaserTruth, TruthSettings};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 6.0], y_m: [-2.0, 2.0], z_m: [-1.0, 1.0], cell_size_m: 0.5 };
    GridSpec::new(&settings).unwrap()
}

/// All cells that the segment spends some length in, by asking every cell of the grid.
fn crossed(spec: &GridSpec, from: Point3<f64>, to: Point3<f64>) -> Vec<usize> {
    let c = spec.cell_size_m();
    (0..spec.cell_count())
        .filter(|&flat| {
            let centre = spec.centre_m(flat);
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for a in 0..3 {
                let d = to[a] - from[a];
                let (t0, t1) = ((centre[a] - c / 2.0 - from[a]) / d, (centre[a] + c / 2.0 - from[a]) / d);
                enter = enter.max(t0.min(t1));
                leave = leave.min(t0.max(t1));
            }
            leave - enter > 1e-9
        })
        .collect()
}

/// The protocol word for word.
fn twin(settings: &TruthSettings, scans: &[LaserScan]) -> (Vec<bool>, Vec<f32>) {
    let spec = spec();
    let mut log_odds = vec![f32::NAN; spec.cell_count()];
    let mut occupied = vec![false; spec.cell_count()];
    for scan in scans {
        let mut marks = BTreeMap::new();
        for (index, point) in scan.points().iter().enumerate() {
            let own = scan.origins().map_or([0.0; 3], |origins| origins[index]);
            let origin = scan.map_from_laser() * Point3::from(own.map(f64::from));
            let end = scan.map_from_laser() * Point3::from(point.map(f64::from));
            let range = (end - origin).norm();
            if range < settings.min_range_m {
                continue;
            }
            let reached = range <= settings.max_range_m;
            let end = if reached { end } else { origin + (end - origin) * (settings.max_range_m / range) };
            let last = spec.cell_of(end.coords.into());
            for cell in crossed(&spec, origin, end) {
                let hit = reached && Some(cell) == last;
                *marks.entry(cell).or_insert(false) |= hit;
            }
        }
        for (cell, hit) in marks {
            let before = if log_odds[cell].is_nan() { 0.0 } else { log_odds[cell] };
            let evidence = if hit { settings.hit_log_odds } else { settings.miss_log_odds };
            log_odds[cell] =
                (before + evidence).clamp(settings.log_odds_bounds[0], settings.log_odds_bounds[1]);
            occupied[cell] |= log_odds[cell] > settings.occupied_above;
        }
    }
    (occupied, log_odds)
}

fn scan() -> impl Strategy<Value = LaserScan> {
    let coordinate = || -7.0..7.0_f32;
    let points = prop::collection::vec([coordinate(), coordinate(), -2.0..2.0_f32], 1..30);
    let place = [-1.0..6.0_f64, -2.0..2.0, -1.0..1.0];
    (points, place, -3.0..3.0_f64, any::<bool>()).prop_map(|(points, at, yaw, moves)| {
        let rotation = UnitQuaternion::from_euler_angles(0.1, -0.2, yaw);
        let origins = (0..points.len()).map(|i| [0.1, -0.05, 0.02].map(|v| v * i as f32)).collect();
        let scan = LaserScan::new(points, Pose::from_parts(Vector3::from(at).into(), rotation)).unwrap();
        if moves { scan.with_origins(origins).unwrap() } else { scan }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn equals_the_slow_twin(scans in prop::collection::vec(scan(), 1..5)) {
        let settings = TruthSettings { max_range_m: 5.0, ..TruthSettings::default() };
        let mut truth = LaserTruth::new(spec(), settings).unwrap();
        scans.iter().for_each(|scan| truth.add_scan(scan));
        let (occupied, log_odds) = twin(&settings, &scans);
        prop_assert_eq!(truth.occupied(), &occupied[..]);
        let observed: Vec<_> = log_odds.iter().map(|l| !l.is_nan()).collect();
        prop_assert_eq!(truth.observed(), &observed[..]);
        for (cell, expected) in log_odds.iter().enumerate() {
            let found = truth.log_odds().values()[cell];
            let are_equal = found == *expected || found.is_nan() && expected.is_nan();
            prop_assert!(are_equal, "{cell}: {found} {expected}");
        }
    }
}

#[test]
fn a_cell_that_was_once_occupied_stays_so() {
    let mut truth = LaserTruth::new(spec(), TruthSettings::default()).unwrap();
    let beam = |range: f32| LaserScan::new(vec![[range, 0.1, 0.1]], Pose::identity()).unwrap();
    truth.add_scan(&beam(3.1));
    let cell = spec().cell_of([3.1, 0.1, 0.1]).unwrap();
    assert!(truth.occupied()[cell] && truth.observed()[cell]);
    (0..9).for_each(|_| truth.add_scan(&beam(5.2)));
    assert_eq!(truth.log_odds().values()[cell], -2.0);
    assert!(truth.occupied()[cell], "a moving obstacle is no mistake of the map");
    assert_eq!(truth.occupied().iter().filter(|o| **o).count(), 2);
    assert_eq!(truth.scans(), 10);
}

#[test]
fn rays_that_are_too_short_or_too_long() {
    let mut truth =
        LaserTruth::new(spec(), TruthSettings { max_range_m: 4.0, ..Default::default() }).unwrap();
    truth.add_scan(&LaserScan::new(vec![[0.9, 0.1, 0.1]], Pose::identity()).unwrap());
    assert_eq!(truth.log_odds().touched().count(), 0);
    truth.add_scan(&LaserScan::new(vec![[50.0, 0.1, 0.1]], Pose::identity()).unwrap());
    assert!(truth.occupied().iter().all(|o| !o));
    assert_eq!(truth.log_odds().touched().count(), 8, "4 m of free space in cells of 0.5 m");
}

#[test]
fn impossible_settings_are_refused() {
    let base = TruthSettings::default();
    for bad in [
        TruthSettings { max_range_m: 0.5, ..base },
        TruthSettings { min_range_m: -1.0, ..base },
        TruthSettings { hit_log_odds: 0.0, ..base },
        TruthSettings { miss_log_odds: f32::NAN, ..base },
        TruthSettings { log_odds_bounds: [1.0, 2.0], ..base },
        TruthSettings { occupied_above: 9.0, ..base },
    ] {
        let error = LaserTruth::new(spec(), bad).unwrap_err().to_string();
        assert!(error.starts_with("truth."), "{error}");
    }
}
