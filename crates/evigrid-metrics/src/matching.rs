use evigrid_core::{CoreError, Disparity};

/// Errors of a disparity image against the true one, over the pixels whose true disparity is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MatchingScores {
    /// Pixels whose true disparity is known.
    pub pixels: usize,
    /// Pixels of these that carry a measurement.
    pub matched: usize,
    /// Measurements that are off by more than the tolerance.
    pub wrong: usize,
    /// Sum of the absolute errors of the measurements, pixels.
    pub off_px: f64,
}

impl MatchingScores {
    /// Compares two disparity images of the same size, NaN where there is no measurement.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn new(found: &Disparity, truth: &Disparity, tolerance_px: f32) -> Result<Self, CoreError> {
        if (found.width(), found.height()) != (truth.width(), truth.height()) {
            return Err(CoreError::Size {
                what: "disparity image",
                expected_width: truth.width(),
                expected_height: truth.height(),
                width: found.width(),
                height: found.height(),
            });
        }
        let mut scores = Self::default();
        for (found, truth) in found.values().iter().zip(truth.values()).filter(|(_, t)| !t.is_nan()) {
            scores.pixels += 1;
            scores.matched += usize::from(!found.is_nan());
            let off_px = (found - truth).abs();
            scores.wrong += usize::from(off_px > tolerance_px);
            scores.off_px += if off_px.is_nan() { 0.0 } else { f64::from(off_px) };
        }
        Ok(scores)
    }

    /// The scores of several images together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            matched: self.matched + other.matched,
            wrong: self.wrong + other.wrong,
            off_px: self.off_px + other.off_px,
        }
    }

    /// Mean absolute error of the measurements, pixels; NaN without measurements.
    pub fn mean_error_px(&self) -> f64 {
        self.off_px / self.matched as f64
    }

    /// Share of the pixels that carry a measurement; NaN without pixels.
    pub fn density(&self) -> f64 {
        self.matched as f64 / self.pixels as f64
    }

    /// Share of the measurements that are wrong; NaN without measurements.
    pub fn error_rate(&self) -> f64 {
        self.wrong as f64 / self.matched as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unknown_counts_nowhere_and_what_is_missing_is_not_wrong() {
        let image = |values: &[f32]| Disparity::new(values.len(), 1, values.to_vec()).unwrap();
        let nan = f32::NAN;
        let truth = image(&[5.0, 5.0, 5.0, 5.0, nan, nan]);
        let found = image(&[5.5, 6.0, 6.5, nan, 9.0, nan]);
        let scores = MatchingScores::new(&found, &truth, 1.0).unwrap();
        assert_eq!(scores, MatchingScores { pixels: 4, matched: 3, wrong: 1, off_px: 3.0 });
        assert_eq!((scores.density(), scores.error_rate()), (0.75, 1.0 / 3.0));
        assert_eq!(scores.mean_error_px(), 1.0);
        let twice = scores.plus(scores);
        assert_eq!((twice.pixels, twice.matched, twice.wrong, twice.mean_error_px()), (8, 6, 2, 1.0));
        assert!(MatchingScores::new(&image(&[1.0]), &truth, 1.0).is_err());
    }
}
