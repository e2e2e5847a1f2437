//! Random frames with whole cost volumes.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

use evigrid_core::{
    CostScale, CostVolume, Disparity, Frame, GrayImage, Matches, Matching, NO_COST, Pose, View, level_camera,
};
use nalgebra::Vector3;
use proptest::prelude::*;

use super::{RIG, poses, spec};

/// Overlaps of a cell and the depths of a hypothesis that rounding may make or break, metres.
pub const TOUCH_M: f64 = 1e-9;
pub const SCALE: CostScale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };

#[derive(Debug, Clone)]
pub struct Shot {
    pub frame: Frame,
    pub matching: Matching,
}

impl Shot {
    pub fn view(&self) -> View<'_> {
        View::new(&self.frame, None, &self.matching)
    }

    pub fn matches(&self) -> &Matches {
        &self.matching.matches
    }

    pub fn volume(&self) -> &CostVolume {
        self.matching.volume.as_ref().unwrap()
    }

    /// The shot as a matcher without costs leaves it.
    pub fn without_costs(mut self) -> Self {
        self.matching.volume = None;
        self
    }
}

/// The hypotheses of a pixel, nearest first: disparity and cost (NaN if missing).
pub fn curve(volume: &CostVolume, x: usize, y: usize) -> (Vec<usize>, Vec<f64>) {
    let cost = |c| if c == NO_COST { f64::NAN } else { f64::from(c) };
    let mut costs: Vec<f64> = volume.curve(x, y).map(cost).collect();
    costs.reverse();
    let smallest = volume.min_disparity();
    ((smallest..smallest + costs.len()).rev().collect(), costs)
}

/// The cells that a ray from the camera passes up to a depth, with the depths of entry and exit.
pub fn cells_of_ray(shot: &Shot, x: f64, y: f64, depth_m: f64) -> Vec<([i64; 3], f64, f64)> {
    let pose = shot.frame.map_from_left();
    let (ray, origin) = (pose.rotation * RIG.ray(x, y), pose.translation.vector);
    let at = |z: f64| spec().to_cells((origin + ray * z).into());
    let (from, to) = (at(0.0), at(depth_m));
    let mut depths = vec![0.0, depth_m];
    for a in 0..3 {
        let (low, high) = (from[a].min(to[a]).ceil() as i64, from[a].max(to[a]).floor() as i64);
        depths.extend((low..=high).map(|face| (face as f64 - from[a]) / (to[a] - from[a]) * depth_m));
    }
    depths.sort_by(f64::total_cmp);
    let cell = |a: f64, b: f64| at(0.5 * (a + b)).map(|v| v.floor() as i64);
    depths.windows(2).map(|w| (cell(w[0], w[1]), w[0], w[1])).filter(|(_, a, b)| b - a > TOUCH_M).collect()
}

/// Winners of a volume, whole pixels.
pub fn winners(volume: &CostVolume) -> Disparity {
    let winner = |pixel: usize| {
        let curve = volume.curve(pixel % RIG.width, pixel / RIG.width).enumerate();
        let best = curve.filter(|c| c.1 != NO_COST).min_by_key(|c| c.1);
        best.map_or(f32::NAN, |(index, _)| (volume.min_disparity() + index) as f32)
    };
    Disparity::new(RIG.width, RIG.height, (0..RIG.width * RIG.height).map(winner).collect()).unwrap()
}

pub fn shot_of(pose: Pose, images: [Vec<u8>; 2], volume: CostVolume, left_right: Vec<u16>) -> Shot {
    let [left, right] = images.map(|pixels| GrayImage::new(RIG.width, RIG.height, pixels).unwrap());
    let frame = Frame::new(0, 0, RIG, left, right, pose, None).unwrap();
    let found = Matches::from_disparity(winners(&volume));
    let matches = Matches { left_right_difference_px: left_right, ..found };
    Shot { frame, matching: Matching { volume: Some(volume), ..Matching::from(matches) } }
}

pub fn shot() -> impl Strategy<Value = Shot> {
    let n = RIG.width * RIG.height;
    let costs = (0..3_usize, 1..12_usize).prop_flat_map(move |(smallest, disparities)| {
        let cost = prop_oneof![1 => Just(NO_COST), 6 => 0..3000_u16, 2 => 0..200_u16];
        let costs = prop::collection::vec(cost, n * disparities);
        (costs, prop::collection::vec(prop::bool::weighted(0.1), n)).prop_map(move |(mut costs, missing)| {
            // Some pixels have no cost at all.
            for (at, cost) in costs.iter_mut().enumerate() {
                let pixel = at / (RIG.width * disparities) * RIG.width + at % RIG.width;
                *cost = if missing[pixel] { NO_COST } else { *cost };
            }
            CostVolume::new(RIG.width, RIG.height, smallest, disparities, SCALE, costs).unwrap()
        })
    });
    let greys = || prop::collection::vec(100..120_u8, n);
    (poses(), [greys(), greys()], costs, prop::collection::vec(0..4_u16, n))
        .prop_map(|(pose, images, volume, left_right)| shot_of(pose, images, volume, left_right))
}

/// One pose and one cost curve that is the same for every pixel.
pub fn uniform(curve: &[u16], smallest: usize, images: [u8; 2]) -> Shot {
    scaled(curve, smallest, images, SCALE)
}

/// One pose and one cost curve that is the same for every pixel, with costs of a certain scale.
pub fn scaled(curve: &[u16], smallest: usize, images: [u8; 2], scale: CostScale) -> Shot {
    let n = RIG.width * RIG.height;
    let row = |c: &u16| vec![*c; RIG.width];
    let costs = (0..RIG.height).flat_map(|_| curve.iter().flat_map(row)).collect();
    let volume = CostVolume::new(RIG.width, RIG.height, smallest, curve.len(), scale, costs).unwrap();
    let pose = Pose::from_parts(Vector3::new(0.1, 0.0712, 0.0319).into(), level_camera());
    shot_of(pose, images.map(|grey| vec![grey; n]), volume, vec![0; n])
}
