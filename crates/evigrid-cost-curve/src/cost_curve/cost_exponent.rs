//! The exponent of Brandao et al., eq. 7, whose unit the paper leaves open.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Unit in which the cost E and the variance sigma^2 meet in Brandao et al., eq. 7, E / (2 sigma^2). As
/// printed, a sum of absolute differences is divided by a variance, so the choice of the unit changes the
/// result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CostUnit {
    /// E and sigma in grey levels, 0 to 255, as printed.
    GreyLevels,
    /// E and sigma in intensities from 0 to 1, as printed: 255 times sharper than grey levels.
    UnitIntensities,
    /// Squared differences over sigma^2, which has no unit: E^2 / n, the sum of the squares of n equal
    /// differences whose absolute values sum up to E.
    Homogeneous,
}

/// The exponent E / (2 sigma^2) of Brandao et al., eq. 7, as a function of the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostExponent {
    /// Exponent per grey level of cost.
    pub(crate) linear: f64,
    /// Exponent per squared grey level of cost.
    pub(crate) quadratic: f64,
}

impl CostExponent {
    /// The exponent for the variance of eq. 10 (grey levels^2, positive) and costs that are sums over
    /// `window_pixels` pixels.
    pub fn new(unit: CostUnit, variance: f64, window_pixels: f64) -> Self {
        let half = 0.5 / variance;
        match unit {
            CostUnit::GreyLevels => Self { linear: half, quadratic: 0.0 },
            // (E / 255) / (2 sigma^2 / 255^2).
            CostUnit::UnitIntensities => Self { linear: 255.0 * half, quadratic: 0.0 },
            CostUnit::Homogeneous => Self { linear: 0.0, quadratic: half / window_pixels },
        }
    }

    /// The exponent of a cost in grey levels.
    pub fn of(&self, cost: f64) -> f64 {
        self.linear * cost + self.quadratic * cost * cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_by_hand() {
        // Cost 490 over 49 pixels: 10 grey levels each; sigma^2 = 50.
        let of = |unit| CostExponent::new(unit, 50.0, 49.0).of(490.0);
        assert!((of(CostUnit::GreyLevels) - 4.9).abs() < 1e-12);
        assert!((of(CostUnit::UnitIntensities) - 255.0 * 4.9).abs() < 1e-9);
        // 49 squares of 100, over 2 * 50.
        assert!((of(CostUnit::Homogeneous) - 49.0).abs() < 1e-12);
    }
}
