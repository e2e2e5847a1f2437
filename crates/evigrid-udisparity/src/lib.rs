//! Occupancy of the ground from what a stereo camera could see of it (Perrollaz, Yoder, Negre, Spalanzani and Laugier
//! 2012, "A visibility-based approach for occupancy grid computation in disparity space").
//!
//! A grid over columns and disparities counts, for every cell, the pixels that could show it, those that do, and those
//! that show an obstacle in it; road pixels make it free. It is mapped to cells on the ground, and filtered over time
//! with a distribution of velocities per cell.
//!
//! [`Visibility`] is the method, [`VisibilityFiltered`] the same with its filter, [`Ternary`] the baseline of the
//! paper's Fig. 5.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod counts;
mod filter;
mod ground_map;
mod level;
mod method;
mod pictures;
mod probability;
mod rolling;
mod settings;
mod smooth;
mod ternary;
mod u_disparity;

pub use counts::{Counts, Rows};
pub use filter::{Filter, FilterForm, FilterSettings};
pub use ground_map::{GroundView, map_to_ground};
pub use level::{LevelView, Pixels};
pub use method::{Ternary, Visibility, VisibilityFiltered};
pub use probability::{CellCounts, CellProbabilities, Parameters};
pub use rolling::RollingPlan;
pub use settings::{TernarySettings, VisibilityFilteredSettings, VisibilitySettings};
pub use smooth::Smoother;
pub use ternary::ternary;
pub use u_disparity::UDisparityGrid;
