//! Random frames of a small rig over a small grid, and the inverse model written down directly.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

use evigrid_core::{Disparity, Frame, GrayImage, Matches, Matching, Pose, StereoRig, View, level_camera};
use evigrid_grid::{GridSettings, GridSpec, LogOddsGrid, Mapper};
use evigrid_inverse_model::{
    InverseModelMapper, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, SouzaSettings,
};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// A rig whose images have odd sizes in both directions.
pub const RIG: StereoRig =
    StereoRig { width: 21, height: 15, focal_px: 18.0, centre_x_px: 10.3, centre_y_px: 6.8, baseline_m: 0.5 };

/// Pixels of an image.
pub const N: usize = RIG.width * RIG.height;

pub const CELL_M: f64 = 0.4;

pub fn spec() -> GridSpec {
    let settings =
        GridSettings { x_m: [-1.0, 11.0], y_m: [-3.0, 3.0], z_m: [-2.0, 2.0], cell_size_m: CELL_M };
    GridSpec::new(&settings).unwrap()
}

#[derive(Debug, Clone)]
pub struct Shot {
    pub pose: Pose,
    pub matches: Matches,
}

impl Shot {
    pub fn of(pose: Pose, disparity: Vec<f32>) -> Self {
        let disparity = Disparity::new(RIG.width, RIG.height, disparity).unwrap();
        Self { pose, matches: Matches::from_disparity(disparity) }
    }

    /// The shot as a mapper sees it, with grey images.
    pub fn with<T>(&self, look: impl FnOnce(&View<'_>) -> T) -> T {
        let grey = || GrayImage::new(RIG.width, RIG.height, vec![0; N]).unwrap();
        let frame = Frame::new(0, 0, RIG, grey(), grey(), self.pose, None).unwrap();
        look(&View::new(&frame, None, &Matching::from(self.matches.clone())))
    }

    pub fn integrate(&self, mapper: &mut impl Mapper) {
        self.with(|view| mapper.integrate(view)).unwrap();
    }

    pub fn camera(&self) -> Vector3<f64> {
        self.pose.translation.vector
    }

    /// The point at a depth on the ray through an image point, map frame.
    pub fn point(&self, x: f64, y: f64, depth: f64) -> Point3<f64> {
        self.pose * Point3::from(RIG.ray(x, y) * depth)
    }

    /// Disparity of a pixel that passes the filters of the defaults.
    pub fn believed(&self, x: usize, y: usize) -> Option<f32> {
        let pixel = y * RIG.width + x;
        let m = &self.matches;
        let kept = m.peak_ratio[pixel] >= 1.5 && m.left_right_difference_px[pixel] <= 1;
        Some(m.disparity.values()[pixel]).filter(|d| kept && !d.is_nan())
    }
}

/// The numbers of a map to the last bit.
pub fn bits(map: &LogOddsGrid) -> Vec<u32> {
    map.values().iter().map(|l| l.to_bits()).collect()
}

/// One mapper of each method.
pub fn all(spec: GridSpec) -> [InverseModelMapper; 5] {
    [
        InverseModelMapper::line(spec, LineSettings::default()).unwrap(),
        InverseModelMapper::line_pyramid(spec, LinePyramidSettings::default()).unwrap(),
        InverseModelMapper::ray(spec, RaySettings::default()).unwrap(),
        InverseModelMapper::ray_pyramid(spec, RayPyramidSettings::default()).unwrap(),
        InverseModelMapper::souza(spec, SouzaSettings::default()).unwrap(),
    ]
}

/// A camera in the grid in front of a wall that fills the image.
pub fn wall(depth_m: f64) -> Shot {
    let pose = Pose::from_parts(Vector3::new(0.1, 0.1, 0.1).into(), level_camera());
    Shot::of(pose, vec![RIG.disparity_px(depth_m) as f32; N])
}

/// Indices of the cell that holds a point of the map frame, in the grid or not.
pub fn cell_at(point: [f64; 3]) -> [i64; 3] {
    spec().to_cells(point).map(|v| v.floor() as i64)
}

/// Poses within and outside the grid, images with holes, far and near pixels.
pub fn shot() -> impl Strategy<Value = Shot> {
    let disparity =
        prop_oneof![2 => Just(f32::NAN), 1 => Just(0.0_f32), 8 => 0.3..9.0_f32, 1 => 9.0..60.0_f32];
    let matches = (
        prop::collection::vec(disparity, N),
        prop::collection::vec(1.3..4.0_f32, N),
        prop::collection::vec(0..3_u16, N),
    );
    let pose = ([-3.0..4.0_f64, -3.5..3.5, -2.5..2.5], [-0.4..0.4_f64, -0.4..0.4, -3.0..3.0]);
    (matches, pose).prop_map(|((disparity, mut peak_ratio, left_right_difference_px), (at, turn))| {
        for (ratio, d) in peak_ratio.iter_mut().zip(&disparity) {
            *ratio = if d.is_nan() { f32::NAN } else { *ratio };
        }
        let disparity = Disparity::new(RIG.width, RIG.height, disparity).unwrap();
        let turn = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2] * 0.3);
        let pose = Pose::from_parts(Vector3::from(at).into(), turn * level_camera());
        Shot { pose, matches: Matches { disparity, peak_ratio, left_right_difference_px } }
    })
}
