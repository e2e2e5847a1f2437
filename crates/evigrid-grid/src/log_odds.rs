use crate::GridSpec;

/// ln(p / (1 - p)).
pub fn logit(p: f64) -> f64 {
    (p / (1.0 - p)).ln()
}

/// The probability of a log-odds value, 1 / (1 + e^-l): the inverse of [`logit`].
pub fn probability(log_odds: f64) -> f64 {
    1.0 / (1.0 + (-log_odds).exp())
}

/// The bounds that fused log-odds are kept within, so that a map can still change its mind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clamp {
    /// Lower bound.
    pub min: f32,
    /// Upper bound.
    pub max: f32,
}

impl Clamp {
    /// Log-odds of a cell after one more piece of evidence. A cell that was never touched (NaN) is at the
    /// prior 0.5, log-odds 0.
    #[inline]
    pub fn add(&self, before: f32, evidence: f32) -> f32 {
        let before = if before.is_nan() { 0.0 } else { before };
        (before + evidence).clamp(self.min, self.max)
    }
}

/// An occupancy grid of log-odds. A cell that no measurement has touched is NaN, which is not the same as 0
/// ("measured, undecided").
#[derive(Debug, Clone)]
pub struct LogOddsGrid {
    spec: GridSpec,
    values: Vec<f32>,
}

impl LogOddsGrid {
    /// A grid of unknown cells.
    pub fn unknown(spec: GridSpec) -> Self {
        Self { spec, values: vec![f32::NAN; spec.cell_count()] }
    }

    /// The grid's geometry.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Log-odds by flat index; NaN = never touched.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Log-odds by flat index, for methods that fuse in their own way.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// Log-odds of a cell; `None` if it was never touched.
    pub fn log_odds(&self, flat: usize) -> Option<f32> {
        Some(self.values[flat]).filter(|v| !v.is_nan())
    }

    /// Cells that were touched, with their log-odds, by rising flat index.
    pub fn touched(&self) -> impl Iterator<Item = (usize, f32)> {
        self.values.iter().copied().enumerate().filter(|(_, l)| !l.is_nan())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::GridSettings;

    #[test]
    fn logit_and_probability_invert() {
        assert_eq!(logit(0.5), 0.0);
        assert!((logit(0.75) - 3f64.ln()).abs() < 1e-15);
        for p in [1e-9, 0.02, 0.35, 0.999] {
            assert!((probability(logit(p)) - p).abs() < 1e-12);
        }
    }

    #[test]
    fn unknown_is_not_undecided() {
        let mut grid = LogOddsGrid::unknown(GridSpec::new(&GridSettings::default()).unwrap());
        grid.values_mut()[7] = 0.0;
        assert_eq!((grid.log_odds(6), grid.log_odds(7)), (None, Some(0.0)));
        assert_eq!(grid.touched().collect::<Vec<_>>(), [(7, 0.0)]);
    }
}
