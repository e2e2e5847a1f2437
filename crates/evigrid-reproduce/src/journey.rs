//! Safety maps along a drive.

use evigrid_core::{Frame, Mounting};
use evigrid_grid::SafetyMap;
use evigrid_metrics::SafetyCase;
use nalgebra::Vector3;

/// The safety map of one method under one matcher, frame by frame.
#[derive(Debug, Clone, Default)]
pub struct Journey {
    /// Number of each frame in which the robot had moved, with the map counted against the truth there.
    pub cases: Vec<(usize, SafetyCase)>,
    /// The map at the frame that is shown.
    pub shown: Option<Shown>,
}

/// A safety map at one frame.
#[derive(Debug, Clone)]
pub struct Shown {
    pub map: SafetyMap,
    pub truth: SafetyMap,
    pub case: SafetyCase,
    pub robot: RobotAt,
}

/// Where the robot stands and where it looks, in the map frame.
#[derive(Debug, Clone, Copy)]
pub struct RobotAt {
    /// The middle of the robot, metres.
    pub at_m: [f64; 2],
    /// Unit vector of its heading.
    pub heading: [f64; 2],
}

impl RobotAt {
    /// The robot that carries the camera of a frame.
    pub fn of(frame: &Frame, mounting: Mounting) -> Self {
        let pose = frame.map_from_left();
        let ahead = pose.rotation * Vector3::z();
        let level = ahead.x.hypot(ahead.y).max(f64::MIN_POSITIVE);
        Self { at_m: mounting.robot_m(pose), heading: [ahead.x / level, ahead.y / level] }
    }
}
