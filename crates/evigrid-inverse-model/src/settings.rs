//! The settings of the five methods. What all have in common is written once, by the macro below: each method has its own section, so that
//! methods can be run side by side with different settings.

use evigrid_core::StereoRig;
use evigrid_grid::{Clamp, logit, probability};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::require;
use crate::filter::Limits;
use crate::{BlurKind, LAYERS, NearPixels, PoseDeviation, SensorModel, SettingError, WindowCube};

/// Which cells a line has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Walk {
    /// Those of Bresenham's line in three dimensions, from the camera's cell to that of the point: one per step of the longest axis.
    Bresenham,
    /// All that the ray crosses (Amanatides and Woo 1987).
    Exact,
}

/// The image point that a pixel of a pyramid's layer stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BlockPoint {
    /// The first pixel of its block, 2^i x: what halving the image centre's coordinates comes to.
    Corner,
    /// The middle of its block, 2^i (x + 1/2) - 1/2.
    Centre,
}

/// A settings struct of some fields and those that all methods share.
macro_rules! settings {
    ($(#[$about:meta])* $name:ident, $method:literal, { $($(#[$doc:meta])* $field:ident: $type:ty = $value:expr,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
            /// Matches with a smaller peak ratio are dropped; 1 drops none. Unit: none. Source: as winner-take-all (Brandao et al. IV-B).
            pub peak_ratio: f64,
            /// Drop matches that the right image does not confirm. Unit: none. Source: as winner-take-all (Brandao et al. I-A).
            pub left_right_check: bool,
            /// Largest difference between the two winners that still counts as confirmed. Unit: px. Source: as winner-take-all.
            pub left_right_tolerance_px: u16,
            /// Depth at which the sensor's range ends; farther matches are free space up to there. Unit: m. Source: Andert 2009 VIII (25 m).
            pub max_depth_m: f64,
            /// Significance of one measurement: its peak is P = 0.5 + k / (dl sqrt(2 pi)). Unit: m. Source: Andert 2009 Fig. 1.
            pub k: f64,
            /// What becomes of pixels so near that with this k P would leave (0, 1), nearer than 7.9 m with KITTI's cameras: `limit` lowers their k
            /// so that their peak is the upper one of `log_odds_bounds`, `reject` drops them. The default keeps them, since near measurements
            /// are the most certain and nearest to harm. Unit: none. Source: own choice; Andert 2009 IV states the bound alone.
            pub near: NearPixels,
            /// P of a cell in front of what was measured, p_min. Unit: none. Source: Andert 2009 Fig. 1.
            pub min_probability: f64,
            /// Uncertainty of a disparity. Unit: px. Source: Andert 2009 III (0.5, "very conservative"; 1/16 and 0.2 from literature).
            pub disparity_error_px: f64,
            /// Blurs an image's grid before it is added: `none`, `constant` (blur_translation_m everywhere) or `distance` (grows with the distance
            /// from the camera, eq. 17). Unit: none. Source: Andert 2009 VII (Table I is without).
            pub blur: BlurKind,
            /// Standard deviation of the platform's position, the largest of the three axes. No kernel's deviation exceeds 16 cells. Unit: m. Source: Andert 2009 eq. 17; own value.
            pub blur_translation_m: f64,
            /// Standard deviation of the platform's attitude, the largest of the three axes. Unit: deg. Source: Andert 2009 eq. 17; own value.
            pub blur_angle_deg: f64,
            /// Bounds of the fused map, and of the evidence of one image. Unit: log-odds. Source: as winner-take-all.
            pub log_odds_bounds: [f32; 2],
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    $($field: $value,)*
                    peak_ratio: 1.5,
                    left_right_check: true,
                    left_right_tolerance_px: 1,
                    max_depth_m: 25.0,
                    k: 0.1,
                    near: NearPixels::Limit,
                    min_probability: 0.35,
                    disparity_error_px: 0.5,
                    blur: BlurKind::None,
                    blur_translation_m: 0.2,
                    blur_angle_deg: 1.0,
                    log_odds_bounds: [-5.0, 5.0],
                }
            }
        }

        impl $name {
            /// What all methods have in common.
            pub(crate) fn common(&self) -> Common {
                Common {
                    method: $method,
                    peak_ratio: self.peak_ratio,
                    left_right_px: self.left_right_check.then_some(self.left_right_tolerance_px),
                    max_depth_m: self.max_depth_m,
                    k: self.k,
                    near: self.near,
                    min_probability: self.min_probability,
                    disparity_error_px: self.disparity_error_px,
                    blur: self.blur,
                    blur_translation_m: self.blur_translation_m,
                    blur_angle_deg: self.blur_angle_deg,
                    log_odds_bounds: self.log_odds_bounds,
                }
            }
        }
    };
}

settings! {
    /// Line drawing (Andert 2009, section V-A).
    LineSettings, "line", {
        /// Which cells a line has: `bresenham` or `exact`. Unit: none. Source: Andert 2009 V-A (Bresenham); Amanatides and Woo 1987.
        walk: Walk = Walk::Bresenham,
    }
}

