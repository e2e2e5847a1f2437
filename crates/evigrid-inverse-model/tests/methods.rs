//! The common behaviour of all methods: fusion, filters, threads, empty and hostile input.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{N, RIG, Shot, all, bits, shot, spec, wall};
use evigrid_core::{CoreError, Disparity, Frame, GrayImage, Pose, StereoRig, level_camera};
use evigrid_grid::{GridSettings, GridSpec, logit};
use evigrid_inverse_model::{InverseModelMapper, LineSettings, NearPixels, SouzaSettings};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

/// A grid of so many cells that several tasks fuse them.
fn many_cells() -> GridSpec {
    let settings = GridSettings { x_m: [-1.0, 11.0], y_m: [-3.0, 3.0], z_m: [-2.0, 2.0], cell_size_m: 0.15 };
    GridSpec::new(&settings).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]
    #[test]
    fn images_add_up_and_threads_change_nothing(shots in prop::collection::vec(shot(), 1..4)) {
        let pools = [1, 2, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
        // A single image knows nothing of the way to it.
        let base = SouzaSettings::default();
        let still = SouzaSettings { motion_error_per_m: 0.0, motion_error_m: 0.1, ..base };
        let all = || {
            let [line, line_pyramid, ray, ray_pyramid, _] = all(many_cells());
            [line, line_pyramid, ray, ray_pyramid, InverseModelMapper::souza(many_cells(), still).unwrap()]
        };
        for method in 0..5 {
            let mut sum = vec![f32::NAN; many_cells().cell_count()];
            let mut single = all();
            for shot in &shots {
                let (image, _) = shot.with(|view| single[method].single_image(view));
                for (cell, l) in image.touched() {
                    let before = if sum[cell].is_nan() { 0.0 } else { sum[cell] };
                    sum[cell] = (before + l).clamp(-5.0, 5.0);
                }
            }
            for pool in &pools {
                let mut mappers = all();
                for shot in &shots {
                    pool.install(|| shot.integrate(&mut mappers[method]));
                }
                let found = mappers[method].map();
                let same = bits(found) == sum.iter().map(|l| l.to_bits()).collect::<Vec<_>>();
                prop_assert!(same, "method {}", method);
            }
        }
    }
}

/// A wall fills the image: what lies on the camera's axis is free up to it, occupied there, and behind it no
/// method says that it is free.
#[test]
fn a_wall_by_geometry() {
    for (method, mut mapper) in all(spec()).into_iter().enumerate() {
        wall(6.1).integrate(&mut mapper);
        for i in 3..spec().shape()[0] {
            let cell = spec().flat([i as i64, 7, 5]).unwrap();
            let (x, l) = (spec().centre_m(cell)[0] - 0.1, mapper.map().log_odds(cell));
            match x {
                ..4.4 => assert!(l.unwrap() < -0.05, "method {method}, {x} m: {l:?}"),
                5.9..6.3 => assert!(l.unwrap() > 0.07, "method {method}, {x} m: {l:?}"),
                6.3.. => assert!(l.is_none_or(|l| l > 0.0), "method {method}, {x} m: {l:?}"),
                _ => {}
            }
        }
    }
}

#[test]
fn infinitely_far_is_free_up_to_the_range() {
    let pose = wall(1.0).pose;
    for (method, mut mapper) in all(spec()).into_iter().enumerate() {
        Shot::of(pose, vec![0.0; N]).integrate(&mut mapper);
        assert!(mapper.map().touched().count() > 1000, "method {method}");
        for (_, l) in mapper.map().touched() {
            assert!((f64::from(l) - logit(0.35)).abs() < 1e-6);
        }
        let axis = spec().flat([29, 7, 5]).unwrap();
        assert!(mapper.map().log_odds(axis).is_some(), "method {method}");
    }
}

#[test]
fn filters_drop_matches() {
    for mut mapper in all(spec()) {
        let mut shot = wall(6.0);
        shot.matches.peak_ratio = vec![1.49; N];
        shot.integrate(&mut mapper);
        shot.matches.peak_ratio = vec![2.0; N];
        shot.matches.left_right_difference_px = vec![2; N];
        shot.integrate(&mut mapper);
        assert_eq!(mapper.map().touched().count(), 0);
        shot.matches.left_right_difference_px = vec![1; N];
        shot.integrate(&mut mapper);
        assert!(mapper.map().touched().count() > 0);
    }
}

/// k = 0.1 with this rig: A reaches 1/2 at 1.2 m.
#[test]
fn pixels_too_near_for_k_are_limited_or_dropped() {
    let one_metre = wall(1.0);
    let build = |near| InverseModelMapper::line(spec(), LineSettings { near, ..LineSettings::default() });
    let mut limit = build(NearPixels::Limit).unwrap();
    one_metre.integrate(&mut limit);
    let largest = limit.map().touched().map(|(_, l)| l).fold(0.0, f32::max);
    assert!((largest - 5.0).abs() < 1e-3, "{largest}");
    let mut reject = build(NearPixels::Reject).unwrap();
    one_metre.integrate(&mut reject);
    assert_eq!(reject.map().touched().count(), 0);
    wall(1.3).integrate(&mut reject);
    assert!(reject.map().touched().count() > 0);
}

