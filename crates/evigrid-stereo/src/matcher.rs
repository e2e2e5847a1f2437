use std::borrow::Cow;

use evigrid_core::{GrayImage, Matching};

use crate::error::StereoError;
use crate::matchers::StereoSettings;
use crate::pair_matcher::{PairMatcher, PairTask};
use crate::post_filter::{drop_matches, speckles};
use crate::pre_filter::{PreFilter, texture};

/// The matcher that settings name, with its filters.
#[derive(Debug)]
pub struct Matcher {
    settings: StereoSettings,
    pair_matcher: Box<dyn PairMatcher>,
}

impl Matcher {
    /// The matcher of these settings.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: StereoSettings) -> Result<Self, StereoError> {
        let settings = settings.checked()?;
        Ok(Self { pair_matcher: settings.pair_matcher()?, settings })
    }

    /// Matches a pair: pre-filter, matcher, post-filters. Of the wanted extras come those that the matcher offers
    /// ([`MatcherKind::offers`](crate::MatcherKind::offers)), without post-filters. The result does not depend on
    /// the number of threads.
    ///
    /// # Errors
    /// If the images differ in size, or the matcher cannot match images of their size.
    pub fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        let (left, right) = (self.pre_filtered(task.left)?, self.pre_filtered(task.right)?);
        let filtered = PairTask { left: &left, right: &right, ..task };
        let matching = self.pair_matcher.run(filtered)?;
        self.post_filtered(task.left, matching)
    }

    fn pre_filtered<'a>(&self, image: &'a GrayImage) -> Result<Cow<'a, GrayImage>, StereoError> {
        let StereoSettings { pre_filter, pre_filter_cap: cap, pre_filter_window: window, .. } = self.settings;
        Ok(match pre_filter {
            PreFilter::None => Cow::Borrowed(image),
            filter => Cow::Owned(filter.apply(image, cap, window)?),
        })
    }

    /// Drops matches without texture, then speckles among the rest.
    fn post_filtered(&self, left: &GrayImage, mut matching: Matching) -> Result<Matching, StereoError> {
        let s = &self.settings;
        if s.texture_threshold > 0 {
            let texture = texture(left, s.pre_filter_cap, s.window)?;
            let flat: Vec<bool> = texture.iter().map(|&sum| (sum as usize) < s.texture_threshold).collect();
            matching.matches = drop_matches(matching.matches, &flat)?;
        }
        if s.speckle_pixels > 0 {
            let speckles = speckles(&matching.matches.disparity, s.speckle_pixels, s.speckle_step_px);
            matching.matches = drop_matches(matching.matches, &speckles)?;
        }
        Ok(matching)
    }
}
