//! The error of the poses that a robot reports.

use evigrid_core::Pose;
use nalgebra::{Isometry3, Translation3, Vector3};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use crate::angle;
use crate::number::NonNegative;
use crate::random::{Sensor, normal, stream};

/// Errors of the reported pose as a world describes them. On the ground they concern x, y and the heading, in
/// the air also z, roll and pitch. The first frame's pose is exact: it is where the map begins.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseErrorSpec {
    /// Standard deviation of the position of every frame by itself, metres.
    #[serde(default)]
    white_m: NonNegative,
    /// Standard deviation of the angles of every frame by itself.
    #[serde(default)]
    white_deg: NonNegative,
    /// Odometry: standard deviation of the position error that the first metre of the way adds; errors of
    /// different metres are independent, so that they grow with the square root of the way.
    #[serde(default)]
    drift_m_per_m: NonNegative,
    /// Odometry: standard deviation of the error of the angles that the first metre of the way adds, degrees;
    /// it grows like that of the position.
    #[serde(default)]
    drift_deg_per_m: NonNegative,
}

impl PoseErrorSpec {
    /// The poses that are reported for these true ones.
    pub fn reported(&self, world_from_body: &[Pose], is_in_the_air: bool, seed: u64) -> Vec<Pose> {
        let mut rng = stream(seed, 0, Sensor::Pose, 0);
        let mut reported = Vec::with_capacity(world_from_body.len());
        let mut drifted = world_from_body[0];
        reported.push(drifted);
        for pair in world_from_body.windows(2) {
            let step = pair[0].inverse() * pair[1];
            let root = step.translation.vector.norm().sqrt();
            let error = |rng: &mut ChaCha8Rng, m: f64, deg: f64| error(rng, m, deg, is_in_the_air);
            drifted *= step * error(&mut rng, self.drift_m_per_m.0 * root, self.drift_deg_per_m.0 * root);
            reported.push(drifted * error(&mut rng, self.white_m.0, self.white_deg.0));
        }
        if self.is_none() { world_from_body.to_vec() } else { reported }
    }

    /// Whether the reported poses are the true ones.
    pub fn is_none(&self) -> bool {
        [self.white_m, self.white_deg, self.drift_m_per_m, self.drift_deg_per_m].iter().all(|v| v.0 == 0.0)
    }
}

/// A small random motion; always the same number of draws.
fn error(rng: &mut ChaCha8Rng, metres: f64, degrees: f64, is_in_the_air: bool) -> Pose {
    let mut draw = || normal(rng);
    let [x, y, z, yaw, pitch, roll] = [draw(), draw(), draw(), draw(), draw(), draw()];
    let in_the_air = f64::from(u8::from(is_in_the_air));
    let shift = Vector3::new(x, y, z * in_the_air) * metres;
    let turn = angle::attitude(yaw * degrees, pitch * degrees * in_the_air, roll * degrees * in_the_air);
    Isometry3::from_parts(Translation3::from(shift), turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(frames: usize) -> Vec<Pose> {
        (0..frames).map(|i| Pose::translation(0.25 * i as f64, 0.0, 0.0)).collect()
    }

    fn spec(white_m: f64, drift_m: f64, drift_deg: f64) -> PoseErrorSpec {
        PoseErrorSpec {
            white_m: NonNegative(white_m),
            white_deg: NonNegative(0.0),
            drift_m_per_m: NonNegative(drift_m),
            drift_deg_per_m: NonNegative(drift_deg),
        }
    }

    #[test]
    fn white_noise_has_its_deviation_and_does_not_grow() {
        let truth = straight(4001);
        let reported = spec(0.03, 0.0, 0.0).reported(&truth, false, 7);
        assert_eq!(reported[0], truth[0]);
        let error = |i: usize| reported[i].translation.vector - truth[i].translation.vector;
        for (range, name) in [(1..2001, "first"), (2001..4001, "second")] {
            let squares: f64 = range.map(|i| error(i).x.powi(2)).sum();
            assert!(((squares / 2000.0).sqrt() - 0.03).abs() < 0.002, "{name} half");
        }
        assert!(reported.iter().all(|p| p.translation.z == 0.0), "on the ground z is exact");
    }

    #[test]
    fn drift_grows_with_the_root_of_the_way() {
        // 100 m of way in 401 frames, many seeds: deviation 0.02 * sqrt(100) = 0.2 m along x.
        let truth = straight(401);
        let ends: Vec<f64> = (0..2000)
            .map(|seed| spec(0.0, 0.02, 0.0).reported(&truth, false, seed)[400].translation.x - 100.0)
            .collect();
        let deviation = (ends.iter().map(|e| e * e).sum::<f64>() / 2000.0).sqrt();
        assert!((deviation - 0.2).abs() < 0.01, "{deviation}");
    }

    #[test]
    fn a_heading_error_bends_the_way() {
        // Angle error after s metres: q sqrt(s); sideways error: integral, q s^1.5 / sqrt(3).
        let truth = straight(161);
        let expected = 1_f64.to_radians() * 40_f64.powf(1.5) / 3_f64.sqrt();
        let squares: f64 = (0..2000)
            .map(|seed| spec(0.0, 0.0, 1.0).reported(&truth, false, seed)[160].translation.y.powi(2))
            .sum();
        let deviation = (squares / 2000.0).sqrt();
        assert!((deviation / expected - 1.0).abs() < 0.05, "{deviation} {expected}");
    }
}
