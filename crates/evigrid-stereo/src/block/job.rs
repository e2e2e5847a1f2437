use evigrid_core::{GrayImage, require_setting};

use super::settings::BlockMatchingSettings;
use crate::buffers::Shape;
use crate::error::StereoError;
use crate::pair_matcher::require_same_size;
use crate::winner::LANES;

/// One pair to match.
pub(crate) struct Job<'a> {
    pub settings: BlockMatchingSettings,
    pub uniqueness_percent: u32,
    pub left: &'a GrayImage,
    pub right: &'a GrayImage,
}

impl<'a> Job<'a> {
    /// The job of matching a pair.
    ///
    /// # Errors
    /// If the images differ in size or are smaller than the window.
    pub fn new(
        settings: BlockMatchingSettings,
        uniqueness_percent: u32,
        left: &'a GrayImage,
        right: &'a GrayImage,
    ) -> Result<Self, StereoError> {
        require_same_size(left, right)?;
        let (width, height, window) = (left.width(), left.height(), settings.window);
        let expected = format!("a window within the {width}x{height} image");
        require_setting(window <= width.min(height), "stereo", "window", expected, window)?;
        Ok(Self { settings, uniqueness_percent, left, right })
    }

    pub fn shape(&self) -> Shape {
        let BlockMatchingSettings { min_disparity, disparities, .. } = self.settings;
        Shape { width: self.left.width(), height: self.left.height(), min_disparity, disparities }
    }

    pub fn width(&self) -> usize {
        self.left.width()
    }

    /// Number of rows whose window fits into the image.
    pub fn rows(&self) -> usize {
        self.left.height() - self.settings.window + 1
    }

    /// Length of a row of costs: the image's width, and as many columns as a search may run over its edge.
    pub fn stride(&self) -> usize {
        self.width() + self.settings.min_disparity + self.settings.disparities + LANES
    }
}
