use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{BlockMatchingSettings, GraphCutSettings, PreFilter, SemiGlobalSettings, StereoError};

/// How pairs are matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MatcherKind {
    /// Winner-take-all over sums of absolute differences in a window.
    #[default]
    Block,
    /// Block costs summed along paths on which steps are penalised (Hirschmueller 2008).
    SemiGlobal,
    /// One energy of the whole image lowered by minimum cuts, with occlusions (Kolmogorov and Zabih 2001).
    GraphCuts,
}

impl MatcherKind {
    /// Whether it has a cost volume to give away.
    pub fn has_volume(self) -> bool {
        self != Self::GraphCuts
    }
}

/// Matching: the matcher, its hypotheses, and the filters before and after it, all of which are off by default.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StereoSettings {
    /// block, semi-global or graph-cuts. Unit: none. Source: Brandao et al. IV (block); Souza et al. 4.1 (block, graph-cuts).
    pub matcher: MatcherKind,
    /// Edge of the square window over which absolute differences are summed (matcher block), and of that of the texture; odd. Unit: px. Source: Brandao et al. IV (7).
    pub window: usize,
    /// Smallest disparity that is tried; 0 is infinitely far. Unit: px. Source: own choice, so that the sky can say "far".
    pub min_disparity: usize,
    /// How many whole disparities are tried, from the smallest on. Unit: px. Source: own choice (KITTI: from 3 m on).
    pub disparities: usize,
    /// What both images go through before matching: none, sobel-x or normalized. Unit: none. Source: Souza et al. 4.1, OpenCV.
    pub pre_filter: PreFilter,
    /// Largest response of the pre-filter and of the texture's Sobel filter; larger ones are clipped. Unit: grey levels. Source: OpenCV (preFilterCap).
    pub pre_filter_cap: usize,
    /// Edge of the window whose mean is taken off by the pre-filter normalized; odd. Unit: px. Source: OpenCV (preFilterSize).
    pub pre_filter_window: usize,
    /// Drop matches where the absolute Sobel responses of the left window sum to less; 0: none. Unit: grey levels. Source: OpenCV (textureThreshold).
    pub texture_threshold: usize,
    /// Drop matches for which a hypothesis that is no neighbour of the winner costs less than 100 / (100 - this) times as much; 0: none. Matchers block and semi-global. Unit: percent. Source: OpenCV (uniquenessRatio: 5 to 15).
    pub uniqueness_percent: usize,
    /// Drop connected regions of at most so many pixels, before the methods' left-right check (OpenCV: after it); 0: none. Unit: pixels. Source: OpenCV (speckleWindowSize: 50 to 200).
    pub speckle_pixels: usize,
    /// Largest step of the disparity between neighbours of one region. Unit: px. Source: OpenCV (speckleRange: 1 or 2).
    pub speckle_step_px: f32,
    /// Matcher semi-global. Unit: none. Source: Hirschmueller 2008.
    pub semi_global: SemiGlobalSettings,
    /// Matcher graph-cuts. Unit: none. Source: Kolmogorov and Zabih 2001.
    pub graph_cuts: GraphCutSettings,
}

impl Default for StereoSettings {
    fn default() -> Self {
        let BlockMatchingSettings { window, min_disparity, disparities } = BlockMatchingSettings::default();
        Self {
            matcher: MatcherKind::Block,
            window,
            min_disparity,
            disparities,
            pre_filter: PreFilter::None,
            pre_filter_cap: 31,
            pre_filter_window: 9,
            texture_threshold: 0,
            uniqueness_percent: 0,
            speckle_pixels: 0,
            speckle_step_px: 1.0,
            semi_global: SemiGlobalSettings::default(),
            graph_cuts: GraphCutSettings::default(),
        }
    }
}

/// What the numbers of a matcher's cost volume stand for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostUnit {
    /// Pixels over which pixel costs are summed.
    pub pixels: f64,
    /// Units of the pixel cost (grey levels, unless images are filtered or the pixel cost is another) per unit of the
    /// volume.
    pub levels: f64,
}

impl StereoSettings {
    /// The same settings, once they are known to be possible.
    ///
    /// # Errors
    /// If one is outside its domain; those of the matcher that is not used count too.
    pub fn checked(self) -> Result<Self, StereoError> {
        self.block().checked()?;
        self.semi_global.checked()?;
        self.graph_cuts.checked()?;
        let require = |ok: bool, key, expected, found| {
            if ok { Ok(()) } else { Err(StereoError::Setting { key, expected, found }) }
        };
        let cap = self.pre_filter_cap;
        require((1..=127).contains(&cap), "pre_filter_cap", "a number from 1 to 127", cap)?;
        let window = self.pre_filter_window;
        let odd = window % 2 == 1 && window <= 255;
        require(odd, "pre_filter_window", "an odd number from 1 to 255", window)?;
        let percent = self.uniqueness_percent;
        require(percent < 100, "uniqueness_percent", "a number from 0 to 99", percent)?;
        if !(self.speckle_step_px >= 0.0 && self.speckle_step_px.is_finite()) {
            return Err(StereoError::SpeckleStep { found: self.speckle_step_px });
        }
        Ok(self)
    }

    /// The settings of block matching.
    pub fn block(&self) -> BlockMatchingSettings {
        let Self { window, min_disparity, disparities, .. } = *self;
        BlockMatchingSettings { window, min_disparity, disparities }
    }

    /// What the numbers of the cost volume stand for. Under semi-global matching, whose volume is the mean over the
    /// paths, it is the cost of one block; penalties on the paths add to it. Graph cuts have
    /// none.
    pub fn cost_unit(&self) -> CostUnit {
        let (edge, shift) = match self.matcher {
            MatcherKind::Block => (self.window, self.block().cost_shift()),
            MatcherKind::SemiGlobal => (self.semi_global.block, self.semi_global.cost_shift()),
            MatcherKind::GraphCuts => (1, 0),
        };
        CostUnit { pixels: (edge * edge) as f64, levels: f64::from(1_u32 << shift) }
    }
}