settings! {
    /// Line drawing with a pyramid of the smallest disparities (Andert 2009, section VI-B).
    LinePyramidSettings, "line-pyramid", {
        /// Which cells a line has: `bresenham` or `exact`. Unit: none. Source: Andert 2009 V-A (Bresenham); Amanatides and Woo 1987.
        walk: Walk = Walk::Bresenham,
        /// The lowest layer there is; lines are always drawn there. Below 0 the image is enlarged, so that the lines of neighbours are
        /// no more than a cell apart at the end of the sensor's range. Unit: none. Source: Andert 2009 VI-A (eq. 15); own value.
        lowest_layer: i32 = -2,
        /// The image point that a pixel of layer i stands for: `corner`, 2^i x, or `centre` of its block; the corner shifts the map by up to
        /// half a cell to the left and up. Unit: none. Source: Andert 2009 VI-B (the image centre's coordinates are halved: `corner`).
        block_point: BlockPoint = BlockPoint::Corner,
        /// Draw from a layer this many below the one of eq. 13: 4 times the lines for each. With 0, lines end up to a cell apart, so that in one
        /// image many a cell of a surface is passed by lines to what lies behind it and met by none that ends there. Unit: layers.
        /// Source: Andert 2009 eq. 13 (0).
        finer_layers: i32 = 0,
    }
}

settings! {
    /// Ray tracing (Andert 2009, section V-B).
    RaySettings, "ray", {
        /// The cube whose image is searched for the largest disparity: `cell`, or `metre` for one of 1 m. Unit: none.
        /// Source: Andert 2009 V-B, step 2c (its +-0.5 are cells, or metres).
        window: WindowCube = WindowCube::Cell,
    }
}

settings! {
    /// Ray tracing with a pyramid of the largest disparities (Andert 2009, section VI-C).
    RayPyramidSettings, "ray-pyramid", {}
}

settings! {
    /// Souza et al. 2012: line drawing under an error of the platform's motion.
    SouzaSettings, "souza", {
        /// Error of the platform's motion in every frame, eps of eq. 13. Unit: m. Source: Souza et al. 4.2 (no value published).
        motion_error_m: f64 = 0.0,
        /// What that error grows by per metre driven since the last frame. Unit: m/m. Source: Souza et al. 4.2 (no value published); own value,
        /// customary for wheel odometry.
        motion_error_per_m: f64 = 0.05,
        /// P of a cell before any measurement, p_0 of eq. 3. Unit: none. Source: Souza et al. eq. 3.
        prior_probability: f64 = 0.5,
        /// Map only the level of cells that holds the optical centre. Unit: none. Source: Souza et al. Fig. 7.
        slice: bool = false,
        /// Which cells a line has: `bresenham` or `exact`. Unit: none. Source: Andert 2009 V-A (Bresenham); Amanatides and Woo 1987.
        walk: Walk = Walk::Bresenham,
    }
}

/// The settings that all methods have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Common {
    pub method: &'static str,
    pub peak_ratio: f64,
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

impl Common {
    /// `Ok` if every setting is within its domain.
    fn check(&self) -> Result<(), SettingError> {
        let require = |ok, key, expected: &str, found: String| require(self.method, ok, key, expected, found);
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

    /// What a match must keep to be believed.
    pub fn limits(&self, model: &SensorModel, rig: &StereoRig) -> Limits {
        let too_near_px = match self.near {
            NearPixels::Limit => f64::INFINITY,
            NearPixels::Reject => rig.disparity_px(model.nearest_depth_m(rig)),
        };
        Limits { peak_ratio: self.peak_ratio, left_right_px: self.left_right_px, too_near_px }
    }
}

macro_rules! checked {
    ($($name:ident),*) => {$(
        impl $name {
            /// The same settings, once they are known to be possible.
            ///
            /// # Errors
            /// If one is outside its domain; the error names it, with the bound and the value.
            pub fn checked(self) -> Result<Self, SettingError> {
                self.common().check()?;
                self.check_own()?;
                Ok(self)
            }
        }
    )*};
}

checked!(LineSettings, LinePyramidSettings, RaySettings, RayPyramidSettings, SouzaSettings);

impl LineSettings {
    fn check_own(&self) -> Result<(), SettingError> {
        Ok(())
    }
}

impl LinePyramidSettings {
    fn check_own(&self) -> Result<(), SettingError> {
        let require = |ok, key, expected, found| require("line-pyramid", ok, key, expected, found);
        let (lowest, finer) = (self.lowest_layer, self.finer_layers);
        let expected = format!("a layer from {} to 0", LAYERS.start());
        require((*LAYERS.start()..=0).contains(&lowest), "lowest_layer", expected, lowest)?;
        require((0..=3).contains(&finer), "finer_layers", "a number from 0 to 3".to_owned(), finer)
    }
}

impl RaySettings {
    fn check_own(&self) -> Result<(), SettingError> {
        Ok(())
    }
}

impl RayPyramidSettings {
    fn check_own(&self) -> Result<(), SettingError> {
        Ok(())
    }
}

impl SouzaSettings {
    fn check_own(&self) -> Result<(), SettingError> {
        for (key, value) in
            [("motion_error_m", self.motion_error_m), ("motion_error_per_m", self.motion_error_per_m)]
        {
            require("souza", value.is_finite() && value >= 0.0, key, "a number from 0", value)?;
        }
        let (p, least) = (self.prior_probability, self.min_probability);
        // At or below p_min, free space would count as evidence of an obstacle.
        let expected = format!("a number between min_probability ({least}) and 1");
        require("souza", p > least && p < 1.0, "prior_probability", expected, p)?;
        let prior = logit(p) as f32;
        let [min, max] = self.log_odds_bounds;
        let expected = format!("a probability with log-odds within [{min}, {max}]");
        require("souza", (min..=max).contains(&prior), "prior_probability", expected, p)
    }
}
