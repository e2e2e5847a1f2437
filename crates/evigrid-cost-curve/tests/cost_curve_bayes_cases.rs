//! The mapper `cost-curve-bayes` in cases whose outcome is plain from geometry or from the costs.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::volumes::{scaled, uniform};
use common::{all_are_refused, spec, whole_curves};
use evigrid_core::{CostScale, NO_COST};
use evigrid_cost_curve::{CostCurveBayes, CostCurveBayesSettings};
use evigrid_grid::{GridSettings, GridSpec, Mapper, logit};

#[test]
fn a_view_without_costs_is_refused() {
    whole_curves::a_view_without_costs_is_refused::<CostCurveBayes>();
}

/// Windows of a single pixel, and costs that are stored divided.
#[test]
fn costs_of_any_scale_are_mapped() {
    for scale in [
        CostScale { window_pixels: 1.0, grey_levels: 1.0 },
        CostScale { window_pixels: 441.0, grey_levels: 2.0 },
    ] {
        let mut mapper = CostCurveBayes::new(spec(), CostCurveBayesSettings::default()).unwrap();
        mapper.integrate(&scaled(&[300, 0, 300], 0, [9, 9], scale).view()).unwrap();
        assert!(mapper.map().touched().count() > 0);
    }
}

/// Where nothing is measured, nothing is said: along a constant curve, and nearer than the nearest
/// hypothesis.
#[test]
fn curves_that_say_nothing_change_nothing() {
    let mut mapper = CostCurveBayes::new(spec(), CostCurveBayesSettings::default()).unwrap();
    for (curve, smallest) in [(&[500, 500, 500, 500][..], 0), (&[40][..], 1), (&[90, NO_COST, 90, 90][..], 1)]
    {
        mapper.integrate(&uniform(curve, smallest, [80, 80]).view()).unwrap();
        assert_eq!(mapper.map().touched().count(), 0, "{curve:?}");
    }
}

/// Cells far smaller than the steps of the disparity, up to a prior under which hardly a ray gets anywhere:
/// no number runs out.
#[test]
fn fine_cells_give_finite_evidence() {
    let fine = GridSettings { x_m: [0.0, 12.0], y_m: [-1.5, 1.5], z_m: [-1.5, 1.5], cell_size_m: 0.02 };
    let mut curve = [9000; 30];
    // b f = 7: disparity 3 stands for 2 m to 2.8 m, the nearest of 30 begins at 0.24 m.
    curve[3] = 0;
    for cell_prior in [0.05, 0.5] {
        let settings = CostCurveBayesSettings { cell_prior, ..CostCurveBayesSettings::default() };
        let mut mapper = CostCurveBayes::new(GridSpec::new(&fine).unwrap(), settings).unwrap();
        mapper.integrate(&uniform(&curve, 0, [80, 80]).view()).unwrap();
        let prior = logit(cell_prior) as f32;
        let (mut free, mut occupied) = (0, 0);
        for (cell, l) in mapper.map().touched() {
            assert!(l.is_finite());
            match mapper.map().spec().centre_m(cell)[0] {
                0.5..1.9 => free += usize::from(l < prior),
                2.2..2.7 => occupied += usize::from(l > prior),
                _ => {}
            }
        }
        assert!(cell_prior > 0.4 || (free > 100 && occupied > 50), "{free} {occupied}");
    }
}

/// A wall whose disparity all pixels agree on: its depths are more likely occupied than before, what is in
/// front less likely by the factor that an empty half of a cell leaves, and nothing is said of what is
/// behind.
#[test]
fn a_wall_by_geometry() {
    // b f = 7: disparity 1 stands for 4.67 m to 14 m, 2 for 2.8 m to 4.67 m, 3 for 2 m to 2.8 m.
    let shot = uniform(&[9000, 9000, 0, 9000], 0, [80, 80]);
    let settings = CostCurveBayesSettings { outlier_share: 1e-6, ..CostCurveBayesSettings::default() };
    let mut mapper = CostCurveBayes::new(spec(), settings).unwrap();
    mapper.integrate(&shot.view()).unwrap();
    let (prior, mut counts) = (logit(0.05) as f32, [0; 2]);
    for (cell, l) in mapper.map().touched() {
        let [low, high] = [0.0, 1.0].map(|f| (mapper.map().spec().voxel(cell)[0] as f64 + f) * 0.4 - 0.1);
        if high < 2.4 {
            // Nearer than the nearest hypothesis, some of it: little is known of these.
            assert!((l - prior).abs() < 0.6, "hardly measured to {high} m: {l}");
        } else if high < 2.8 {
            counts[0] += 1;
            // No less than what an empty half of a cell leaves; a little more, since an obstacle in the
            // unmeasured cells in front would hide this one.
            let evidence = l - prior;
            assert!((0.5_f32.ln()..-0.4).contains(&evidence), "free from {low} m: {evidence}");
        } else {
            assert!(low < 4.67, "hidden from {low} m: {l}");
            counts[1] += 1;
            assert!(l > prior, "occupied from {low} m: {l}");
        }
    }
    assert!(counts.iter().all(|n| *n > 5), "{counts:?}");
}

#[test]
fn impossible_settings_are_refused() {
    let base = CostCurveBayesSettings::default();
    all_are_refused::<CostCurveBayes>(&[
        CostCurveBayesSettings { cell_prior: 0.0, ..base },
        CostCurveBayesSettings { cell_prior: f64::NAN, ..base },
        CostCurveBayesSettings { outlier_share: 0.7, ..base },
        CostCurveBayesSettings { look_px: 256, ..base },
        CostCurveBayesSettings { max_depth_m: f64::INFINITY, ..base },
        CostCurveBayesSettings { log_odds_bounds: [0.0, 5.0], ..base },
        CostCurveBayesSettings { log_odds_bounds: [-5.0, f32::NAN], ..base },
        CostCurveBayesSettings { log_odds_bounds: [-1.0, 5.0], ..base },
    ]);
}
