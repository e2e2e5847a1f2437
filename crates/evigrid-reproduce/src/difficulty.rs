//! How hard image pairs are to match: block matching against the true disparity.

use anyhow::Result;
use evigrid_core::{Disparity, Frame, MatchFilter, MatchLimits};
use evigrid_metrics::MatchingScores;
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};

/// A measurement off by more than this is wrong, pixels. A laser projected into an image is hardly better
/// than the first one itself, so the second says more of real data.
pub const TOLERANCES_PX: [f32; 2] = [1.0, 3.0];

/// Pixels and scores, summed over frames.
#[derive(Debug, Clone, Copy, Default)]
pub struct Difficulty {
    pixels: usize,
    valid: usize,
    compared: usize,
    wrong: [usize; 2],
}

impl Difficulty {
    /// Adds what was matched in a frame.
    pub fn add(&mut self, matched: &Disparity, truth: &Disparity) -> Result<()> {
        let mut compared = 0;
        self.pixels += matched.values().len();
        self.valid += matched.valid_count();
        for (wrong, tolerance_px) in self.wrong.iter_mut().zip(TOLERANCES_PX) {
            let scores = MatchingScores::new(matched, truth, tolerance_px)?;
            *wrong += scores.wrong;
            compared = scores.matched;
        }
        self.compared += compared;
        Ok(())
    }

    /// Share of all pixels that pass the left-right check, percent.
    pub fn valid_percent(&self) -> f64 {
        100.0 * self.valid as f64 / self.pixels as f64
    }

    /// Share of the valid pixels with known truth that are off by more than each tolerance, percent.
    pub fn wrong_percent(&self) -> [f64; 2] {
        self.wrong.map(|wrong| 100.0 * wrong as f64 / self.compared as f64)
    }
}

/// SAD 7x7 over 128 disparities, winner-take-all, left-right check within 1 px.
pub struct CheckedMatcher(BlockMatcher);

impl CheckedMatcher {
    /// The matcher.
    pub fn new() -> Result<Self> {
        Ok(Self(BlockMatcher::new(BlockMatchingSettings::default())?))
    }

    /// The disparity of a pair, NaN where the check fails.
    pub fn run(&mut self, frame: &Frame) -> Result<Disparity> {
        let matches = self.0.run(frame.left(), frame.right(), false, None)?.matches;
        Ok(MatchFilter::new(&matches, &MatchLimits::left_right(Some(1))).disparity()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_over_two_frames_by_hand() {
        let nan = f32::NAN;
        let image = |values: [f32; 5]| Disparity::new(5, 1, values.to_vec()).unwrap();
        let mut difficulty = Difficulty::default();
        // Four valid, three of them with known truth: off by 0, 2 and 4.
        difficulty.add(&image([5.0, 7.0, 9.0, 1.0, nan]), &image([5.0, 5.0, 5.0, nan, 5.0])).unwrap();
        // One valid and right.
        difficulty.add(&image([5.0, nan, nan, nan, nan]), &image([5.5; 5])).unwrap();
        assert_eq!(difficulty.valid_percent(), 50.0);
        assert_eq!(difficulty.wrong_percent(), [50.0, 25.0]);
    }
}
