use evigrid_grid::GridSpec;

use crate::{harmonic_mean, ratio};

/// What the laser says of each cell, by flat index. All three describe the same grid as the map.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// The grid.
    pub spec: &'a GridSpec,
    /// Cells that were ever occupied.
    pub occupied: &'a [bool],
    /// Cells that any laser ray touched.
    pub observed: &'a [bool],
}

/// Cells counted by what the map and the reference say of them (Brandao et al., section IV-B).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Occupied in both.
    pub hits: usize,
    /// Occupied in the map, not in the reference.
    pub mistakes: usize,
    /// Those of the mistakes that the laser observed; of the others it knows nothing.
    pub mistakes_observed: usize,
    /// Occupied in the reference, free in the map.
    pub missed_free: usize,
    /// Occupied in the reference, never touched by the map.
    pub missed_unknown: usize,
    /// Cells that the map has touched.
    pub touched: usize,
}

impl Counts {
    /// Occupied in the reference, not in the map.
    pub fn missed(&self) -> usize {
        self.missed_free + self.missed_unknown
    }

    /// Share of the map's occupied cells that are so in the reference; NaN for an empty map.
    pub fn precision(&self) -> f64 {
        ratio(self.hits, self.hits + self.mistakes)
    }

    /// Share of the reference's occupied cells that are so in the map; NaN for an empty reference.
    pub fn recall(&self) -> f64 {
        ratio(self.hits, self.hits + self.missed())
    }

    /// Harmonic mean of precision and recall. An empty map has no precision, but its F1 is 0.
    pub fn f1(&self) -> f64 {
        let doubled = 2 * self.hits;
        ratio(doubled, doubled + self.mistakes + self.missed())
    }

    /// The same with the mistakes that the laser observed only: precision and F1.
    pub fn observed_precision_and_f1(&self) -> (f64, f64) {
        let precision = ratio(self.hits, self.hits + self.mistakes_observed);
        (precision, harmonic_mean(precision, self.recall()))
    }
}

/// Counts the cells of a map, given as log-odds by flat index (NaN = never touched).
///
/// # Panics
/// Never; cells beyond the shorter of the slices are not counted.
pub fn count(log_odds: &[f32], reference: &Reference<'_>) -> Counts {
    let mut counts = Counts::default();
    for ((&l, &truth), &observed) in log_odds.iter().zip(reference.occupied).zip(reference.observed) {
        let occupied = l > 0.0;
        counts.touched += usize::from(!l.is_nan());
        counts.hits += usize::from(occupied & truth);
        counts.mistakes += usize::from(occupied & !truth);
        counts.mistakes_observed += usize::from(occupied & !truth & observed);
        counts.missed_free += usize::from(!occupied & truth & !l.is_nan());
        counts.missed_unknown += usize::from(truth & l.is_nan());
    }
    counts
}
