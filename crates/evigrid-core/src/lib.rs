//! Checked value types that every other crate shares: images, stereo rig, disparity, cost volume, laser scans,
//! frames. No IO, no clock, no randomness.
//!
//! Conventions (the whole project): map frame x forward, y left, z up; camera frame x right, y down, z forward;
//! metres; pixel centres at integer coordinates; transforms named `map_from_left`, so that products read off.

mod cost_volume;
mod disparity;
mod error;
mod frame;
mod hint;
mod image;
mod rig;

pub use cost_volume::{CostVolume, NO_COST};
pub use disparity::{Disparity, Matches};
pub use error::CoreError;
pub use frame::{Frame, LaserScan};
pub use hint::name_hint;
pub use image::GrayImage;
pub use rig::StereoRig;

/// A rigid transform in double precision; `a_from_b` takes points of frame b to frame a.
pub type Pose = nalgebra::Isometry3<f64>;