#[test]
fn images_that_say_nothing_leave_the_map_unknown() {
    let far = [[1e3, 0.0, 0.0], [0.0, -50.0, 0.0], [1e15, -1e15, 1e15], [f64::MAX, 0.0, 0.0]];
    for mut mapper in all(spec()) {
        Shot::of(wall(1.0).pose, vec![f32::NAN; N]).integrate(&mut mapper);
        for at in far {
            // Looking away from the grid, or from too far.
            let pose = Pose::from_parts(Vector3::from(at).into(), level_camera());
            for d in [0.0, 1e-30, 5.0, f32::MAX] {
                Shot::of(pose, vec![d; N]).integrate(&mut mapper);
            }
        }
        assert_eq!(mapper.map().touched().count(), 0);
        // A camera behind the grid that looks into it.
        let pose = Pose::from_parts(Vector3::new(-4.0, 0.1, 0.1).into(), level_camera());
        Shot::of(pose, vec![0.0; N]).integrate(&mut mapper);
        assert!(mapper.map().touched().count() > 0);
    }
}

#[test]
fn impossible_images_are_refused_before_any_method() {
    for bad in [f32::INFINITY, f32::NEG_INFINITY, -1.0] {
        let error = Disparity::new(1, 1, vec![bad]).unwrap_err().to_string();
        assert!(error.contains("finite number from 0"), "{error}");
    }
    for (focal_px, baseline_m) in [(0.0, 0.3), (f64::NAN, 0.3), (700.0, 0.0), (700.0, -0.3)] {
        let rig = StereoRig { focal_px, baseline_m, ..RIG };
        assert!(rig.checked().is_err());
    }
    let tiny = GridSettings { cell_size_m: 1e-4, ..GridSettings::default() };
    let error = GridSpec::new(&tiny).unwrap_err().to_string();
    assert!(error.contains("GiB"), "{error}");
}

#[test]
fn eps_grows_with_the_way() {
    let settings = SouzaSettings {
        motion_error_m: 0.1,
        motion_error_per_m: 0.2,
        max_depth_m: 10.0,
        ..SouzaSettings::default()
    };
    let mut mapper = InverseModelMapper::souza(spec(), settings).unwrap();
    let mut shot = wall(6.0);
    let mut highest = || {
        let (image, _) = shot.with(|view| mapper.single_image(view));
        shot.integrate(&mut mapper);
        // 2 m on, by a turned camera: the way counts, not the place.
        shot.pose.translation.vector += Vector3::new(2.0, 0.0, 0.0);
        shot.pose.rotation = UnitQuaternion::from_euler_angles(0.0, 0.0, 1e-3) * shot.pose.rotation;
        image.touched().map(|(_, l)| l).fold(0.0, f32::max)
    };
    // A = k / (dl sqrt(2 pi)) on the ray nearest to the axis, dz = 36/9*0.5 + eps.
    for eps in [0.1, 0.5] {
        let deviation = 36.0 / (RIG.baseline_m * RIG.focal_px) * 0.5 + eps;
        let peak = logit(0.5 + 0.1 / (deviation * std::f64::consts::TAU.sqrt()));
        let found = f64::from(highest());
        assert!((found - peak).abs() < 2e-3, "eps {eps}: {found}, expected {peak}");
    }
}

#[test]
fn souza_without_motion_is_line_drawing_and_a_slice_is_a_part_of_it() {
    let still = SouzaSettings { motion_error_per_m: 0.0, ..SouzaSettings::default() };
    let mut line = InverseModelMapper::line(spec(), LineSettings::default()).unwrap();
    let mut souza = InverseModelMapper::souza(spec(), still).unwrap();
    let mut slice = InverseModelMapper::souza(spec(), SouzaSettings { slice: true, ..still }).unwrap();
    for mapper in [&mut line, &mut souza, &mut slice] {
        wall(6.0).integrate(mapper);
    }
    assert_eq!(bits(line.map()), bits(souza.map()));
    // The optical centre is at 0.1 m, in level 5 of cells that begin at -2 m.
    assert!(slice.map().touched().count() > 20);
    for (cell, l) in line.map().touched() {
        let expected = (spec().voxel(cell)[2] == 5).then_some(l);
        assert_eq!(slice.map().log_odds(cell), expected);
    }
}

/// Mappers need not ask whether a pose is finite: no view has another.
#[test]
fn poses_that_are_none_are_refused_before_any_method() {
    let grey = || GrayImage::new(RIG.width, RIG.height, vec![0; N]).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        let nowhere = Pose::from_parts(Vector3::new(bad, 0.0, 0.0).into(), level_camera());
        let error = Frame::new(0, 0, RIG, grey(), grey(), nowhere, None).unwrap_err();
        assert!(matches!(error, CoreError::Domain { what: "pose", .. }), "{error}");
    }
}
