use std::borrow::Cow;

use evigrid_core::GrayImage;

use crate::{
    BlockMatcher, GraphCutMatcher, MatcherKind, Matching, PreFilter, SemiGlobalMatcher, StereoError,
    StereoSettings, drop_matches, speckles, texture,
};

/// The matcher that settings name, with its filters.
#[derive(Debug)]
pub struct Matcher {
    settings: StereoSettings,
    algorithm: Algorithm,
}

#[derive(Debug)]
enum Algorithm {
    Block(BlockMatcher),
    SemiGlobal(Box<SemiGlobalMatcher>),
    GraphCuts(GraphCutMatcher),
}

impl Matcher {
    /// The matcher of these settings.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: StereoSettings) -> Result<Self, StereoError> {
        let settings = settings.checked()?;
        let percent = settings.uniqueness_percent as u32;
        let algorithm = match settings.matcher {
            MatcherKind::Block => {
                Algorithm::Block(BlockMatcher::new(settings.block())?.with_uniqueness(percent))
            }
            MatcherKind::SemiGlobal => {
                let StereoSettings { semi_global, min_disparity, disparities, .. } = settings;
                let matcher = SemiGlobalMatcher::new(semi_global, min_disparity, disparities)?;
                Algorithm::SemiGlobal(Box::new(matcher.with_uniqueness(percent)))
            }
            MatcherKind::GraphCuts => {
                let StereoSettings { graph_cuts, min_disparity, disparities, .. } = settings;
                Algorithm::GraphCuts(GraphCutMatcher::new(graph_cuts, min_disparity, disparities)?)
            }
        };
        Ok(Self { settings, algorithm })
    }

    /// Matches a pair: pre-filter, matcher, post-filters. `keep_volume` keeps all costs, if the matcher has any;
    /// `recycled` is the result of an earlier frame, whose buffers are filled again. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size or are smaller than the window of block matching or too large for graph cuts.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        keep_volume: bool,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        let (filtered_left, filtered_right) = (self.pre_filtered(left)?, self.pre_filtered(right)?);
        let matching = match &mut self.algorithm {
            Algorithm::Block(m) => m.run(&filtered_left, &filtered_right, keep_volume, recycled)?,
            Algorithm::SemiGlobal(m) => m.run(&filtered_left, &filtered_right, keep_volume, recycled)?,
            Algorithm::GraphCuts(m) => m.run(&filtered_left, &filtered_right, recycled)?,
        };
        self.post_filtered(left, matching)
    }

    fn pre_filtered<'a>(&self, image: &'a GrayImage) -> Result<Cow<'a, GrayImage>, StereoError> {
        let StereoSettings { pre_filter, pre_filter_cap: cap, pre_filter_window: window, .. } = self.settings;
        Ok(match pre_filter {
            PreFilter::None => Cow::Borrowed(image),
            filter => Cow::Owned(filter.apply(image, cap, window)?),
        })
    }

    /// Drops matches without texture, then speckles of what is left.
    fn post_filtered(&self, left: &GrayImage, matching: Matching) -> Result<Matching, StereoError> {
        let Matching { mut matches, volume } = matching;
        let s = &self.settings;
        if s.texture_threshold > 0 {
            let texture = texture(left, s.pre_filter_cap, s.window)?;
            let flat: Vec<bool> = texture.iter().map(|&sum| (sum as usize) < s.texture_threshold).collect();
            matches = drop_matches(matches, &flat)?;
        }
        if s.speckle_pixels > 0 {
            let speckles = speckles(&matches.disparity, s.speckle_pixels, s.speckle_step_px);
            matches = drop_matches(matches, &speckles)?;
        }
        Ok(Matching { matches, volume })
    }
}
