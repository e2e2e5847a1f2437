use evigrid_core::{MatchLimits, SettingError, require_setting};
use evigrid_grid::{Clamp, logit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cost_exponent::CostUnit;

/// How evidence along the hypotheses of a pixel comes to the cells of its ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HypothesesToCells {
    /// Eqs 4 and 5 along the hypotheses; every cell in the depths of disparity d, b f / (d + 1/2) to
    /// b f / (d - 1/2), gets the P of d.
    PerDisparity,
    /// Equal shares of p(d) for all cells in the depths of disparity d, b f / (d + 1/2) to b f / (d - 1/2);
    /// eqs 4 and 5 along the cells. Slower.
    SpreadOverCells,
}

/// Mapping from whole cost curves (Brandao et al., section III).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CostCurveSettings {
    /// The unit of cost and variance in eq. 7. Unit: none. Source: Brandao et al. III-B leaves it open.
    pub cost_unit: CostUnit,
    /// Factor on the variance of eq. 10; below 1, the best match counts for more.
    /// Unit: none. Source: Brandao et al. III-D (1).
    pub variance_factor: f64,
    /// Model the costs of free space (eq. 6) instead of approximating them (eq. 9).
    /// Unit: none. Source: Brandao et al. IV (eq. 9 "for simplicity").
    pub free_space_model: bool,
    /// How hypotheses come to cells.
    /// Unit: none. Source: Brandao et al. IV names line drawing and a uniform distribution between far
    /// disparities.
    pub hypotheses_to_cells: HypothesesToCells,
    /// Drop pixels whose winner the right image does not confirm.
    /// Unit: none. Source: Brandao et al. V ("without pre or post discarding of any matches").
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed.
    /// Unit: px. Source: customary.
    pub left_right_tolerance_px: u16,
    /// Depth up to which evidence is drawn. Unit: m. Source: own choice (Brandao et al. give none).
    pub max_depth_m: f64,
    /// Lowest P that one frame may give a cell. Unit: none. Source: own choice (the bound of the fused map).
    pub min_probability: f64,
    /// Highest P that one frame may give a cell. Unit: none. Source: own choice (the bound of the fused map).
    pub max_probability: f64,
    /// Bounds of the fused map, and of the evidence of one frame.
    /// Unit: log-odds. Source: own choice, symmetric (P 0.0067 and 0.9933).
    pub log_odds_bounds: [f32; 2],
}

impl Default for CostCurveSettings {
    fn default() -> Self {
        Self {
            cost_unit: CostUnit::GreyLevels,
            variance_factor: 1.0,
            free_space_model: false,
            hypotheses_to_cells: HypothesesToCells::PerDisparity,
            left_right_check: false,
            left_right_tolerance_px: 1,
            max_depth_m: 40.0,
            min_probability: 0.0067,
            max_probability: 0.9933,
            log_odds_bounds: [-5.0, 5.0],
        }
    }
}

impl CostCurveSettings {
    /// `Ok` if every setting is within its domain, else the error that names it within `section`.
    pub(super) fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let require = |ok, key, expected, found: String| require_setting(ok, section, key, expected, found);
        for (key, value) in [("variance_factor", self.variance_factor), ("max_depth_m", self.max_depth_m)] {
            require(value.is_finite() && value > 0.0, key, "a positive number", value.to_string())?;
        }
        let (low, high) = (self.min_probability, self.max_probability);
        require(low > 0.0 && low < 0.5, "min_probability", "a number between 0 and 0.5", low.to_string())?;
        require(high > 0.5 && high < 1.0, "max_probability", "a number between 0.5 and 1", high.to_string())?;
        let [min, max] = self.log_odds_bounds;
        // Beyond 40, a probability in double precision is 0 or 1.
        let bounded = (-40.0..0.0).contains(&min) && max > 0.0 && max <= 40.0;
        require(bounded, "log_odds_bounds", "[-40 to below 0, above 0 to 40]", format!("[{min}, {max}]"))
    }

    /// The bounds of the fused map.
    pub fn clamp(&self) -> Clamp {
        Clamp { min: self.log_odds_bounds[0], max: self.log_odds_bounds[1] }
    }

    /// The bounds of the evidence of one frame.
    pub fn evidence_bounds(&self) -> Clamp {
        let Clamp { min, max } = self.clamp();
        Clamp {
            min: min.max(logit(self.min_probability) as f32),
            max: max.min(logit(self.max_probability) as f32),
        }
    }
    /// The limits that a pixel's winner must keep for the pixel to be drawn.
    pub(super) fn match_limits(&self) -> MatchLimits {
        MatchLimits::left_right(self.left_right_check.then_some(self.left_right_tolerance_px))
    }
}
