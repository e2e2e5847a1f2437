//! Winner-take-all mapping, the baseline of Brandao et al.: Elfes' inverse model with a Gaussian around the
//! winner of each pixel. `mapper` makes one map; `peak_ratios` makes several that differ in the peak ratio,
//! with the files `nested*`.

mod mapper;
mod method;
mod nested;
mod nested_free_space;
mod nested_reach;
mod peak_ratios;
mod profile;
mod sections;
mod settings;

pub use mapper::WinnerTakeAll;
pub use peak_ratios::PeakRatios;
pub use profile::{GaussianProfile, Profile, ProfileTable};
pub use settings::{Deviation, WinnerTakeAllSettings};
