//! Brandao, Ferreira, Hashimoto, Santos-Victor, Takanishi: "Integrating the whole cost-curve of stereo into occupancy
//! grids". Here: the winner-take-all baseline of the paper, with Elfes' inverse sensor model.

mod elfes;
mod free_space;
mod nested_free_space;
mod nested_reach;
mod peak_ratios;
mod profile;
mod rays;
mod reach;
mod sections;
mod settings;
mod silhouette;
mod winner_take_all;

pub use elfes::{occupancy, occupancy_from_weights};
pub use peak_ratios::PeakRatios;
pub use profile::{GaussianProfile, PRIOR_TOLERANCE, Profile, ProfileTable};
pub use settings::{Deviation, SettingError, WinnerTakeAllSettings};
pub use winner_take_all::WinnerTakeAll;
