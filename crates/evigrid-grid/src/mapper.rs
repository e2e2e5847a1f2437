use evigrid_core::{CostVolume, GrayImage, Matches, Pose, StereoRig};

use crate::LogOddsGrid;

/// All that a mapping method may see of one frame. The laser is not among it.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The rig that took the pair.
    pub rig: &'a StereoRig,
    /// Where the left camera was.
    pub map_from_left: &'a Pose,
    /// The left image.
    pub left: &'a GrayImage,
    /// What the matcher says of every pixel, unfiltered.
    pub matches: &'a Matches,
    /// The whole cost volume, if any method of the run needs it.
    pub volume: Option<&'a CostVolume>,
}

/// A mapping method: integrates the evidence of one frame after the other and shows its map.
pub trait Mapper: Send {
    /// Whether [`View::volume`] must be there.
    fn needs_volume(&self) -> bool {
        false
    }

    /// Integrates one frame.
    fn integrate(&mut self, view: &View<'_>);

    /// The map so far.
    fn map(&self) -> &LogOddsGrid;
}
