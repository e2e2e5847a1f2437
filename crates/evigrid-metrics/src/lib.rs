//! Scores of a map against a reference grid. Arithmetic only: no files, no clock.
//!
//! Every number is a row of [`METRICS`]; docs/metrics.md shows the table. A cell of the map counts as
//! occupied if its log-odds exceed a threshold (0, that is P > 0.5, unless said otherwise); a cell that was
//! never touched is not occupied.

mod base_rows;
mod counts;
mod curve;
mod markdown;
mod matching;
mod metric;
mod plan;
mod plan_band;
mod plan_tally;
mod reference;
mod robust_plane;
mod safety;
mod safety_areas;
mod safety_cells;
mod safety_places;
mod safety_reference;
mod safety_tally;
mod scores;
mod table;
mod tolerance;

pub use counts::{Counts, VoxelCase, count};
pub use curve::{Curve, CurvePoint, curve};
pub use markdown::metrics_markdown;
pub use matching::MatchingScores;
pub use metric::{Better, Kind, Metric, Of, Show, Tolerance, family, main_metric, metric_of};
pub use plan::{PlanCase, PlanCell, PlanCounts};
pub use plan_band::{PlanBandCounts, Reliability, RocPoint};
pub use plan_tally::{FrameCell, PLAN_BANDS_M, PlanTally};
pub use reference::{PlanReference, PlanState, VoxelReference};
pub use safety::{PlaneErrors, SafetyCase, SafetyCounts};
pub use safety_areas::{AreaTally, AreaView};
pub use safety_cells::PlanningDisc;
pub use safety_places::{PlaceCounts, SafetyPlaces};
pub use safety_reference::{NamedArea, SafetyReference};
pub use safety_tally::SafetyTally;
pub use scores::{Score, Scores};
pub use table::METRICS;
pub use tolerance::{Tolerant, within_tolerance};

/// `numerator / denominator`, NaN for 0 / 0.
fn ratio(numerator: usize, denominator: usize) -> f64 {
    numerator as f64 / denominator as f64
}

/// Harmonic mean of two rates; 0 if either is 0 (the other may be undefined then: an empty map has no
/// accuracy, but its F-score is 0), else NaN if either is undefined.
fn harmonic_mean(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { 2.0 * a * b / (a + b) }
}
