use evigrid_core::require_setting;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::block::BlockMatchingSettings;
use crate::error::StereoError;

/// Block matching at several scales (Small Vision System; Murarka and Kuipers 2009, III).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MultiScaleSettings {
    /// How many scales are matched: 2 are the pair and the pair halved, 3 also the pair halved twice. Unit:
    /// none. Source: Small Vision System, user's manual 3.5 (2).
    pub scales: usize,
    /// Largest difference between the winners of the left and the right image of a reliable match. Unit: px
    /// of its scale. Source: Small Vision System, user's manual 2.5 (left/right filter; the value is our
    /// own).
    pub left_right_px: usize,
    /// A match is not reliable if a hypothesis that is no neighbour of the winner costs less than 100 / (100
    /// - this) times as much; 0: all are. Unit: percent. Source: OpenCV (uniquenessRatio: 5 to 15).
    pub uniqueness_percent: usize,
    /// A match is not reliable if the absolute Sobel responses of the left window at its scale sum to less;
    /// 0: all are. (stereo.texture_threshold asks the full resolution alone, and so drops what a coarser
    /// scale has filled in.) Unit: grey levels. Source: OpenCV (textureThreshold: 10); Small Vision System,
    /// user's manual 2.5 (confidence filter).
    pub texture_threshold: usize,
}

impl Default for MultiScaleSettings {
    fn default() -> Self {
        Self { scales: 2, left_right_px: 1, uniqueness_percent: 10, texture_threshold: 10 }
    }
}

impl MultiScaleSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If there are neither 2 nor 3 scales, the left-right difference is over 4096 or the uniqueness over 99.
    pub fn checked(self) -> Result<Self, StereoError> {
        let Self { scales, left_right_px, uniqueness_percent: percent, .. } = self;
        let require =
            |ok, key, expected: &str, found: usize| require_setting(ok, "stereo", key, expected, found);
        require(matches!(scales, 2 | 3), "multi_scale.scales", "2 or 3", scales)?;
        let possible = left_right_px <= 4096;
        require(possible, "multi_scale.left_right_px", "a number from 0 to 4096", left_right_px)?;
        require(percent < 100, "multi_scale.uniqueness_percent", "a number from 0 to 99", percent)?;
        Ok(self)
    }
}

/// Block matching of a pair that is half as large: the same window, and the disparities that lie, doubled,
/// within the range, or just outside of it.
pub(crate) fn halved_hypotheses(block: BlockMatchingSettings) -> BlockMatchingSettings {
    let min_disparity = block.min_disparity / 2;
    let largest = (block.min_disparity + block.disparities - 1).div_ceil(2);
    BlockMatchingSettings { min_disparity, disparities: largest - min_disparity + 1, ..block }
}
