//! The reference: laser scans and their poses become an occupancy grid that maps are scored against.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod laser_truth;
mod projected;
mod settings;

pub use laser_truth::LaserTruth;
pub use projected::projected_disparity;
pub use settings::{TruthSettings, TruthSource};
