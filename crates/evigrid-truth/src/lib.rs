//! The reference: laser scans and their poses become an occupancy grid, and a map of safe ground, that maps are
//! scored against.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod heights;
mod laser_plan;
mod laser_safety;
mod laser_truth;
mod projected;
mod settings;

pub use laser_plan::{LaserPlan, PlanBand};
pub use laser_safety::{LaserSafety, RobotPlace};
pub use laser_truth::LaserTruth;
pub use projected::projected_disparity;
pub use settings::{TruthSettings, TruthSource};
