//! Which cells a camera could have seen, by hand.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{LaserScan, Pose, StereoRig, level_camera};
use evigrid_grid::{GridSettings, GridSpec};
use evigrid_truth::{LaserTruth, TruthSettings};
use nalgebra::Translation3;

/// 90 degrees wide and 53 high.
const RIG: StereoRig = StereoRig {
    width: 100,
    height: 50,
    focal_px: 50.0,
    centre_x_px: 49.5,
    centre_y_px: 24.5,
    baseline_m: 0.5,
};

#[test]
fn returns_that_project_into_the_image_between_the_depths_are_in_view() {
    let settings =
        GridSettings { x_m: [-10.0, 50.0], y_m: [-30.0, 30.0], z_m: [-3.0, 3.0], cell_size_m: 1.0 };
    let spec = GridSpec::new(&settings).unwrap();
    let mut truth = LaserTruth::new(spec, TruthSettings::default()).unwrap();
    // The camera stands at the map's origin and looks along x; the laser stands there too.
    let camera = Pose::from_parts(Translation3::identity(), level_camera());
    let points = [
        ([10.5, 0.5, 0.5], true),
        ([10.5, -9.5, 0.5], true),
        // Beside the image, above it, behind the camera, too near and too far.
        ([10.5, 11.5, 0.5], false),
        ([3.5, 0.5, 2.5], false),
        ([-8.5, 0.5, 0.5], false),
        ([0.9, 0.1, 0.1], false),
        ([40.5, 0.5, 0.5], false),
        ([39.5, 0.5, 0.5], true),
    ];
    let scan = LaserScan::new(points.iter().map(|(point, _)| *point).collect(), Pose::identity()).unwrap();
    truth.add_scan(&scan);
    truth.add_view(&scan, &RIG, &camera);
    for (point, expected) in points {
        let cell = spec.cell_of(point.map(f64::from)).unwrap();
        assert_eq!(truth.in_view()[cell], expected, "{point:?}");
    }
    assert_eq!(truth.in_view().iter().filter(|seen| **seen).count(), 3);
}

#[test]
fn impossible_depths_are_refused() {
    let spec = GridSpec::new(&GridSettings::default()).unwrap();
    for view_depth_m in [[5.0, 5.0], [-1.0, 4.0], [1.0, f64::NAN]] {
        let settings = TruthSettings { view_depth_m, ..TruthSettings::default() };
        let error = LaserTruth::new(spec, settings).unwrap_err().to_string();
        assert!(error.starts_with("truth.view_depth_m: expected two finite numbers"), "{error}");
    }
}
