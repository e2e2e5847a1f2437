use evigrid_core::{MatchLimits, SettingError, require_setting};
use evigrid_grid::{Clamp, logit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the width of the Gaussian around the winner follows from the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Deviation {
    /// A width that follows the range: dl = z^2 / (b f) * disparity error * l / z (Andert 2009, eqs 4 and 7).
    FollowsRange,
    /// One width everywhere (Brandao et al., Fig. 1).
    Constant,
}

/// Winner-take-all mapping, the baseline of Brandao et al.: Elfes' inverse model with a Gaussian around the
/// winner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WinnerTakeAllSettings {
    /// Matches with a smaller peak ratio are dropped; 1 drops none.
    /// Unit: none. Source: Brandao et al. IV-B (1.5 to 12).
    pub peak_ratio: f64,
    /// Drop matches that the right image does not confirm.
    /// Unit: none. Source: Brandao et al. I-A names it as the usual filter.
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed.
    /// Unit: px. Source: customary.
    pub left_right_tolerance_px: u16,
    /// Depth up to which evidence is drawn; farther matches are free space up to there.
    /// Unit: m. Source: Andert 2009 (25 m).
    pub max_depth_m: f64,
    /// Whether the width of the Gaussian follows the range or is constant.
    /// Unit: none. Source: Brandao et al. I-A on Andert 2009.
    pub deviation: Deviation,
    /// Standard deviation of a disparity, where the width follows the range.
    /// Unit: px. Source: Andert 2009 III (0.2 from literature).
    pub disparity_error_px: f64,
    /// Variance of the range in cells, where the width is constant.
    /// Unit: cells^2. Source: Brandao et al. Fig. 1 (5).
    pub constant_variance_cells: f64,
    /// Lowest P that one frame may give a cell. Elfes' model knows no mismatches: it gives P = 0 to every
    /// cell in front of a match, so that one wrong far match would erase a surface that ten frames agree on.
    /// Unit: none. Source: Andert 2009 Fig. 1 (p_min 0.35).
    pub min_probability: f64,
    /// Bounds of the fused map, and of the evidence of one frame.
    /// Unit: log-odds. Source: own choice, symmetric (P 0.0067 and 0.9933).
    pub log_odds_bounds: [f32; 2],
}

impl Default for WinnerTakeAllSettings {
    fn default() -> Self {
        Self {
            peak_ratio: 1.5,
            left_right_check: true,
            left_right_tolerance_px: 1,
            max_depth_m: 25.0,
            deviation: Deviation::FollowsRange,
            disparity_error_px: 0.2,
            constant_variance_cells: 5.0,
            min_probability: 0.35,
            log_odds_bounds: [-5.0, 5.0],
        }
    }
}

impl WinnerTakeAllSettings {
    /// `Ok` if every setting is within its domain, else the error that names it within `section`.
    pub(super) fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        let require = |ok, key, expected, found: String| require_setting(ok, section, key, expected, found);
        let ratio = self.peak_ratio;
        require(ratio.is_finite() && ratio >= 1.0, "peak_ratio", "a number from 1", ratio.to_string())?;
        for (key, value) in [
            ("max_depth_m", self.max_depth_m),
            ("disparity_error_px", self.disparity_error_px),
            ("constant_variance_cells", self.constant_variance_cells),
        ] {
            require(positive(value), key, "a positive number", value.to_string())?;
        }
        let p = self.min_probability;
        require(p > 0.0 && p < 0.5, "min_probability", "a number between 0 and 0.5", p.to_string())?;
        let [min, max] = self.log_odds_bounds;
        let bounded = min.is_finite() && max.is_finite() && min < 0.0 && max > 0.0;
        require(bounded, "log_odds_bounds", "[below 0, above 0]", format!("[{min}, {max}]"))
    }

    /// The bounds of the fused map.
    pub fn clamp(&self) -> Clamp {
        Clamp { min: self.log_odds_bounds[0], max: self.log_odds_bounds[1] }
    }

    /// The bounds of the evidence of one frame.
    pub fn evidence_bounds(&self) -> Clamp {
        let [min, max] = self.log_odds_bounds;
        Clamp { min: min.max(logit(self.min_probability) as f32), max }
    }

    /// The limits that a match must keep to be believed.
    pub(super) fn match_limits(&self) -> MatchLimits {
        let left_right_px = self.left_right_check.then_some(self.left_right_tolerance_px);
        MatchLimits { peak_ratio: self.peak_ratio, ..MatchLimits::left_right(left_right_px) }
    }
}
