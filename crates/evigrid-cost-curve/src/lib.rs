//! Brandao, Ferreira, Hashimoto, Santos-Victor, Takanishi: "Integrating the whole cost-curve of stereo into occupancy
//! grids". The method of the paper, `cost-curve`, and its winner-take-all baseline with Elfes' inverse sensor model.

mod cost_curve;
mod cost_curve_settings;
mod cost_exponent;
mod cost_statistics;
mod curve_block;
mod curve_cells;
mod curve_lines;
mod elfes;
mod error;
mod fast_math;
mod free_space;
mod hypotheses;
mod nested_free_space;
mod nested_reach;
mod peak_ratios;
mod profile;
mod rays;
mod reach;
mod sections;
mod settings;
mod silhouette;
pub mod whole_curve;
mod winner_take_all;

pub use cost_curve::CostCurve;
pub use cost_curve_settings::{CostCurveSettings, HypothesesToCells};
pub use cost_exponent::{CostExponent, CostUnit};
pub use cost_statistics::{
    CostScale, FreeSpaceCosts, PIXEL_VARIANCE_FLOOR, free_space_costs, pixel_variance,
};
pub use elfes::{occupancy, occupancy_from_weights};
pub use error::SettingError;
pub use fast_math::{EXP2_ERROR, LOG_ODDS_ERROR};
pub use peak_ratios::PeakRatios;
pub use profile::{GaussianProfile, PRIOR_TOLERANCE, Profile, ProfileTable};
pub use settings::{Deviation, WinnerTakeAllSettings};
pub use winner_take_all::WinnerTakeAll;
