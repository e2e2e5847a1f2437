//! Stereo data sets as sequences of frames: KITTI raw, KITTI odometry, Middlebury pairs.

mod error;
mod sequence;

pub use error::ReplayError;
pub use sequence::{Sequence, SequenceInfo, map_from_world};
