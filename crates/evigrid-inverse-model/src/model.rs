//! The inverse sensor model of Andert 2009, section IV, with the motion error of Souza et al. 2012, in closed
//! form.

use std::f64::consts::TAU;

use evigrid_core::StereoRig;
use evigrid_grid::logit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The camera of Andert 2009, Fig. 1 and Table I.
pub const ANDERT_RIG: StereoRig = StereoRig {
    width: 640,
    height: 480,
    focal_px: 700.0,
    centre_x_px: 320.0,
    centre_y_px: 240.0,
    baseline_m: 0.3,
};

/// Treatment of a pixel so near that its peak would be no probability: P(l) lies in (0, 1) only while
/// A = k / (dl sqrt(2 pi)) < 1/2 (Andert 2009, section IV: "for all l >= l_min").
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NearPixels {
    /// Draws the pixel with a smaller k, so that its peak is the largest evidence that a frame may give.
    Limit,
    /// Drops the pixel, like every one nearer than [`SensorModel::nearest_depth_m`].
    Reject,
}

/// The inverse sensor model of one frame: from a disparity to the occupancy along the pixel's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorModel {
    /// Significance of one measurement, metres (eq. 9).
    pub k: f64,
    /// P of a cell in front of the measured one, between 0 and 0.5 (eq. 10).
    pub min_probability: f64,
    /// Uncertainty of a disparity, pixels (eq. 4).
    pub disparity_error_px: f64,
    /// Error of the platform's motion, metres (Souza eq. 13); 0 with Andert.
    pub motion_error_m: f64,
    /// Treatment of pixels that are too near for k.
    pub near: NearPixels,
    /// The largest A, below 0.5, that [`NearPixels::Limit`] lets stand.
    pub max_peak: f64,
    /// Depth beyond which a pixel is free space up to there, metres.
    pub max_depth_m: f64,
}

/// The evidence of one pixel for its ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measurement {
    /// Something at a range.
    Obstacle(Obstacle),
    /// Nothing up to a range, that of the point at the largest depth.
    Free {
        /// Range up to which the ray is free, metres.
        range_m: f64,
        /// P of the cells up to there.
        min_probability: f64,
    },
}

/// A measured range with the numbers that Andert's eqs 9 and 10 need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// Range l_p, metres (eq. 6).
    pub range_m: f64,
    /// Deviation dl_p of the range, metres (eq. 7).
    pub deviation_m: f64,
    /// Height A of the peak above 0.5, k / (dl_p sqrt(2 pi)).
    pub peak: f64,
    /// P of a cell in front (eq. 10).
    pub min_probability: f64,
}

impl SensorModel {
    /// Uncertainty of a depth, metres: dz = z^2 / (b f) dd (Andert eq. 4), plus eps (Souza eq. 13).
    pub fn depth_deviation_m(&self, rig: &StereoRig, depth_m: f64) -> f64 {
        depth_m * depth_m / (rig.baseline_m * rig.focal_px) * self.disparity_error_px + self.motion_error_m
    }

    /// The depth at which A = 1/2 on the optical axis, metres: nearer pixels break P in (0, 1). 0 if the
    /// motion error alone keeps A below that.
    pub fn nearest_depth_m(&self, rig: &StereoRig) -> f64 {
        let depth_deviation = 2.0 * self.k / TAU.sqrt() - self.motion_error_m;
        (depth_deviation.max(0.0) * rig.baseline_m * rig.focal_px / self.disparity_error_px).sqrt()
    }

    /// Height A = k / (dl sqrt(2 pi)) of the peak above 0.5 for a range deviation in metres (eq. 9), kept
    /// within the limit for near pixels.
    #[inline]
    pub fn peak(&self, deviation_m: f64) -> f64 {
        (self.k / (deviation_m * TAU.sqrt())).min(self.max_peak)
    }

    /// The evidence of a disparity for the ray through image point (x, y), pixels (Andert eqs 1, 2, 4, 6, 7);
    /// `None` for no measurement, or one that is nearer than [`NearPixels::Reject`] allows.
    pub fn measure(&self, rig: &StereoRig, (x, y): (f64, f64), disparity_px: f64) -> Option<Measurement> {
        if disparity_px.is_nan() {
            return None;
        }
        let (depth_m, range_per_depth) = (rig.depth_m(disparity_px), rig.ray(x, y).norm());
        let min_probability = self.min_probability;
        if depth_m > self.max_depth_m {
            return Some(Measurement::Free { range_m: self.max_depth_m * range_per_depth, min_probability });
        }
        if self.near == NearPixels::Reject && depth_m <= self.nearest_depth_m(rig) {
            return None;
        }
        let deviation_m = self.depth_deviation_m(rig, depth_m) * range_per_depth;
        let (range_m, peak) = (depth_m * range_per_depth, self.peak(deviation_m));
        Some(Measurement::Obstacle(Obstacle { range_m, deviation_m, peak, min_probability }))
    }
}

impl Obstacle {
    /// Occupancy P(s(l)) at a range, metres (Andert eqs 9 and 10).
    pub fn probability(&self, range_m: f64) -> f64 {
        let before = if range_m <= self.range_m { self.min_probability } else { 0.5 };
        let t = (range_m - self.range_m) / self.deviation_m;
        before + (self.peak + 0.5 - before) * (-0.5 * t * t).exp()
    }

    /// Log-odds L(s(l)) at a range, metres (eq. 8).
    pub fn log_odds(&self, range_m: f64) -> f64 {
        logit(self.probability(range_m))
    }
}

