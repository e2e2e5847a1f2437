use evigrid_core::require_setting;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::StereoError;

/// Double correlation: every pixel is matched as part of an obstacle and as part of the road (Perrollaz et al. 2012,
/// 3.3).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DoubleCorrelationSettings {
    /// Edge of the square window over which absolute differences are summed; odd. Unit: px. Source: Perrollaz et
    /// al. 6.1 (21).
    pub window: usize,
    /// Whether disparities get a sub-pixel part, by a parabola through three costs. Unit: none. Source: Perrollaz
    /// et al. 5.2.1, 7 (whole disparities).
    pub sub_pixel: bool,
    /// Where the ground is: mounting, how the camera is said to stand over it; or v-disparity, the plane that most
    /// pixels of the frame agree on (height, pitch and roll), and the mounting in frames where too few do. Unit:
    /// none. Source: own choice (mounting); Labayrade et al. 2002 (v-disparity).
    pub ground: GroundSource,
    /// How far the disparity of the road may be from that of the ground. Unit: px. Source: own choice.
    pub road_tolerance_px: f64,
    /// How much farther it may be per pixel of disparity: a kerb of 12 cm shifts it by 11 %. Unit: none. Source:
    /// own choice (kerbs and pavements count as road).
    pub road_tolerance_share: f64,
}

/// Where the ground's disparities come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GroundSource {
    /// The mounting of the camera.
    #[default]
    Mounting,
    /// The frame itself.
    VDisparity,
}

impl Default for DoubleCorrelationSettings {
    fn default() -> Self {
        Self {
            window: 21,
            sub_pixel: false,
            ground: GroundSource::Mounting,
            road_tolerance_px: 1.0,
            road_tolerance_share: 0.12,
        }
    }
}

impl DoubleCorrelationSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If the window is even or over 255, or a tolerance is no finite number from 0 (at most 100 px, at most 1).
    pub fn checked(self) -> Result<Self, StereoError> {
        let require = |ok, key, expected: &str, found: String| {
            require_setting(ok, "stereo.double_correlation", key, expected, found)
        };
        let odd = self.window % 2 == 1 && self.window <= 255;
        require(odd, "window", "an odd number from 1 to 255", self.window.to_string())?;
        let (px, share) = (self.road_tolerance_px, self.road_tolerance_share);
        let possible = (0.0..=100.0).contains(&px);
        require(possible, "road_tolerance_px", "a number from 0 to 100", px.to_string())?;
        let possible = (0.0..=1.0).contains(&share);
        require(possible, "road_tolerance_share", "a number from 0 to 1", share.to_string())?;
        Ok(self)
    }

    /// Largest whole difference between the road's disparity and the ground's, pixels.
    pub(super) fn tolerance_px(&self, ground_px: f64) -> usize {
        (self.road_tolerance_px + self.road_tolerance_share * ground_px.max(0.0)).ceil() as usize
    }
}
