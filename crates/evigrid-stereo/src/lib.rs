//! Matchers: from a rectified stereo pair to disparities, confidences and the cost volume.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod block_matcher;
mod error;
mod graph_cuts;
mod matcher;
mod matching;
mod post_filter;
mod pre_filter;
mod rows;
mod semi_global;
mod settings;
mod stereo_settings;
mod winner;

pub use block_matcher::BlockMatcher;
pub use error::StereoError;
pub use graph_cuts::{GraphCutMatcher, GraphCutSettings};
pub use matcher::Matcher;
pub use matching::Matching;
pub use post_filter::{drop_matches, speckles};
pub use pre_filter::{PreFilter, texture};
pub use semi_global::{PixelCost, SemiGlobalMatcher, SemiGlobalSettings};
pub use settings::BlockMatchingSettings;
pub use stereo_settings::{CostUnit, MatcherKind, StereoSettings};
