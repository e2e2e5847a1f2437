use evigrid_core::{MatchLimits, SettingError, StereoRig, require_setting};
use evigrid_grid::{Clamp, probability};

use crate::blur::{BlurKind, PoseDeviation};
use crate::model::{NearPixels, SensorModel};

/// The settings that all methods share. Their meanings, units and sources stand at the fields of each
/// method's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SharedSettings {
    pub peak_ratio: f64,
    /// Largest left-right difference of a match, pixels; `None` if nobody asks the right image.
    pub left_right_px: Option<u16>,
    pub max_depth_m: f64,
    pub k: f64,
    pub near: NearPixels,
    pub min_probability: f64,
    pub disparity_error_px: f64,
    pub blur: BlurKind,
    pub blur_translation_m: f64,
    pub blur_angle_deg: f64,
    pub log_odds_bounds: [f32; 2],
}

impl SharedSettings {
    /// `Ok` if every setting is within its domain, else the error that names it within `section`.
    pub fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let require = |ok, key, expected, found: String| require_setting(ok, section, key, expected, found);
        let positive = |v: f64| v.is_finite() && v > 0.0;
        let ratio = self.peak_ratio;
        require(ratio.is_finite() && ratio >= 1.0, "peak_ratio", "a number from 1", ratio.to_string())?;
        for (key, value) in [
            ("max_depth_m", self.max_depth_m),
            ("k", self.k),
            ("disparity_error_px", self.disparity_error_px),
        ] {
            require(positive(value), key, "a positive number", value.to_string())?;
        }
        let depth = self.max_depth_m;
        require(depth <= 10_000.0, "max_depth_m", "a number up to 10000", depth.to_string())?;
        let p = self.min_probability;
        require(p > 0.0 && p < 0.5, "min_probability", "a number between 0 and 0.5", p.to_string())?;
        for (key, value) in
            [("blur_translation_m", self.blur_translation_m), ("blur_angle_deg", self.blur_angle_deg)]
        {
            require(value.is_finite() && value >= 0.0, key, "a number from 0", value.to_string())?;
        }
        let [min, max] = self.log_odds_bounds;
        let bounded = min.is_finite() && max.is_finite() && min < 0.0 && max > 0.0 && max <= 15.0;
        require(bounded, "log_odds_bounds", "[below 0, above 0 and up to 15]", format!("[{min}, {max}]"))
    }

    /// How uncertain the platform's pose is (eq. 17).
    pub fn pose_deviation(&self) -> PoseDeviation {
        PoseDeviation {
            kind: self.blur,
            translation_m: self.blur_translation_m,
            angle: self.blur_angle_deg.to_radians(),
        }
    }

    /// The bounds of the fused map.
    pub fn clamp(&self) -> Clamp {
        Clamp { min: self.log_odds_bounds[0], max: self.log_odds_bounds[1] }
    }

    /// The inverse model under an error of the platform's motion in metres.
    pub fn model(&self, motion_error_m: f64) -> SensorModel {
        let largest = probability(f64::from(self.log_odds_bounds[1])) - 0.5;
        SensorModel {
            k: self.k,
            // No image says less than the map's lower bound.
            min_probability: self.min_probability.max(probability(f64::from(self.log_odds_bounds[0]))),
            disparity_error_px: self.disparity_error_px,
            motion_error_m,
            near: self.near,
            max_peak: largest,
            max_depth_m: self.max_depth_m,
        }
    }

    /// The limits that a match must keep to be believed.
    pub fn match_limits(&self, model: &SensorModel, rig: &StereoRig) -> MatchLimits {
        let too_near_px = match self.near {
            NearPixels::Limit => f64::INFINITY,
            NearPixels::Reject => rig.disparity_px(model.nearest_depth_m(rig)),
        };
        MatchLimits { peak_ratio: self.peak_ratio, left_right_px: self.left_right_px, too_near_px }
    }
}
