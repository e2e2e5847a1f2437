//! The list of matchers. A new matcher adds to this file: a kind, with its name and the extras that it
//! offers; its section of the settings, with the default and the check; and the arm that builds it.

use evigrid_core::{SettingError, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::block::{BlockMatcher, BlockMatchingSettings};
use crate::double_correlation::{DoubleCorrelationMatcher, DoubleCorrelationSettings, GroundSource};
use crate::error::StereoError;
use crate::graph_cuts::{GraphCutMatcher, GraphCutSettings};
use crate::multi_scale::{MultiScaleMatcher, MultiScaleSettings};
use crate::pair_matcher::{Extras, PairMatcher};
use crate::pre_filter::PreFilter;
use crate::semi_global::{SemiGlobalMatcher, SemiGlobalSettings};

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
    /// Blocks at two or three scales, of which the coarser fill in what the finer do not match reliably
    /// (Small Vision System; Murarka and Kuipers 2009).
    MultiScale,
    /// Blocks that stand upright and blocks that follow the ground, which tell obstacles from the road (Perrollaz
    /// et al. 2012).
    DoubleCorrelation,
    /// The true disparities of a synthetic world, where both cameras see the point. It looks at no image; a run
    /// takes them from the world.
    Exact,
}

impl MatcherKind {
    /// All matchers, in the order of the list.
    pub const ALL: [Self; 6] = [
        Self::Block,
        Self::SemiGlobal,
        Self::GraphCuts,
        Self::MultiScale,
        Self::DoubleCorrelation,
        Self::Exact,
    ];

    /// Name of the matcher in settings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Block => "block",
            Self::SemiGlobal => "semi-global",
            Self::GraphCuts => "graph-cuts",
            Self::MultiScale => "multi-scale",
            Self::DoubleCorrelation => "double-correlation",
            Self::Exact => "exact",
        }
    }

    /// Extras that the matcher can give.
    pub fn offers(self) -> Extras {
        match self {
            Self::Block | Self::SemiGlobal => Extras { costs: true, road: false },
            Self::GraphCuts | Self::MultiScale => Extras { costs: false, road: false },
            Self::DoubleCorrelation | Self::Exact => Extras { costs: false, road: true },
        }
    }
}

/// Matching: the matcher, its hypotheses, and the filters before and after it, all of which are off by
/// default.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StereoSettings {
    /// block, semi-global, graph-cuts, multi-scale, double-correlation or, for synthetic worlds, exact. Unit: none.
    /// Source: Brandao et al. IV (block); Souza et al. 4.1 (block, graph-cuts); Murarka and Kuipers 2009, III
    /// (multi-scale); Perrollaz et al. 2012, 3.3 (double-correlation).
    pub matcher: MatcherKind,
    /// Edge of the square window over which absolute differences are summed (matchers block and
    /// multi-scale), and of that of the texture; odd. Unit: px. Source: Brandao et al. IV (7).
    pub window: usize,
    /// Smallest disparity that is tried; 0 is infinitely far. Unit: px. Source: own choice, so that the sky
    /// can say "far".
    pub min_disparity: usize,
    /// How many whole disparities are tried, from the smallest on. Unit: px. Source: own choice (KITTI: from
    /// 3 m on).
    pub disparities: usize,
    /// Filter that both images go through before matching: none, sobel-x or normalized. Unit: none. Source:
    /// Souza et al. 4.1, OpenCV.
    pub pre_filter: PreFilter,
    /// Largest response of the pre-filter and of the texture's Sobel filter; larger ones are clipped. Unit:
    /// grey levels. Source: OpenCV (preFilterCap).
    pub pre_filter_cap: usize,
    /// Edge of the window whose mean is taken off by the pre-filter normalized; odd. Unit: px. Source: OpenCV
    /// (preFilterSize).
    pub pre_filter_window: usize,
    /// Drop matches where the absolute Sobel responses of the left window sum to less; 0: none. Unit: grey
    /// levels. Source: OpenCV (textureThreshold).
    pub texture_threshold: usize,
    /// Drop matches for which a hypothesis that is no neighbour of the winner costs less than 100 / (100 -
    /// this) times as much; 0: none. Matchers block, semi-global and double-correlation. Unit: percent. Source: OpenCV
    /// (uniquenessRatio: 5 to 15).
    pub uniqueness_percent: usize,
    /// Drop connected regions of at most so many pixels, before the methods' left-right check (OpenCV: after
    /// it); 0: none. Unit: pixels. Source: OpenCV (speckleWindowSize: 50 to 200).
    pub speckle_pixels: usize,
    /// Largest step of the disparity between neighbours of one region. Unit: px. Source: OpenCV
    /// (speckleRange: 1 or 2).
    pub speckle_step_px: f32,
    /// Matcher semi-global. Unit: none. Source: Hirschmueller 2008.
    pub semi_global: SemiGlobalSettings,
    /// Matcher graph-cuts. Unit: none. Source: Kolmogorov and Zabih 2001.
    pub graph_cuts: GraphCutSettings,
    /// Matcher multi-scale. Unit: none. Source: Murarka and Kuipers 2009, III.
    pub multi_scale: MultiScaleSettings,
    /// Matcher double-correlation. Unit: none. Source: Perrollaz et al. 2012, 3.3.
    pub double_correlation: DoubleCorrelationSettings,
}

