//! Brandao, Ferreira, Hashimoto, Santos-Victor, Takanishi: "Integrating the whole cost-curve of stereo into
//! occupancy grids". Three mapping methods, each in a folder of its own:
//!
//! - `winner_take_all/`: the baseline of the paper, with Elfes' inverse sensor model; one map, or several
//!   maps that differ in the peak ratio;
//! - `cost_curve/`: the method of the paper;
//! - `cost_curve_bayes/`: the project's own variant of it, derived in docs/cost-curve-bayes.md.
//!
//! The folder `free_space/` and the files beside the folders hold parts that two methods share; they know no
//! method.

mod cost_curve;
mod cost_curve_bayes;
mod cost_statistics;
mod depth_walk;
mod elfes;
mod fast_math;
mod free_space;
mod hypotheses;
mod pixels;
mod winner_take_all;

pub use cost_curve::{CostCurve, CostCurveSettings, CostExponent, CostUnit, HypothesesToCells, whole_curve};
pub use cost_curve_bayes::{CostCurveBayes, CostCurveBayesSettings, first_obstacle};
pub use cost_statistics::{
    FreeSpaceCosts, MEAN_DIFFERENCE_FLOOR, PIXEL_VARIANCE_FLOOR, free_space_costs, mean_difference,
    pixel_variance,
};
pub use elfes::{PRIOR_TOLERANCE, occupancy, occupancy_from_weights};
pub use fast_math::EXP2_ERROR;
pub use winner_take_all::{
    Deviation, GaussianProfile, PeakRatios, Profile, ProfileTable, WinnerTakeAll, WinnerTakeAllSettings,
};
