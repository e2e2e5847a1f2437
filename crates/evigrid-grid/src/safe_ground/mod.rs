//! Safe ground by the rules of Murarka and Kuipers 2009 on surfaces that are known cell by cell, as a truth knows
//! them: from the shapes of a world, or from a laser.

mod rules;
mod segments;
mod verdicts;

use nalgebra::Vector3;

pub use rules::SafetyRules;
pub use segments::{Border, Plan, Segments};
pub use verdicts::Verdict;

/// The surface at the centre of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Its height in the map frame, metres.
    pub height_m: f64,
    /// Its upward unit normal in the map frame.
    pub normal: Vector3<f64>,
}

impl Surface {
    /// The angle between the surface and a level one, radians.
    pub fn slope_rad(&self) -> f64 {
        libm::atan2(libm::hypot(self.normal.x, self.normal.y), self.normal.z)
    }

    /// The height that its plane has so far away along x and y, metres.
    pub fn height_at(&self, away_m: [f64; 2]) -> f64 {
        self.height_m - (self.normal.x * away_m[0] + self.normal.y * away_m[1]) / self.normal.z
    }
}
