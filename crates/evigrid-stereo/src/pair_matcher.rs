use std::fmt::Debug;

use evigrid_core::{CoreError, DisparityPlane, GrayImage, Matching, SettingError, require_setting};

use crate::error::StereoError;

/// A matcher of rectified stereo pairs, without the filters before and after it.
pub trait PairMatcher: Debug + Send + Sync {
    /// Matches a pair of images of one size. A matcher leaves out those wanted extras that it does not offer.
    /// The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size, or the matcher cannot match images of their size.
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError>;
}

/// A pair to match.
#[derive(Debug)]
pub struct PairTask<'a> {
    /// The left image.
    pub left: &'a GrayImage,
    /// The right image, as large as the left one.
    pub right: &'a GrayImage,
    /// What is wanted beyond the matches.
    pub wanted: Extras,
    /// Disparities of the ground by the camera's mounting, where that is known.
    pub ground: Option<DisparityPlane>,
    /// The result of an earlier frame, whose buffers are filled again.
    pub recycled: Option<Matching>,
}

impl<'a> PairTask<'a> {
    /// A pair of which no ground is known, to be matched into new buffers.
    pub fn new(left: &'a GrayImage, right: &'a GrayImage, wanted: Extras) -> Self {
        Self { left, right, wanted, ground: None, recycled: None }
    }
}

/// Parts of a [`Matching`] beyond the matches, which only some matchers have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extras {
    /// The cost volume.
    pub costs: bool,
    /// Road and obstacles apart.
    pub road: bool,
}

/// Refuses images of different size.
pub(crate) fn require_same_size(left: &GrayImage, right: &GrayImage) -> Result<(), StereoError> {
    if (right.width(), right.height()) == (left.width(), left.height()) {
        return Ok(());
    }
    Err(StereoError::Images(CoreError::Size {
        what: "right image",
        expected_width: left.width(),
        expected_height: left.height(),
        width: right.width(),
        height: right.height(),
    }))
}

/// Refuses disparities that do not fit into 15 bits, and a search over none.
pub(crate) fn require_disparities(min_disparity: usize, disparities: usize) -> Result<(), SettingError> {
    let possible = (1..=4096).contains(&disparities);
    require_setting(possible, "stereo", "disparities", "a number from 1 to 4096", disparities)?;
    let possible = min_disparity <= 4096;
    require_setting(possible, "stereo", "min_disparity", "a number from 0 to 4096", min_disparity)
}
