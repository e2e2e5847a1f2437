//! Brandao, Ferreira, Hashimoto, Santos-Victor, Takanishi: "Integrating the whole cost-curve of stereo into occupancy
//! grids". The method of the paper, `cost-curve`, the project's own `cost-curve-bayes`, and the winner-take-all baseline with Elfes'
//! inverse sensor model.

mod cost_curve;
mod cost_curve_bayes;
mod cost_curve_bayes_settings;
mod cost_curve_settings;
mod cost_exponent;
mod cost_statistics;
mod curve_block;
mod curve_cells;
mod curve_lines;
mod depth_walk;
mod elfes;
mod error;
mod fast_math;
pub mod first_obstacle;
mod free_space;
mod hypotheses;
mod look;
mod nested_free_space;
mod nested_reach;
mod peak_ratios;
mod profile;
mod ray_sections;
mod reach;
mod sections;
mod settings;
mod silhouette;
pub mod whole_curve;
mod winner_take_all;

pub use cost_curve::CostCurve;
pub use cost_curve_bayes::CostCurveBayes;
pub use cost_curve_bayes_settings::CostCurveBayesSettings;
pub use cost_curve_settings::{CostCurveSettings, HypothesesToCells};
pub use cost_exponent::{CostExponent, CostUnit};
pub use cost_statistics::{
    CostScale, FreeSpaceCosts, MEAN_DIFFERENCE_FLOOR, PIXEL_VARIANCE_FLOOR, free_space_costs,
    mean_difference, pixel_variance,
};
pub use elfes::{occupancy, occupancy_from_weights};
pub use error::SettingError;
pub use fast_math::EXP2_ERROR;
pub use peak_ratios::PeakRatios;
pub use profile::{GaussianProfile, PRIOR_TOLERANCE, Profile, ProfileTable};
pub use settings::{Deviation, WinnerTakeAllSettings};
pub use winner_take_all::WinnerTakeAll;
