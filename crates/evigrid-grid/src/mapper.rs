use std::borrow::Cow;

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
    /// The right image, of the same size.
    pub right: &'a GrayImage,
    /// What the matcher says of every pixel, unfiltered.
    pub matches: &'a Matches,
    /// The whole cost volume, if any method of the run needs it.
    pub volume: Option<&'a CostVolume>,
}

/// A mapping method: integrates the evidence of one frame after the other and shows its map.
pub trait Mapper: Send + Sync {
    /// Whether [`View::volume`] must be there.
    fn needs_volume(&self) -> bool {
        false
    }

    /// Integrates one frame.
    fn integrate(&mut self, view: &View<'_>);

    /// The map so far.
    fn map(&self) -> &LogOddsGrid;
}

/// Maps of one method under several settings, built together because a frame is cheaper for all of them at once than for
/// each by itself. Every map is the same to the last bit as that of a [`Mapper`] of its settings.
pub trait MapperFamily: Send + Sync {
    /// Whether [`View::volume`] must be there.
    fn needs_volume(&self) -> bool {
        false
    }

    /// Integrates one frame into all maps.
    fn integrate(&mut self, view: &View<'_>);

    /// One of the maps so far, by its position in the settings the family was built from.
    fn map(&self, member: usize) -> Cow<'_, LogOddsGrid>;
}

/// A family of one.
impl MapperFamily for Box<dyn Mapper> {
    fn needs_volume(&self) -> bool {
        self.as_ref().needs_volume()
    }

    fn integrate(&mut self, view: &View<'_>) {
        self.as_mut().integrate(view);
    }

    fn map(&self, _: usize) -> Cow<'_, LogOddsGrid> {
        Cow::Borrowed(self.as_ref().map())
    }
}
