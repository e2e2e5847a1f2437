//! Blur (eq. 17) against a brute force over every cell and every neighbour.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{N, Shot, shot};
use evigrid_core::{Pose, level_camera};
use evigrid_grid::{GridSettings, GridSpec, LogOddsGrid};
use evigrid_inverse_model::{BlurKind, InverseModelMapper, LineSettings, PoseDeviation, blurred};
use nalgebra::Vector3;
use proptest::prelude::*;

fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 6.0], y_m: [-2.0, 2.0], z_m: [-1.0, 1.0], cell_size_m: 0.25 };
    GridSpec::new(&settings).unwrap()
}

/// Each cell by itself: the mean over its own cube, weighted by its own Gaussian.
fn by_hand(grid: &LogOddsGrid, vehicle_m: [f64; 3], deviation: &PoseDeviation) -> Vec<Option<f64>> {
    let spec = grid.spec();
    let one = |flat: usize| {
        let centre = spec.centre_m(flat);
        let r = (0..3).map(|a| (centre[a] - vehicle_m[a]).powi(2)).sum::<f64>().sqrt();
        let deviation_m = match deviation.kind {
            BlurKind::None => 0.0,
            BlurKind::Constant => deviation.translation_m,
            BlurKind::Distance => (deviation.translation_m.powi(2) + (r * deviation.angle).powi(2)).sqrt(),
        };
        let sigma = (deviation_m / spec.cell_size_m()).round();
        let reach = 3 * sigma as i64;
        let (mut sum, mut total, mut any) = (0.0, 0.0, false);
        let here = spec.voxel(flat).map(|v| v as i64);
        for (di, dj, dk) in (-reach..=reach)
            .flat_map(|i| (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |k| (i, j, k))))
        {
            let square = (di * di + dj * dj + dk * dk) as f64;
            let weight = if sigma == 0.0 { 1.0 } else { (-0.5 * square / (sigma * sigma)).exp() };
            total += weight;
            let there = spec.flat([here[0] + di, here[1] + dj, here[2] + dk]);
            if let Some(l) = there.and_then(|there| grid.log_odds(there)) {
                sum += weight * f64::from(l);
                any = true;
            }
        }
        any.then_some(sum / total)
    };
    (0..spec.cell_count()).map(one).collect()
}

fn random_grid(seed: u64, share: u64) -> LogOddsGrid {
    let mut grid = LogOddsGrid::unknown(spec());
    for (n, value) in grid.values_mut().iter_mut().enumerate() {
        let h = (n as u64 + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        if h % 100 < share {
            *value = (h % 77) as f32 / 11.0 - 3.5;
        }
    }
    grid
}

fn check(grid: &LogOddsGrid, vehicle_m: [f64; 3], deviation: PoseDeviation) -> Result<(), TestCaseError> {
    let found = blurred(grid, vehicle_m, &deviation);
    for (flat, expected) in by_hand(grid, vehicle_m, &deviation).into_iter().enumerate() {
        match (found.log_odds(flat), expected) {
            (None, None) => {}
            (Some(l), Some(e)) => prop_assert!((f64::from(l) - e).abs() < 1e-5, "cell {flat}: {l}, {e}"),
            other => prop_assert!(false, "cell {flat}: {other:?}"),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn each_cell_has_its_own_kernel(
        seed: u64,
        share in 0..30_u64,
        translation_m in 0.0..0.4_f64,
        angle in 0.0..0.12_f64,
        vehicle in [-1.0..3.0_f64, -1.0..1.0, -1.0..1.0],
    ) {
        let grid = random_grid(seed, share);
        for kind in [BlurKind::None, BlurKind::Constant, BlurKind::Distance] {
            check(&grid, vehicle, PoseDeviation { kind, translation_m, angle })?;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn a_blurred_image_is_what_is_fused(
        shot in shot(),
        blur_translation_m in 0.0..0.5_f64,
        blur_angle_deg in 0.0..8.0_f64,
    ) {
        let settings = LineSettings {
            blur: BlurKind::Distance,
            blur_translation_m,
            blur_angle_deg,
            max_depth_m: 5.0,
            ..LineSettings::default()
        };
        let mut mapper = InverseModelMapper::line(spec(), settings).unwrap();
        let (image, counters) = shot.with(|view| mapper.single_image(view));
        shot.integrate(&mut mapper);
        prop_assert_eq!(mapper.counters(), &counters);
        for flat in 0..spec().cell_count() {
            match (image.log_odds(flat), mapper.map().log_odds(flat)) {
                (None, None) => {}
                (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-5, "cell {flat}: {a}, {b}"),
                other => prop_assert!(false, "cell {flat}: {other:?}"),
            }
        }
    }
}

#[test]
fn mass_is_preserved_away_from_the_borders() {
    let mut grid = LogOddsGrid::unknown(spec());
    let middle = spec().flat([12, 8, 4]).unwrap();
    grid.values_mut()[middle] = 2.5;
    let deviation = PoseDeviation { kind: BlurKind::Constant, translation_m: 0.25, angle: 0.0 };
    let found = blurred(&grid, [0.0; 3], &deviation);
    let mass: f32 = found.touched().map(|(_, l)| l).sum();
    assert!((mass - 2.5).abs() < 1e-5, "{mass}");
    assert_eq!(found.touched().count(), 7 * 7 * 7);
}

#[test]
fn kernels_grow_with_the_distance() {
    // Eq. 17 at 0.2 m and 2 degrees in cells of 0.25 m: sqrt(0.04 + (0.0349 r)^2) / 0.25, rounded.
    let angle = 2.0_f64.to_radians();
    let deviation = PoseDeviation { kind: BlurKind::Distance, translation_m: 0.2, angle };
    let sizes = [0.0, 5.0, 10.0, 20.0, 40.0, 1e9].map(|r| deviation.cells(r, 0.25));
    assert_eq!(sizes, [1, 1, 2, 3, 6, 16]);
    let none = PoseDeviation { kind: BlurKind::None, ..deviation };
    assert_eq!(none.cells(40.0, 0.25), 0);
}

#[test]
fn blurring_nothing_is_nothing() {
    let pose = Pose::from_parts(Vector3::zeros().into(), level_camera());
    let shot = Shot::of(pose, vec![f32::NAN; N]);
    let settings = LineSettings { blur: BlurKind::Constant, ..LineSettings::default() };
    let mut mapper = InverseModelMapper::line(spec(), settings).unwrap();
    shot.integrate(&mut mapper);
    assert_eq!(mapper.map().touched().count(), 0);
}