impl Measurement {
    /// Log-odds L^(s(l)) of a cell at a range (eq. 11): the largest L within half a cell of it; 0 where the
    /// ray says nothing. L rises up to l_p and falls behind it, so that the largest is at the place of the
    /// interval nearest to l_p.
    pub fn max_log_odds(&self, range_m: f64, cell_size_m: f64) -> f64 {
        match self {
            Self::Obstacle(obstacle) => {
                let half = 0.5 * cell_size_m;
                obstacle.log_odds(obstacle.range_m.clamp(range_m - half, range_m + half))
            }
            Self::Free { range_m: end, min_probability } if range_m <= *end => logit(*min_probability),
            Self::Free { .. } => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::{ANDERT_RIG as RIG, *};
    use evigrid_grid::probability;

    const FIGURE_1: SensorModel = SensorModel {
        k: 0.1,
        min_probability: 0.35,
        disparity_error_px: 0.5,
        motion_error_m: 0.0,
        near: NearPixels::Limit,
        max_peak: 0.4933,
        max_depth_m: 60.0,
    };

    fn on_axis(model: &SensorModel, depth_m: f64) -> Obstacle {
        match model.measure(&RIG, (320.0, 240.0), RIG.disparity_px(depth_m)).unwrap() {
            Measurement::Obstacle(obstacle) => obstacle,
            free => panic!("{free:?}"),
        }
    }

    #[test]
    fn figure_1_of_andert() {
        // 10, 20 and 40 m: dl = z^2 / 210 / 2, peak 0.5 + 0.1 / (dl sqrt(2 pi)), P = 0.35 far in front.
        for (z, deviation, peak) in
            [(10.0, 0.238095, 0.667556), (20.0, 0.952381, 0.541889), (40.0, 3.809524, 0.510472)]
        {
            let obstacle = on_axis(&FIGURE_1, z);
            assert!((obstacle.deviation_m - deviation).abs() < 5e-7);
            assert!((obstacle.probability(z) - peak).abs() < 5e-7, "{}", obstacle.probability(z));
            assert!((obstacle.probability(z - 12.0 * deviation) - 0.35).abs() < 1e-6);
            assert!((obstacle.probability(z + 12.0 * deviation) - 0.5).abs() < 1e-6);
            // P = 0.5 is crossed where exp(-t^2/2) = 0.15 / (0.15 + A).
            let crossing = z - deviation * (2.0 * (0.15 + peak - 0.5_f64).ln() - 2.0 * 0.15_f64.ln()).sqrt();
            assert!((obstacle.probability(crossing) - 0.5).abs() < 1e-5);
            assert!(obstacle.log_odds(crossing - 0.01) < 0.0 && obstacle.log_odds(crossing + 0.01) > 0.0);
        }
        let far = FIGURE_1.measure(&RIG, (320.0, 240.0), 0.0).unwrap();
        assert!((far.max_log_odds(59.9, 0.5) - logit(0.35)).abs() < 1e-12);
        assert_eq!(far.max_log_odds(60.1, 0.5), 0.0);
    }

    #[test]
    fn peaks_of_souza() {
        for (eps, peaks) in [(0.1, [0.617997, 0.537909, 0.510204]), (0.5, [0.554050, 0.527468, 0.509257])] {
            let model = SensorModel { motion_error_m: eps, ..FIGURE_1 };
            for (z, peak) in [10.0, 20.0, 40.0].into_iter().zip(peaks) {
                assert!((on_axis(&model, z).probability(z) - peak).abs() < 5e-7);
            }
        }
    }

    #[test]
    fn the_bound_on_k() {
        let nearest = FIGURE_1.nearest_depth_m(&RIG);
        assert!((nearest - 5.7889).abs() < 5e-5, "{nearest}");
        assert!((RIG.disparity_px(nearest) - 36.276).abs() < 5e-4);
        // There A = 1/2: k = 0.5 sqrt(2 pi) dz.
        let k_at = |model: &SensorModel, z: f64| 0.5 * TAU.sqrt() * model.depth_deviation_m(&RIG, z);
        assert!((k_at(&FIGURE_1, nearest) - 0.1).abs() < 1e-12);
        let with_motion = SensorModel { motion_error_m: 0.05, ..FIGURE_1 };
        assert!((k_at(&with_motion, with_motion.nearest_depth_m(&RIG)) - 0.1).abs() < 1e-12);
        assert_eq!(SensorModel { motion_error_m: 0.1, ..FIGURE_1 }.nearest_depth_m(&RIG), 0.0);
        let reject = SensorModel { near: NearPixels::Reject, ..FIGURE_1 };
        let at = |z: f64| reject.measure(&RIG, (320.0, 240.0), RIG.disparity_px(z));
        assert!(at(5.78).is_none() && at(5.80).is_some());
        assert!((on_axis(&FIGURE_1, 2.0).probability(2.0) - 0.9933).abs() < 1e-12);
    }

    #[test]
    fn the_closed_form_of_equation_11_is_the_largest_sample() {
        for z in [8.0, 15.0, 40.0] {
            let measured = Measurement::Obstacle(on_axis(&FIGURE_1, z));
            for step in 0..400 {
                let l = 0.1 + 0.15 * f64::from(step);
                let Measurement::Obstacle(obstacle) = measured else { continue };
                let samples = (0..=2000).map(|n| obstacle.log_odds(l - 0.25 + 0.5 * f64::from(n) / 2000.0));
                let largest = samples.fold(f64::NEG_INFINITY, f64::max);
                let closed = measured.max_log_odds(l, 0.5);
                assert!(closed >= largest - 1e-12 && closed - largest < 1e-3, "{z} {l}: {closed} {largest}");
                assert!((0.0..1.0).contains(&probability(closed)));
            }
        }
    }
}
