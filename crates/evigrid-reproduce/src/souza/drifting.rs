//! A drive with other errors of odometry than its world has.

use std::f64::consts::TAU;

use evigrid_core::{Frame, Pose};
use evigrid_replay::{ReplayError, Sequence, SequenceInfo};
use evigrid_synth::SyntheticSequence;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// How odometry goes wrong: standard deviations that the first metre adds.
#[derive(Debug, Clone, Copy)]
pub struct Drift {
    pub metres: f64,
    pub degrees: f64,
    /// Another number gives another drive.
    pub seed: u64,
}

/// The frames of an exact drive with poses that drift, and without its laser.
pub struct Drifting {
    exact: SyntheticSequence,
    world_from_left: Vec<Pose>,
}

impl Drifting {
    /// # Errors
    /// If a pose cannot be read.
    pub fn new(exact: SyntheticSequence, drift: &Drift) -> Result<Self, ReplayError> {
        let poses: Result<Vec<Pose>, ReplayError> =
            (0..exact.info().frame_count).map(|index| exact.world_from_left(index)).collect();
        Ok(Self { world_from_left: drift.along(&poses?), exact })
    }
}

impl Drift {
    /// Poses of a level camera that counts its way: errors of different metres are
    /// independent, and the first pose is exact.
    fn along(&self, exact: &[Pose]) -> Vec<Pose> {
        let mut noise = Noise(self.seed);
        let mut drifted: Vec<Pose> = exact.first().copied().into_iter().collect();
        let mut here = drifted.first().copied().unwrap_or_default();
        for pair in exact.windows(2) {
            let step = pair[0].inverse() * pair[1];
            let root = step.translation.vector.norm().sqrt();
            let [right, ahead, turn] = [(); 3].map(|()| root * noise.normal());
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.degrees / 360.0 * TAU * turn);
            let shift = Vector3::new(right, 0.0, ahead) * self.metres;
            here *= step * Isometry3::from_parts(shift.into(), turn);
            drifted.push(here);
        }
        drifted
    }
}

impl Sequence for Drifting {
    fn info(&self) -> &SequenceInfo {
        self.exact.info()
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        match self.world_from_left.get(index) {
            Some(pose) => Ok(*pose),
            None => self.exact.world_from_left(index),
        }
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        let frame = self.exact.frame(index, map_from_world)?;
        let (left, right) = (frame.left().clone(), frame.right().clone());
        let pose = map_from_world * self.world_from_left(index)?;
        Frame::new(index, frame.stamp_ns(), *frame.rig(), left, right, pose, None)
            .map_err(|source| ReplayError::Frame { index, source, path: self.info().id.clone().into() })
    }
}

/// Random numbers that are the same on every machine.
struct Noise(u64);

impl Noise {
    /// From 0 to 1 (splitmix64).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and deviation 1, as the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_grow_with_the_root_of_the_way() {
        let straight: Vec<Pose> =
            (0..=100).map(|n| Isometry3::translation(0.0, 0.0, 0.1 * f64::from(n))).collect();
        let errors: Vec<f64> = (0..400)
            .map(|seed| {
                let drift = Drift { metres: 0.02, degrees: 0.0, seed };
                let drifted = drift.along(&straight);
                assert_eq!(drifted[0], straight[0]);
                drifted[100].translation.vector.x
            })
            .collect();
        let deviation = (errors.iter().map(|e| e * e).sum::<f64>() / 400.0).sqrt();
        // After 10 m, 0.02 sqrt(10).
        assert!((deviation / 0.0632 - 1.0).abs() < 0.15, "{deviation}");
    }
}
