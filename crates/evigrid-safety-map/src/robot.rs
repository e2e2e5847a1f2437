use evigrid_core::{Mounting, Pose};

/// Where the robot stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// Its place in the map frame, metres.
    pub at_m: [f64; 2],
    /// Height of the floor that it stands on in the map frame, metres.
    pub floor_m: f64,
}

impl Robot {
    /// The robot below a camera.
    pub fn below(map_from_left: &Pose, mounting: Mounting) -> Self {
        let floor_m = map_from_left.translation.z - mounting.height_m;
        Self { at_m: mounting.robot_m(map_from_left), floor_m }
    }
}
