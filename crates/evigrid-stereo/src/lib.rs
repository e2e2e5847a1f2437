//! Matchers: from a rectified stereo pair to disparities, confidences and the cost volume.
//!
//! [`Matcher`] is the way in: it runs the matcher that [`StereoSettings`] name, and the filters before and
//! after it. A new matcher is a type that implements [`PairMatcher`]; it is named here and in `matchers.rs`,
//! nowhere else.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod block;
mod buffers;
mod double_correlation;
mod error;
mod graph_cuts;
mod matcher;
mod matchers;
mod multi_scale;
mod pair_matcher;
mod post_filter;
mod pre_filter;
mod rows;
mod semi_global;
mod winner;

pub use block::{BlockMatcher, BlockMatchingSettings};
pub use double_correlation::{DoubleCorrelationMatcher, DoubleCorrelationSettings, GroundSource};
pub use error::StereoError;
pub use graph_cuts::{GraphCutMatcher, GraphCutSettings};
pub use matcher::Matcher;
pub use matchers::{MatcherKind, StereoSettings};
pub use multi_scale::{MultiScaleMatcher, MultiScaleSettings};
pub use pair_matcher::{Extras, PairMatcher, PairTask};
pub use post_filter::{drop_matches, speckles};
pub use pre_filter::{PreFilter, texture};
pub use semi_global::{PixelCost, SemiGlobalMatcher, SemiGlobalSettings};
