//! The settings of the five methods. Each method has its own section, so that methods can be run side by side
//! with different settings; the settings that all of them share are written once, by a macro.

mod shared;

use evigrid_core::{SettingError, require_setting};
use evigrid_grid::logit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(crate) use shared::SharedSettings;

use crate::blur::BlurKind;
use crate::layers::LAYERS;
use crate::model::NearPixels;
use crate::window::WindowCube;

/// The cells that a line has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Walk {
    /// The cells of Bresenham's line in three dimensions, from the camera's cell to that of the point: one
    /// per step of the longest axis.
    Bresenham,
    /// All cells that the ray crosses (Amanatides and Woo 1987).
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

/// The doc comment of `walk`, which several methods have.
macro_rules! walk_doc {
    () => {
        "Cells that a line has: `bresenham` or `exact`. Unit: none. \
         Source: Andert 2009 V-A (Bresenham); Amanatides and Woo 1987."
    };
}

/// A settings struct of some fields and of those that all methods share.
macro_rules! settings {
    (
        $(#[$about:meta])*
        $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty = $value:expr,)* }
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
            /// Matches with a smaller peak ratio are dropped; 1 drops none.
            /// Unit: none. Source: as winner-take-all (Brandao et al. IV-B).
            pub peak_ratio: f64,
            /// Drop matches that the right image does not confirm.
            /// Unit: none. Source: as winner-take-all (Brandao et al. I-A).
            pub left_right_check: bool,
            /// Largest difference between the two winners that still counts as confirmed.
            /// Unit: px. Source: as winner-take-all.
            pub left_right_tolerance_px: u16,
            /// Depth at which the sensor's range ends; farther matches are free space up to there.
            /// Unit: m. Source: Andert 2009 VIII (25 m).
            pub max_depth_m: f64,
            /// Significance of one measurement: its peak is P = 0.5 + k / (dl sqrt(2 pi)).
            /// Unit: m. Source: Andert 2009 Fig. 1.
            pub k: f64,
            /// Treatment of pixels so near that with this k P would leave (0, 1), nearer than 7.9 m with
            /// KITTI's cameras: `limit` lowers their k so that their peak is the upper one of
            /// `log_odds_bounds`, `reject` drops them. The default keeps them, since near measurements are
            /// the most certain and nearest to harm.
            /// Unit: none. Source: own choice; Andert 2009 IV states the bound alone.
            pub near: NearPixels,
            /// P of a cell in front of a measurement, p_min. Unit: none. Source: Andert 2009 Fig. 1.
            pub min_probability: f64,
            /// Uncertainty of a disparity.
            /// Unit: px. Source: Andert 2009 III (0.5, "very conservative"; 1/16 and 0.2 from literature).
            pub disparity_error_px: f64,
            /// Blurs an image's grid before it is added: `none`, `constant` (blur_translation_m everywhere)
            /// or `distance` (grows with the distance from the camera, eq. 17).
            /// Unit: none. Source: Andert 2009 VII (Table I is without).
            pub blur: BlurKind,
            /// Standard deviation of the platform's position, the largest of the three axes. No kernel's
            /// deviation exceeds 16 cells. Unit: m. Source: Andert 2009 eq. 17; own value.
            pub blur_translation_m: f64,
            /// Standard deviation of the platform's attitude, the largest of the three axes.
            /// Unit: deg. Source: Andert 2009 eq. 17; own value.
            pub blur_angle_deg: f64,
            /// Bounds of the fused map, and of the evidence of one image.
            /// Unit: log-odds. Source: as winner-take-all.
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
            /// The settings that all methods share.
            pub(crate) fn shared(&self) -> SharedSettings {
                SharedSettings {
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
    LineSettings {
        #[doc = walk_doc!()]
        walk: Walk = Walk::Bresenham,
    }
}

settings! {
    /// Line drawing with a pyramid of the smallest disparities (Andert 2009, section VI-B).
    LinePyramidSettings {
        #[doc = walk_doc!()]
        walk: Walk = Walk::Bresenham,
        /// The lowest layer there is; lines are always drawn there. Below 0 the image is enlarged, so that
        /// the lines of neighbours are no more than a cell apart at the end of the sensor's range.
        /// Unit: none. Source: Andert 2009 VI-A (eq. 15); own value.
        lowest_layer: i32 = -2,
        /// The image point that a pixel of layer i stands for: `corner`, 2^i x, or `centre` of its block; the
        /// corner shifts the map by up to half a cell to the left and up.
        /// Unit: none. Source: Andert 2009 VI-B (the image centre's coordinates are halved: `corner`).
        block_point: BlockPoint = BlockPoint::Corner,
        /// Draw from a layer this many below the one of eq. 13: 4 times the lines for each. With 0, lines end
        /// up to a cell apart, so that in one image many a cell of a surface is passed by lines to places
        /// behind it and met by none that ends there. Unit: layers. Source: Andert 2009 eq. 13 (0).
        finer_layers: i32 = 0,
    }
}

settings! {
    /// Ray tracing (Andert 2009, section V-B).
    RaySettings {
        /// The cube whose image is searched for the largest disparity: `cell`, or `metre` for one of 1 m.
        /// Unit: none. Source: Andert 2009 V-B, step 2c (its +-0.5 are cells, or metres).
        window: WindowCube = WindowCube::Cell,
    }
}

settings! {
    /// Ray tracing with a pyramid of the largest disparities (Andert 2009, section VI-C).
    RayPyramidSettings {}
}

settings! {
    /// Souza et al. 2012: line drawing under an error of the platform's motion.
    SouzaSettings {
        /// Error of the platform's motion in every frame, eps of eq. 13.
        /// Unit: m. Source: Souza et al. 4.2 (no value published).
        motion_error_m: f64 = 0.0,
        /// Growth of the error of the platform's motion per metre driven since the last frame.
        /// Unit: m/m. Source: Souza et al. 4.2 (no value published); own value, customary for wheel odometry.
        motion_error_per_m: f64 = 0.05,
        /// P of a cell before any measurement, p_0 of eq. 3. Unit: none. Source: Souza et al. eq. 3.
        prior_probability: f64 = 0.5,
        /// Map only the level of cells that holds the optical centre.
        /// Unit: none. Source: Souza et al. Fig. 7.
        slice: bool = false,
        #[doc = walk_doc!()]
        walk: Walk = Walk::Bresenham,
    }
}

impl LinePyramidSettings {
    /// `Ok` if the settings of the pyramid are within their domains.
    pub(crate) fn check_layers(&self, section: &'static str) -> Result<(), SettingError> {
        let (lowest, finer) = (self.lowest_layer, self.finer_layers);
        let expected = format!("a layer from {} to 0", LAYERS.start());
        let possible = (*LAYERS.start()..=0).contains(&lowest);
        require_setting(possible, section, "lowest_layer", expected, lowest)?;
        require_setting((0..=3).contains(&finer), section, "finer_layers", "a number from 0 to 3", finer)
    }
}

impl SouzaSettings {
    /// `Ok` if the settings of motion and prior are within their domains.
    pub(crate) fn check_motion(&self, section: &'static str) -> Result<(), SettingError> {
        for (key, value) in
            [("motion_error_m", self.motion_error_m), ("motion_error_per_m", self.motion_error_per_m)]
        {
            let possible = value.is_finite() && value >= 0.0;
            require_setting(possible, section, key, "a number from 0", value)?;
        }
        let (p, least) = (self.prior_probability, self.min_probability);
        // At or below p_min, free space would count as evidence of an obstacle.
        let expected = format!("a number between min_probability ({least}) and 1");
        require_setting(p > least && p < 1.0, section, "prior_probability", expected, p)?;
        let prior = logit(p) as f32;
        let [min, max] = self.log_odds_bounds;
        let expected = format!("a probability with log-odds within [{min}, {max}]");
        require_setting((min..=max).contains(&prior), section, "prior_probability", expected, p)
    }
}
