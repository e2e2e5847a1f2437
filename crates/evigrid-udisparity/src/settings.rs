use evigrid_core::{MatchLimits, SettingError, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::filter::{FilterForm, FilterSettings};
use crate::probability::Parameters;

/// Settings of `visibility`. The defaults are the paper's parameters; where the paper is silent, the source says so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VisibilitySettings {
    /// Matches with a smaller peak ratio are dropped; 1 drops none. Unit: none. Source: own choice.
    pub peak_ratio: f64,
    /// Drop matches that the right image does not confirm. Unit: none. Source: own choice.
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed. Unit: px. Source: own choice.
    pub left_right_tolerance_px: u16,
    /// Largest height over the ground that is looked at (h). Unit: m. Source: Perrollaz et al. 2012, 6.1.
    pub top_m: f64,
    /// Probability of an obstacle match where there is none (P_FP). Unit: none. Source: Perrollaz et al. 2012, 6.1.
    pub false_positive: f64,
    /// Probability of no obstacle match where there is one (P_FN). Unit: none. Source: Perrollaz et al. 2012, 6.1.
    pub false_negative: f64,
    /// Share of observed among visible pixels that gives 63 % of confidence (tau_O). Unit: none. Source: Perrollaz
    /// et al. 2012, 6.1.
    pub tau_obstacle: f64,
    /// Share of missing road neighbours that takes 63 % of the road's confidence (tau_R). Unit: none. Source:
    /// Perrollaz et al. 2012, 6.1.
    pub tau_road: f64,
    /// Road pixels that are farther than a cell count as visible too; the paper's "visible" ignores them. Unit: none.
    /// Source: own choice (off).
    pub count_road: bool,
    /// Standard deviation of the Gaussian along columns; 0: none. Unit: px. Source: own choice, a sixth of the
    /// correlation window (Perrollaz et al. 2012, 5.2.1, ties it to the window, without a number).
    pub sigma_u_px: f64,
    /// Standard deviation of the Gaussian along disparities; 0: none. Unit: px. Source: Perrollaz et al. 2012, 5.2.1.
    pub sigma_d_px: f64,
    /// Whether the grid goes with the vehicle, by whole cells; its area is that of the grid as the first camera sees
    /// it. Unit: none. Source: own choice.
    pub rolls: bool,
    /// none; or the Bayesian occupancy filter in one of its forms, mass-conserving or normalised. Unit: none. Source:
    /// Coue et al. 2006 (mass-conserving: own choice); Tay et al. 2008 (normalised).
    pub filter: FilterForm,
    /// Velocities of the filter along each axis, as many on both sides of 0. Unit: none. Source: own choice.
    pub velocities: usize,
    /// Difference between neighbouring velocities. Unit: m/s. Source: own choice.
    pub velocity_step_mps: f64,
    /// Of what is not yet known to move: the share that stands. Unit: none. Source: own choice.
    pub static_share: f64,
    /// Rate at which what moves changes its velocity to a neighbouring one. Unit: 1/s. Source: own choice.
    pub velocity_change_per_s: f64,
    /// Power of the evidence of one frame: neighbouring frames err alike. Unit: none. Source: own choice.
    pub observation_weight: f64,
    /// Least and largest P(occupied) of a cell that is observed, so that it can change its mind. Unit: none. Source:
    /// own choice (P_FN and 1 - P_FP).
    pub filter_bounds: [f64; 2],
}

impl Default for VisibilitySettings {
    fn default() -> Self {
        Self {
            peak_ratio: 1.0,
            left_right_check: true,
            left_right_tolerance_px: 1,
            top_m: 1.8,
            false_positive: 0.02,
            false_negative: 0.02,
            tau_obstacle: 0.1,
            tau_road: 0.1,
            count_road: false,
            sigma_u_px: 3.5,
            sigma_d_px: 0.5,
            rolls: true,
            filter: FilterForm::None,
            velocities: 7,
            velocity_step_mps: 3.0,
            static_share: 0.8,
            velocity_change_per_s: 1.0,
            observation_weight: 0.7,
            filter_bounds: [0.02, 0.98],
        }
    }
}

