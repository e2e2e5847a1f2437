use evigrid_core::{Frame, LaserScan, Mounting, Pose, StereoRig};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::ReplayError;

/// Facts that a recording tells of itself before any frame is read.
#[derive(Debug, Clone)]
pub struct SequenceInfo {
    /// Name of the recording, used in tables and file names, e.g. `2011_09_26_drive_0013`.
    pub id: String,
    /// Name of the layout, e.g. `kitti-raw`.
    pub layout: &'static str,
    /// The rig of all frames.
    pub rig: StereoRig,
    /// How the left camera stands over the ground; `None` if the data set does not tell.
    pub mounting: Option<Mounting>,
    /// How many frames there are; frame numbers are `0..frame_count`.
    pub frame_count: usize,
}

/// A recording with random access to its frames, so that they can be prefetched, strided and cut. Nothing is
/// kept between calls: memory does not grow with the length of the recording.
pub trait Sequence: Send + Sync {
    /// Facts that the recording tells of itself.
    fn info(&self) -> &SequenceInfo;

    /// Pose of the left camera of frame `index` in the recording's own world, whose z axis points up.
    ///
    /// # Errors
    /// If the frame does not exist or its pose cannot be read.
    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError>;

    /// Reads frame `index`, with all its poses in the map frame.
    ///
    /// # Errors
    /// If the frame does not exist or a file of it (other than a missing laser scan) cannot be read.
    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError>;

    /// Reads the laser scan of frame `index` alone, where the layout can; `None` if the frame has none.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn laser(&self, index: usize, map_from_world: &Pose) -> Result<Option<LaserScan>, ReplayError> {
        Ok(self.frame(index, map_from_world)?.laser().cloned())
    }
}

/// The map frame of a run: gravity-aligned, origin at the left camera of the first used frame, x along that
/// camera's horizontal heading.
pub fn map_from_world(world_from_first_left: &Pose) -> Pose {
    let forward = world_from_first_left.rotation * Vector3::z();
    let yaw = forward.y.atan2(forward.x);
    let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Isometry3::from_parts(world_from_first_left.translation, heading).inverse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::level_camera;

    #[test]
    fn the_first_camera_looks_along_x_and_keeps_its_tilt() {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.1);
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.05);
        let world_from_left =
            Isometry3::from_parts(Vector3::new(7.0, -3.0, 2.0).into(), yaw * level_camera() * tilt);
        let map_from_left = map_from_world(&world_from_left) * world_from_left;
        assert!(map_from_left.translation.vector.norm() < 1e-12);
        let forward = map_from_left.rotation * Vector3::z();
        // A positive turn about the camera's x axis (right) moves z towards -y, that is upwards.
        assert!((forward - Vector3::new(0.05_f64.cos(), 0.0, 0.05_f64.sin())).norm() < 1e-12, "{forward}");
    }
}
