use evigrid_grid::LogOddsGrid;
use evigrid_metrics::{Counts, Curve, Reference, Tolerant, count, curve, within_tolerance};

/// All scores of a map at one moment, except the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Scores {
    /// Hits, mistakes, missed.
    pub counts: Counts,
    /// The tolerant scores, one per tolerance.
    pub tolerant: Vec<Tolerant>,
    /// Occupied cells of the reference.
    pub true_cells: usize,
    /// Cells that the laser observed.
    pub observed_cells: usize,
}

impl Scores {
    /// Scores a map.
    pub fn of(map: &LogOddsGrid, reference: &Reference<'_>, tolerances_m: &[f64]) -> Self {
        let count_true = |cells: &[bool]| cells.iter().filter(|c| **c).count();
        Self {
            counts: count(map.values(), reference),
            tolerant: tolerances_m.iter().map(|&t| within_tolerance(map.values(), reference, t)).collect(),
            true_cells: count_true(reference.occupied),
            observed_cells: count_true(reference.observed),
        }
    }
}

/// What a run found for one method.
#[derive(Debug, Clone)]
pub struct MethodResult {
    /// Name of the method.
    pub method: String,
    /// Final scores; `None` without any laser scan.
    pub scores: Option<Scores>,
    /// Hits against mistakes over the threshold; `None` without any laser scan.
    pub curve: Option<Curve>,
}

impl MethodResult {
    /// Scores a final map.
    pub fn of(
        method: &str,
        map: &LogOddsGrid,
        reference: Option<&Reference<'_>>,
        tolerances_m: &[f64],
    ) -> Self {
        Self {
            method: method.to_owned(),
            scores: reference.map(|r| Scores::of(map, r, tolerances_m)),
            curve: reference.map(|r| curve(map.values(), r)),
        }
    }
}
