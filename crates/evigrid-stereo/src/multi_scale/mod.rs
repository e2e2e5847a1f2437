//! Multi-scale correlation, as the Small Vision System of SRI and Videre Design has it (user's manual, 3.5:
//! the pair is also matched at half its resolution, to fill in what the full one drops out) and as Murarka
//! and Kuipers 2009, section III, use it.
//!
//! The pair, its half and, with three scales, its quarter are block-matched with the same window, which so
//! covers twice the width from scale to scale. From the coarsest scale on, the matches of each are finished
//! (`fill.rs`): those that are not reliable are replaced by the reading of the next coarser scale.

mod fill;
pub(crate) mod halve;
pub(crate) mod settings;

use evigrid_core::{GrayImage, Matches, Matching, require_setting};

pub use settings::MultiScaleSettings;

use crate::block::{BlockMatcher, BlockMatchingSettings};
use crate::buffers::{Buffers, Shape};
use crate::error::StereoError;
use crate::pair_matcher::{PairMatcher, PairTask, require_same_size};
use crate::pre_filter::texture;
use fill::{Coarser, Limits, keep_or_fill};
use halve::halved;
use settings::halved_hypotheses;

/// Largest Sobel response that the texture sees, unless another is set; OpenCV's.
const TEXTURE_CAP: usize = 31;

/// Block matching at two or three scales: a pixel that the full resolution does not match reliably takes the
/// disparity of the half, and where that is not reliable either, of the quarter. Reliable matches of a finer
/// scale always come first. A match is reliable if it is unique, its window has texture, and the right
/// image's winner agrees. Pixels that no scale matches reliably have no disparity.
///
/// - A halved pixel is the mean of 2x2 pixels. A halved scale tries the halves of the disparities; one that
///   lies outside of the range when doubled is no reading.
/// - A filled disparity is interpolated between the coarse pixels around, but not across steps of more than a
///   coarse pixel.
/// - A pixel's peak ratio and left-right difference are those of the scale that its disparity comes from, the
///   difference in pixels of the full resolution: a multiple of 2 from the half, of 4 from the quarter.
/// - There is no cost volume, as the scales' costs have no unit in common.
#[derive(Debug)]
pub struct MultiScaleMatcher {
    finest: Scale,
}

impl MultiScaleMatcher {
    /// A matcher with these settings; `block` holds window and disparities at full resolution.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: MultiScaleSettings, block: BlockMatchingSettings) -> Result<Self, StereoError> {
        let settings = settings.checked()?;
        Ok(Self { finest: Scale::new(&settings, block.checked()?, settings.scales)? })
    }

    /// Makes the texture clip Sobel responses to `cap` (1 to 127; 31 at first), grey levels.
    #[must_use]
    pub fn with_texture_cap(mut self, cap: usize) -> Self {
        self.finest.set_texture_cap(cap.clamp(1, 127));
        self
    }

    /// Matches a pair. `recycled` is the result of an earlier frame, whose buffers are filled again. The
    /// result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size, or the coarsest scale's are smaller than the window.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        require_same_size(left, right)?;
        self.finest.require_room(left.width(), left.height())?;
        Ok(self.finest.run(left, right, recycled)?.into())
    }
}

impl PairMatcher for MultiScaleMatcher {
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        Self::run(self, task.left, task.right, task.recycled)
    }
}

/// One scale, and the coarser ones below it.
#[derive(Debug)]
struct Scale {
    block: BlockMatchingSettings,
    matcher: BlockMatcher,
    limits: Limits,
    texture_cap: usize,
    coarser: Option<Box<Scale>>,
    /// Result of an earlier frame, whose buffers are filled again.
    earlier: Option<Matching>,
}

impl Scale {
    /// The first of so many scales; `block` holds its window and disparities.
    fn new(
        settings: &MultiScaleSettings,
        block: BlockMatchingSettings,
        scales: usize,
    ) -> Result<Self, StereoError> {
        let coarser = match scales {
            0 | 1 => None,
            _ => Some(Box::new(Self::new(settings, halved_hypotheses(block), scales - 1)?)),
        };
        let left_right_px = settings.left_right_px as u16;
        let matcher = BlockMatcher::new(block)?.with_uniqueness(settings.uniqueness_percent as u32);
        let limits = Limits { left_right_px, texture: settings.texture_threshold };
        Ok(Self { block, matcher, limits, texture_cap: TEXTURE_CAP, coarser, earlier: None })
    }

    fn set_texture_cap(&mut self, cap: usize) {
        self.texture_cap = cap;
        if let Some(coarser) = &mut self.coarser {
            coarser.set_texture_cap(cap);
        }
    }

    /// Refuses images whose coarsest scale does not hold the window.
    fn require_room(&self, width: usize, height: usize) -> Result<(), StereoError> {
        if let Some(coarser) = &self.coarser {
            return coarser.require_room(width / 2, height / 2);
        }
        let window = self.block.window;
        let expected = format!("a window within the {width}x{height} image of the coarsest scale");
        Ok(require_setting(window <= width.min(height), "stereo", "window", expected, window)?)
    }

    /// Matches the pair at this scale and fills in what the coarser scales know.
    fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        recycled: Option<Matching>,
    ) -> Result<Matches, StereoError> {
        let BlockMatchingSettings { min_disparity, disparities, .. } = self.block;
        let shape = Shape { width: left.width(), height: left.height(), min_disparity, disparities };
        let matching = self.matcher.run(left, right, false, recycled)?;
        let mut out = Buffers::new(shape, false, Some(matching));
        let texture = self.texture(left)?;
        let Some(scale) = &mut self.coarser else {
            keep_or_fill(&mut out, shape.width, self.limits, &texture, None);
            return Ok(out.into_matches(shape)?);
        };
        let earlier = scale.earlier.take();
        let matches = scale.run(&halved(left)?, &halved(right)?, earlier)?;
        let range = min_disparity as f32..=(min_disparity + disparities - 1) as f32;
        let coarser = Coarser { matches: &matches, range };
        keep_or_fill(&mut out, shape.width, self.limits, &texture, Some(&coarser));
        scale.earlier = Some(matches.into());
        Ok(out.into_matches(shape)?)
    }

    /// Texture of the left image; empty if no match needs any.
    fn texture(&self, left: &GrayImage) -> Result<Vec<u32>, StereoError> {
        if self.limits.texture == 0 {
            return Ok(Vec::new());
        }
        Ok(texture(left, self.texture_cap, self.block.window)?)
    }
}
