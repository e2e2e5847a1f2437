use evigrid_core::{CostScale, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::StereoError;

/// How well a pixel of the left image fits one of the right image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PixelCost {
    /// |left - right|, grey levels.
    AbsoluteDifference,
    /// Birchfield and Tomasi's (1998), which forgives half a pixel, of the clipped horizontal Sobel response,
    /// plus a quarter of that of the grey levels: what OpenCV's StereoSGBM takes.
    #[default]
    BirchfieldTomasi,
    /// Number of the 24 neighbours in 5 x 5 pixels that are darker than the centre in one image and not in
    /// the other (Zabih and Woodfill 1994). At most 24 a pixel, so the penalties must be smaller than for
    /// grey levels.
    Census,
}

/// Semi-global matching (Hirschmueller 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SemiGlobalSettings {
    /// Edge of the square over which pixel costs are summed; odd. Unit: px. Source: OpenCV (StereoSGBM: 3 to
    /// 11; its samples: 5).
    pub block: usize,
    /// absolute-difference, birchfield-tomasi (on Sobel response and grey levels) or census (5 x 5). Unit:
    /// none. Source: OpenCV.
    pub pixel_cost: PixelCost,
    /// Largest Sobel response that birchfield-tomasi sees; larger ones are clipped. Unit: grey levels.
    /// Source: OpenCV (preFilterCap).
    pub sobel_cap: usize,
    /// Penalty for a step of one disparity between neighbours on a path. Unit: cost of a block. Source:
    /// OpenCV (8 block^2).
    pub p1: usize,
    /// Penalty for any larger step; at least p1. Unit: cost of a block. Source: OpenCV (32 block^2).
    pub p2: usize,
    /// Divide p2 by the difference of the two neighbours in the image that is matched (grey levels, unless it
    /// was pre-filtered), but not below p1. Unit: none. Source: Hirschmueller 2008, II-B.
    pub adapt_p2: bool,
    /// Directions from which paths arrive: 4 (along rows and columns) or 8 (and diagonals). Unit: none.
    /// Source: Hirschmueller 2008 (at least 8).
    pub paths: usize,
}

impl Default for SemiGlobalSettings {
    fn default() -> Self {
        Self {
            block: 5,
            pixel_cost: PixelCost::BirchfieldTomasi,
            sobel_cap: 31,
            p1: 200,
            p2: 800,
            adapt_p2: false,
            paths: 8,
        }
    }
}

/// Largest cost of a path, so that eight of them fit into 16 bits.
const MAX_PATH_COST: usize = (u16::MAX as usize - 1) / 8;

impl SemiGlobalSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If the block is even or over 15, the Sobel cap is not within 1..=96, p2 is below p1 or over 65535, or
    /// the number of paths is neither 4 nor 8.
    pub fn checked(self) -> Result<Self, StereoError> {
        let Self { block, sobel_cap: cap, p1, p2, paths, .. } = self;
        let require =
            |ok, key, expected: &str, found: usize| require_setting(ok, "stereo", key, expected, found);
        let odd = block % 2 == 1 && block <= 15;
        require(odd, "semi_global.block", "an odd number from 1 to 15", block)?;
        require((1..=96).contains(&cap), "semi_global.sobel_cap", "a number from 1 to 96", cap)?;
        let p2_fits = p1 <= p2 && p2 <= 65535;
        require(p2_fits, "semi_global.p2", "a number from semi_global.p1 to 65535", p2)?;
        require(matches!(paths, 4 | 8), "semi_global.paths", "4 or 8", paths)?;
        Ok(self)
    }

    /// Unit of the costs: sums over a block, divided by a power of two where they would not fit into 16 bits.
    /// The penalties on the paths add to it.
    pub fn cost_scale(&self) -> CostScale {
        CostScale::of_square(self.block, self.cost_shift())
    }

    /// Pixels from the block's centre to its edge.
    pub(super) fn radius(&self) -> usize {
        self.block / 2
    }

    /// The largest cost of a pixel.
    fn max_pixel_cost(&self) -> usize {
        match self.pixel_cost {
            PixelCost::AbsoluteDifference => 255,
            PixelCost::BirchfieldTomasi => 2 * self.sobel_cap + 255 / 4,
            PixelCost::Census => 24,
        }
    }

    /// Costs and penalties are divided by the smallest power of two with which eight path costs fit into u16.
    /// This is the exponent: 0 for the defaults.
    pub(super) fn cost_shift(&self) -> u32 {
        let cost = self.max_pixel_cost() * self.block * self.block;
        (0..usize::BITS).find(|&s| (cost >> s) + (self.p2 >> s) <= MAX_PATH_COST).unwrap_or(0)
    }
}
