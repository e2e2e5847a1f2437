use serde::Deserialize;

use crate::number::Positive;

/// A robot as a world describes it.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Height of the robot: what is higher above the ground it stands on does not concern it, metres.
    height_m: Positive,
}

impl RobotSpec {
    /// Height of the robot, metres.
    pub fn height_m(&self) -> f64 {
        self.height_m.0
    }
}
