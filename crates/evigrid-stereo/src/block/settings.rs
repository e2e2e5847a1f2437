use evigrid_core::{CostScale, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::StereoError;
use crate::pair_matcher::require_disparities;

/// Block matching by the sum of absolute differences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BlockMatchingSettings {
    /// Edge of the square window over which absolute differences are summed; odd. Unit: px. Source: Brandao
    /// et al. IV (7).
    pub window: usize,
    /// Smallest disparity that is tried; 0 is infinitely far. Unit: px. Source: own choice, so that the sky
    /// can say "far".
    pub min_disparity: usize,
    /// How many whole disparities are tried, from the smallest on. Unit: px. Source: own choice (KITTI: from
    /// 3 m on).
    pub disparities: usize,
}

impl Default for BlockMatchingSettings {
    fn default() -> Self {
        Self { window: 7, min_disparity: 0, disparities: 128 }
    }
}

impl BlockMatchingSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If the window is even or over 255, there are no hypotheses, or a disparity does not fit into 15 bits.
    pub fn checked(self) -> Result<Self, StereoError> {
        let odd = self.window % 2 == 1 && self.window <= 255;
        require_setting(odd, "stereo", "window", "an odd number from 1 to 255", self.window)?;
        require_disparities(self.min_disparity, self.disparities)?;
        Ok(self)
    }

    /// Unit of the costs: sums over a window, which are stored divided by a power of two if it is larger than
    /// 15x15.
    pub fn cost_scale(&self) -> CostScale {
        CostScale::of_square(self.window, self.cost_shift())
    }

    /// Pixels from the window's centre to its edge.
    pub(crate) fn radius(&self) -> usize {
        self.window / 2
    }

    /// Costs are stored as u16. The sum over a window of up to 15x15 fits; that over a larger one is stored
    /// divided by the smallest power of two that makes it fit. This is the exponent.
    pub(crate) fn cost_shift(&self) -> u32 {
        let largest = 255 * self.window * self.window;
        (0..32).find(|&s| (largest >> s) < usize::from(u16::MAX)).unwrap_or(31)
    }
}
