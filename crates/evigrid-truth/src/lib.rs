//! The reference: laser scans and their poses become an occupancy grid that maps are scored against.

mod laser_truth;
mod settings;

pub use laser_truth::LaserTruth;
pub use settings::{SettingError, TruthSettings};
