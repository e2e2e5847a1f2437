//! The depths that the disparity hypotheses of a pixel stand for.

use evigrid_core::{CostVolume, StereoRig};

/// The hypotheses of a frame from the nearest to the farthest. Disparity d stands for d - 1/2 to d + 1/2
/// pixels, so for the depths b f / (d + 1/2) to b f / (d - 1/2).
#[derive(Debug, Default)]
pub(crate) struct Hypotheses {
    /// Depth at which the nearest begins, metres.
    nearest_m: f64,
    /// Depth at which each ends and the next begins, metres; infinite for disparity 0.
    far_m: Vec<f64>,
    /// Baseline times focal length, metres times pixels.
    base_times_focal: f64,
    /// The largest disparity, pixels.
    largest: f64,
    /// The number of the last hypothesis.
    last: f64,
}

impl Hypotheses {
    /// Sets the hypotheses of a volume seen by a rig.
    pub fn fill(&mut self, rig: &StereoRig, volume: &CostVolume) {
        let smallest = volume.min_disparity();
        let largest = smallest + volume.disparities() - 1;
        let far = |d: usize| if d == 0 { f64::INFINITY } else { rig.depth_m(d as f64 - 0.5) };
        self.nearest_m = rig.depth_m(largest as f64 + 0.5);
        (self.base_times_focal, self.largest) = (rig.baseline_m * rig.focal_px, largest as f64);
        self.last = (largest - smallest) as f64;
        self.far_m.clear();
        self.far_m.extend((smallest..=largest).rev().map(far));
    }

    /// Depth at which hypothesis `i`, counted from the nearest, begins, metres; for `i` their number, the
    /// depth at which the last ends.
    #[inline]
    pub fn near_m(&self, i: usize) -> f64 {
        if i == 0 { self.nearest_m } else { self.far_m[i - 1] }
    }

    /// The number of the hypothesis, counted from the nearest, that holds a depth; the first or last beyond
    /// either end. At the end of one and the beginning of the next it is either.
    #[inline(always)]
    pub fn at(&self, depth_m: f64) -> i32 {
        // Counted down from the largest disparity. Adding 1.5 * 2^52 rounds to whole numbers and leaves them
        // in the low bits.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let from_largest = self.largest - self.base_times_focal / depth_m;
        let within = if from_largest > 0.0 { from_largest } else { 0.0 };
        let within = if within < self.last { within } else { self.last };
        (within + ROUND).to_bits() as i32
    }

    /// Depth at which each hypothesis ends, metres.
    pub fn far_m(&self) -> &[f64] {
        &self.far_m
    }

    /// How many hypotheses there are.
    pub fn len(&self) -> usize {
        self.far_m.len()
    }
}
