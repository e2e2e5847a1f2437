//! Matchers: from a rectified stereo pair to disparities, confidences and the cost volume.

mod block_matcher;
mod error;
mod rows;
mod settings;
mod winner;

pub use block_matcher::{BlockMatcher, Matching};
pub use error::StereoError;
pub use settings::BlockMatchingSettings;
