use evigrid_core::{CostScale, MatchLimits, SettingError, require_setting};
use evigrid_grid::{Clamp, logit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mapping from whole cost curves by Bayes' rule (docs/cost-curve-bayes.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CostCurveBayesSettings {
    /// Probability that a cell is occupied before anything is known of it; unknown cells start from it.
    /// Unit: none. Source: own choice, on the worlds bars and street (docs/cost-curve-bayes.md).
    pub cell_prior: f64,
    /// Share of pixels whose costs say nothing of the disparity.
    /// Unit: none. Source: Perrollaz et al. 2012 (P_FP = P_FN = 0.02).
    pub outlier_share: f64,
    /// Edge of the squares of pixels that count as one look; 0: the matching window.
    /// Unit: px. Source: docs/cost-curve-bayes.md, step 5.
    pub look_px: usize,
    /// Leave out pixels whose winner the right image does not confirm. Unit: none. Source: customary.
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed.
    /// Unit: px. Source: customary.
    pub left_right_tolerance_px: u16,
    /// Depth up to which evidence is drawn. Unit: m. Source: own choice, as winner-take-all.
    pub max_depth_m: f64,
    /// Bounds of the fused map. Unit: log-odds. Source: own choice, symmetric (P 0.0067 and 0.9933).
    pub log_odds_bounds: [f32; 2],
}

impl Default for CostCurveBayesSettings {
    fn default() -> Self {
        Self {
            cell_prior: 0.05,
            outlier_share: 0.02,
            look_px: 0,
            left_right_check: true,
            left_right_tolerance_px: 1,
            max_depth_m: 25.0,
            log_odds_bounds: [-5.0, 5.0],
        }
    }
}

impl CostCurveBayesSettings {
    /// `Ok` if every setting is within its domain, else the error that names it within `section`.
    pub(super) fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let require = |ok, key, expected, found: String| require_setting(ok, section, key, expected, found);
        for (key, p) in [("cell_prior", self.cell_prior), ("outlier_share", self.outlier_share)] {
            require((1e-6..=0.5).contains(&p), key, "a number from 0.000001 to 0.5", p.to_string())?;
        }
        let depth = self.max_depth_m;
        let expected = "a positive number up to 1000";
        require(depth > 0.0 && depth <= 1000.0, "max_depth_m", expected, depth.to_string())?;
        require(self.look_px <= 255, "look_px", "a number from 0 to 255", self.look_px.to_string())?;
        let [min, max] = self.log_odds_bounds;
        let bounded = (-40.0..self.prior_log_odds()).contains(&min) && max > 0.0 && max <= 40.0;
        let expected = "[-40 to below the log-odds of cell_prior, above 0 to 40]";
        require(bounded, "log_odds_bounds", expected, format!("[{min}, {max}]"))
    }

    /// The bounds of the fused map.
    pub fn clamp(&self) -> Clamp {
        Clamp { min: self.log_odds_bounds[0], max: self.log_odds_bounds[1] }
    }

    /// Log-odds of every cell before the first frame.
    pub fn prior_log_odds(&self) -> f32 {
        logit(self.cell_prior) as f32
    }

    /// Prior probability that a cell stops a ray that reaches it: an occupied cell stops half of the rays,
    /// the mean over all shares of it that may be filled.
    pub fn stopping_prior(&self) -> f64 {
        0.5 * self.cell_prior
    }

    /// Edge of a look, pixels, for costs of this scale.
    pub(super) fn look_edge_px(&self, scale: CostScale) -> usize {
        if self.look_px > 0 { self.look_px } else { scale.window_edge_px() }
    }

    /// Largest left-right difference of a pixel that counts; `None` if nobody asks the right image.
    pub(super) fn left_right_px(&self) -> Option<u16> {
        self.left_right_check.then_some(self.left_right_tolerance_px)
    }

    /// The limits that a pixel's winner must keep for the pixel to count.
    pub(super) fn match_limits(&self) -> MatchLimits {
        MatchLimits::left_right(self.left_right_px())
    }
}
