//! Random frames of a small rig over a small grid.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

pub mod volumes;
pub mod whole_curves;

use evigrid_core::{Disparity, Frame, GrayImage, Matches, Matching, Pose, StereoRig, View, level_camera};
use evigrid_cost_curve::WinnerTakeAllSettings;
use evigrid_grid::{GridSettings, GridSpec, LogOddsGrid, Mapper, Method};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

pub const RIG: StereoRig =
    StereoRig { width: 16, height: 12, focal_px: 14.0, centre_x_px: 7.5, centre_y_px: 5.5, baseline_m: 0.5 };

pub fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 12.0], y_m: [-3.0, 3.0], z_m: [-2.0, 2.0], cell_size_m: 0.4 };
    GridSpec::new(&settings).unwrap()
}

#[derive(Debug, Clone)]
pub struct Shot {
    pub pose: Pose,
    pub matches: Matches,
}

/// Whether a pixel's match is to be believed: the slow twin of the match filter.
pub fn accepted(settings: &WinnerTakeAllSettings, matches: &Matches, pixel: usize) -> bool {
    let confirmed = !settings.left_right_check
        || matches.left_right_difference_px[pixel] <= settings.left_right_tolerance_px;
    confirmed
        && !matches.disparity.values()[pixel].is_nan()
        && f64::from(matches.peak_ratio[pixel]) >= settings.peak_ratio
}

impl Shot {
    /// The shot as a mapper sees it, with grey images and without costs.
    pub fn with<T>(&self, look: impl FnOnce(&View<'_>) -> T) -> T {
        let grey = || GrayImage::new(RIG.width, RIG.height, vec![0; RIG.width * RIG.height]).unwrap();
        let frame = Frame::new(0, 0, RIG, grey(), grey(), self.pose, None).unwrap();
        look(&View::new(&frame, None, &Matching::from(self.matches.clone())))
    }
}

pub fn integrate(mapper: &mut impl Mapper, shot: &Shot) {
    shot.with(|view| mapper.integrate(view)).unwrap();
}

/// The numbers of a map to the last bit.
pub fn bits(map: &LogOddsGrid) -> Vec<u32> {
    map.values().iter().map(|l| l.to_bits()).collect()
}

/// Settings outside their domains are refused by errors that name the method.
pub fn all_are_refused<M: Method>(settings: &[M::Settings]) {
    for bad in settings {
        let Err(error) = M::build(spec(), bad) else { panic!("{} accepts impossible settings", M::NAME) };
        let text = error.to_string();
        assert!(text.starts_with(&format!("{}.", M::NAME)), "{text}");
    }
}

/// Cameras in the grid that look along it, more or less.
pub fn poses() -> impl Strategy<Value = Pose> {
    ([-1.0..3.0_f64, -1.0..1.0, -0.5..0.5], [-0.2..0.2_f64, -0.2..0.2, -0.5..0.5]).prop_map(|(at, turn)| {
        let turn = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
        Pose::from_parts(Vector3::from(at).into(), turn * level_camera())
    })
}

/// Images with holes and with pixels that see infinitely far.
pub fn shot() -> impl Strategy<Value = Shot> {
    let n = RIG.width * RIG.height;
    let disparity = prop_oneof![1 => Just(f32::NAN), 1 => Just(0.0_f32), 8 => 0.3..7.0_f32];
    let matches = (
        prop::collection::vec(disparity, n),
        prop::collection::vec(1.0..4.0_f32, n),
        prop::collection::vec(0..4_u16, n),
    );
    (matches, poses()).prop_map(|((disparity, mut peak_ratio, left_right_difference_px), pose)| {
        for (ratio, d) in peak_ratio.iter_mut().zip(&disparity) {
            *ratio = if d.is_nan() { f32::NAN } else { *ratio };
        }
        let disparity = Disparity::new(RIG.width, RIG.height, disparity).unwrap();
        Shot { pose, matches: Matches { disparity, peak_ratio, left_right_difference_px } }
    })
}
