//! Checked value types that every other crate shares: images, stereo rig and its mounting, matches, cost
//! volume, laser scans, frames, and the view of a frame that a mapping method gets. No IO, no clock, no
//! randomness.
//!
//! Conventions (the whole project): map frame x forward, y left, z up; camera frame x right, y down, z
//! forward; metres; pixel centres at integer coordinates; transforms named `map_from_left`, so that products
//! read off.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod cost_volume;
mod disparity;
mod error;
mod frame;
mod ground;
mod hash;
mod hint;
mod image;
mod match_filter;
mod matching;
mod mounting;
mod rig;
mod setting;
mod view;

pub use cost_volume::{CostScale, CostVolume, NO_COST};
pub use disparity::{Disparity, Matches};
pub use error::CoreError;
pub use frame::{Frame, LaserScan};
pub use ground::{DisparityPlane, GroundPlane};
pub use hash::stable_hash;
pub use hint::name_hint;
pub use image::GrayImage;
pub use match_filter::{MatchFilter, MatchLimits, NO_MATCH};
pub use matching::{Matching, RoadSplit};
pub use mounting::{Mounting, level_camera};
pub use rig::StereoRig;
pub use setting::{SettingError, require_setting};
pub use view::View;

/// A rigid transform in double precision; `a_from_b` takes points of frame b to frame a.
pub type Pose = nalgebra::Isometry3<f64>;
