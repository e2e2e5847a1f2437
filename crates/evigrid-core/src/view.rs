use crate::{CostVolume, Frame, GrayImage, Matches, Matching, Mounting, Pose, RoadSplit, StereoRig};

/// Everything that a mapping method may see of one frame. The laser is not among it.
///
/// It is built from a checked [`Frame`] alone: sizes fit and the pose is finite.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct View<'a> {
    /// The rig that took the pair.
    pub rig: &'a StereoRig,
    /// Pose of the left camera.
    pub map_from_left: &'a Pose,
    /// Time of the left image, nanoseconds.
    pub stamp_ns: i64,
    /// How the left camera stands over the ground; `None` if neither the data set nor a setting tells.
    pub mounting: Option<Mounting>,
    /// The left image.
    pub left: &'a GrayImage,
    /// The right image, of the same size.
    pub right: &'a GrayImage,
    /// Winner, peak ratio and left-right difference of every pixel, unfiltered.
    pub matches: &'a Matches,
    /// The whole cost volume, if any method of the run needs it.
    pub volume: Option<&'a CostVolume>,
    /// Road and obstacles apart, if any method of the run needs it.
    pub road: Option<&'a RoadSplit>,
}

impl<'a> View<'a> {
    /// The view of a frame and of what matching found in it.
    pub fn new(frame: &'a Frame, mounting: Option<Mounting>, matching: &'a Matching) -> Self {
        Self {
            rig: frame.rig(),
            map_from_left: frame.map_from_left(),
            stamp_ns: frame.stamp_ns(),
            mounting,
            left: frame.left(),
            right: frame.right(),
            matches: &matching.matches,
            volume: matching.volume.as_ref(),
            road: matching.road.as_ref(),
        }
    }
}
