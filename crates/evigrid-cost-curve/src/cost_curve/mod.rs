//! The method of Brandao et al., section III: the whole cost curve of each pixel as evidence for the cells of
//! its ray.

mod cost_exponent;
mod curve_block;
mod curve_cells;
mod curve_lines;
mod frame_curves;
mod mapper;
mod settings;
pub mod whole_curve;

pub use cost_exponent::{CostExponent, CostUnit};
pub use mapper::CostCurve;
pub use settings::{CostCurveSettings, HypothesesToCells};