impl VisibilitySettings {
    /// `Ok` if the settings are possible.
    ///
    /// # Errors
    /// If one is outside its domain; named as a setting of `section`.
    pub fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let ratio = self.peak_ratio;
        require_setting(ratio >= 1.0, section, "peak_ratio", "a number from 1", ratio)?;
        let positive =
            |key, v: f64| require_setting(v.is_finite() && v > 0.0, section, key, "a positive number", v);
        positive("top_m", self.top_m)?;
        positive("tau_obstacle", self.tau_obstacle)?;
        positive("tau_road", self.tau_road)?;
        let share = |key, v: f64| {
            require_setting((0.0..0.5).contains(&v), section, key, "a number from 0 and below 0.5", v)
        };
        share("false_positive", self.false_positive)?;
        share("false_negative", self.false_negative)?;
        let deviation = |key, v: f64| {
            require_setting((0.0..=100.0).contains(&v), section, key, "a number from 0 to 100", v)
        };
        deviation("sigma_u_px", self.sigma_u_px)?;
        deviation("sigma_d_px", self.sigma_d_px)?;
        self.filter_settings().check(section)
    }

    /// The limits that matches must keep.
    pub(crate) fn limits(&self) -> MatchLimits {
        let left_right_px = self.left_right_check.then_some(self.left_right_tolerance_px);
        MatchLimits { peak_ratio: self.peak_ratio, ..MatchLimits::left_right(left_right_px) }
    }

    /// The parameters of the model.
    pub fn parameters(&self) -> Parameters {
        let Self { false_positive, false_negative, tau_obstacle, tau_road, .. } = *self;
        Parameters { false_positive, false_negative, tau_obstacle, tau_road }
    }

    /// The numbers of the filter.
    pub fn filter_settings(&self) -> FilterSettings {
        FilterSettings {
            form: self.filter,
            velocities: self.velocities,
            step_mps: self.velocity_step_mps,
            static_share: self.static_share,
            change_per_s: self.velocity_change_per_s,
            weight: self.observation_weight,
            bounds: self.filter_bounds,
        }
    }
}

/// Settings of `visibility-filtered`: those of `visibility`, with its filter on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct VisibilityFilteredSettings(pub VisibilitySettings);

impl Default for VisibilityFilteredSettings {
    fn default() -> Self {
        Self(VisibilitySettings { filter: FilterForm::MassConserving, ..VisibilitySettings::default() })
    }
}

/// Settings of `ternary`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TernarySettings {
    /// Matches with a smaller peak ratio are dropped; 1 drops none. Unit: none. Source: own choice.
    pub peak_ratio: f64,
    /// Drop matches that the right image does not confirm. Unit: none. Source: own choice.
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed. Unit: px. Source: own choice.
    pub left_right_tolerance_px: u16,
    /// A detected cell has P = 1 - this. Unit: none. Source: Perrollaz et al. 2012, 6.1 (P_FP).
    pub false_positive: f64,
    /// A cell in front of it has P = this. Unit: none. Source: Perrollaz et al. 2012, 6.2 (P_FN).
    pub false_negative: f64,
    /// Whether the grid goes with the vehicle, by whole cells. Unit: none. Source: own choice.
    pub rolls: bool,
}

impl Default for TernarySettings {
    fn default() -> Self {
        let of = VisibilitySettings::default();
        Self {
            peak_ratio: of.peak_ratio,
            left_right_check: of.left_right_check,
            left_right_tolerance_px: of.left_right_tolerance_px,
            false_positive: of.false_positive,
            false_negative: of.false_negative,
            rolls: of.rolls,
        }
    }
}

impl TernarySettings {
    /// The settings of `visibility` that say the same.
    pub(crate) fn as_visibility(&self) -> VisibilitySettings {
        VisibilitySettings {
            peak_ratio: self.peak_ratio,
            left_right_check: self.left_right_check,
            left_right_tolerance_px: self.left_right_tolerance_px,
            false_positive: self.false_positive,
            false_negative: self.false_negative,
            rolls: self.rolls,
            ..VisibilitySettings::default()
        }
    }
}