impl Default for StereoSettings {
    fn default() -> Self {
        let BlockMatchingSettings { window, min_disparity, disparities } = BlockMatchingSettings::default();
        Self {
            matcher: MatcherKind::default(),
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
            multi_scale: MultiScaleSettings::default(),
            double_correlation: DoubleCorrelationSettings::default(),
        }
    }
}

impl StereoSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If one is outside its domain; those of matchers that are not used count too.
    pub fn checked(self) -> Result<Self, StereoError> {
        self.block().checked()?;
        self.semi_global.checked()?;
        self.graph_cuts.checked()?;
        self.multi_scale.checked()?;
        self.double_correlation.checked()?;
        self.check_filters()?;
        Ok(self)
    }

    fn check_filters(&self) -> Result<(), StereoError> {
        let cap = self.pre_filter_cap;
        let possible = (1..=127).contains(&cap);
        require_setting(possible, "stereo", "pre_filter_cap", "a number from 1 to 127", cap)?;
        let window = self.pre_filter_window;
        let possible = window % 2 == 1 && window <= 255;
        require_setting(possible, "stereo", "pre_filter_window", "an odd number from 1 to 255", window)?;
        let percent = self.uniqueness_percent;
        let possible = percent < 100;
        require_setting(possible, "stereo", "uniqueness_percent", "a number from 0 to 99", percent)?;
        let step = self.speckle_step_px;
        let possible = step >= 0.0 && step.is_finite();
        require_setting(possible, "stereo", "speckle_step_px", "a finite number from 0", step)?;
        Ok(())
    }

    /// Whether matching needs to know how the camera stands over the ground.
    pub fn needs_mounting(&self) -> bool {
        self.matcher == MatcherKind::DoubleCorrelation
            && self.double_correlation.ground == GroundSource::Mounting
    }

    /// The settings of block matching.
    pub fn block(&self) -> BlockMatchingSettings {
        let Self { window, min_disparity, disparities, .. } = *self;
        BlockMatchingSettings { window, min_disparity, disparities }
    }

    /// Builds the matcher that these settings name, without its filters.
    pub(crate) fn pair_matcher(&self) -> Result<Box<dyn PairMatcher>, StereoError> {
        let disparities = self.min_disparity..self.min_disparity + self.disparities;
        let percent = self.uniqueness_percent as u32;
        Ok(match self.matcher {
            MatcherKind::Block => Box::new(BlockMatcher::new(self.block())?.with_uniqueness(percent)),
            MatcherKind::SemiGlobal => {
                let matcher = SemiGlobalMatcher::new(self.semi_global, disparities)?;
                Box::new(matcher.with_uniqueness(percent))
            }
            MatcherKind::GraphCuts => Box::new(GraphCutMatcher::new(self.graph_cuts, disparities)?),
            MatcherKind::MultiScale => {
                let matcher = MultiScaleMatcher::new(self.multi_scale, self.block())?;
                Box::new(matcher.with_texture_cap(self.pre_filter_cap))
            }
            MatcherKind::DoubleCorrelation => {
                let matcher = DoubleCorrelationMatcher::new(self.double_correlation, self.block())?;
                Box::new(matcher.with_uniqueness(percent))
            }
            MatcherKind::Exact => return Err(no_images().into()),
        })
    }
}

/// The error of a matcher that looks at no images.
fn no_images() -> SettingError {
    let expected = "a matcher of images (only a synthetic world has exact disparities)".into();
    SettingError { section: "stereo", key: "matcher", expected, found: MatcherKind::Exact.name().into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    #[test]
    fn exact_disparities_are_not_made_from_images() {
        let settings = StereoSettings { matcher: MatcherKind::Exact, ..StereoSettings::default() };
        let error = crate::Matcher::new(settings).map(|_| ()).map_err(|e| e.to_string());
        assert!(error.is_err_and(|e| e.contains("stereo.matcher") && e.ends_with("found exact")));
    }

    #[test]
    fn names_are_those_of_the_settings() {
        for kind in MatcherKind::ALL {
            let name: StrDeserializer<'_, Error> = kind.name().into_deserializer();
            assert_eq!(MatcherKind::deserialize(name), Ok(kind));
        }
    }
}
