use std::ops::Range;

use crate::{CostVolume, Disparity, DisparityPlane, Matches};

/// The result of matching one stereo pair. All methods of a run see the same one.
#[derive(Debug, Clone)]
pub struct Matching {
    /// Winner, peak ratio and left-right difference of every pixel, unfiltered.
    pub matches: Matches,
    /// The whole cost volume, where it was asked for and the matcher has one.
    pub volume: Option<CostVolume>,
    /// Road and obstacles apart, where it was asked for and the matcher tells them apart.
    pub road: Option<RoadSplit>,
}

/// A disparity image in two parts: pixels that lie on the road, and pixels that show an obstacle. No pixel
/// has a disparity in both. Both are unfiltered, as the matches they are parts of.
#[derive(Debug, Clone)]
pub struct RoadSplit {
    /// Disparities of the road, NaN elsewhere.
    pub road: Disparity,
    /// Disparities of obstacles, NaN elsewhere.
    pub obstacles: Disparity,
    /// The ground by which they were told apart.
    pub ground: DisparityPlane,
    /// The whole disparities that were tried; what is nearer or farther cannot have been seen.
    pub tried: Range<usize>,
}

impl Matching {
    /// A matching that comes from elsewhere as a bare disparity image ([`Matches::from_disparity`]).
    pub fn from_disparity(disparity: Disparity) -> Self {
        Self::from(Matches::from_disparity(disparity))
    }
}

impl From<Matches> for Matching {
    fn from(matches: Matches) -> Self {
        Self { matches, volume: None, road: None }
    }
}
