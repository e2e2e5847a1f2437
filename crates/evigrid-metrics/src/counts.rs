use rayon::prelude::*;

use crate::{VoxelReference, ratio};

/// Cells per task: enough to hide the cost of starting it, and few enough for 32-bit sums.
const CELLS_PER_TASK: usize = 1 << 14;

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
    /// Those of the missed that were in view of the camera; 0 if nobody tells.
    pub missed_in_view: usize,
}

impl Counts {
    /// The counts of two parts of a map together.
    fn plus(self, other: Self) -> Self {
        Self {
            hits: self.hits + other.hits,
            mistakes: self.mistakes + other.mistakes,
            mistakes_observed: self.mistakes_observed + other.mistakes_observed,
            missed_free: self.missed_free + other.missed_free,
            missed_unknown: self.missed_unknown + other.missed_unknown,
            touched: self.touched + other.touched,
            missed_in_view: self.missed_in_view + other.missed_in_view,
        }
    }

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

    /// Precision of the cells that the laser observed: mistakes of which it knows nothing do not count.
    pub fn precision_observed(&self) -> f64 {
        ratio(self.hits, self.hits + self.mistakes_observed)
    }

    /// F1 with the mistakes that the laser observed only.
    pub fn f1_observed(&self) -> f64 {
        let doubled = 2 * self.hits;
        ratio(doubled, doubled + self.mistakes_observed + self.missed())
    }
}

impl Counts {
    /// Recall with the missed cells that the camera could have seen only.
    pub fn recall_in_view(&self) -> f64 {
        ratio(self.hits, self.hits + self.missed_in_view)
    }

    /// F1 with the missed cells that the camera could have seen, and the mistakes that the laser observed, only.
    pub fn f1_in_view(&self) -> f64 {
        let doubled = 2 * self.hits;
        ratio(doubled, doubled + self.mistakes_observed + self.missed_in_view)
    }
}

/// A map of voxels with its reference, and the counts that most metrics are made of.
#[derive(Debug, Clone, Copy)]
pub struct VoxelCase<'a> {
    /// Log-odds of the map by flat index; NaN = never touched.
    pub log_odds: &'a [f32],
    /// The reference, on the same grid.
    pub reference: &'a VoxelReference<'a>,
    /// Cells counted by what map and reference say of them.
    pub counts: Counts,
}

impl<'a> VoxelCase<'a> {
    /// Counts the cells of a map, given as log-odds by flat index (NaN = never touched).
    pub fn new(log_odds: &'a [f32], reference: &'a VoxelReference<'a>) -> Self {
        Self { log_odds, reference, counts: count(log_odds, reference) }
    }
}

/// Counts the cells of a map, given as log-odds by flat index (NaN = never touched). Cells beyond the
/// shortest of the slices are not counted.
pub fn count(log_odds: &[f32], reference: &VoxelReference<'_>) -> Counts {
    let cells = log_odds.par_chunks(CELLS_PER_TASK);
    let truth =
        reference.occupied.par_chunks(CELLS_PER_TASK).zip(reference.observed.par_chunks(CELLS_PER_TASK));
    cells
        .zip(truth)
        .map(|(log_odds, (occupied, observed))| count_chunk(log_odds, occupied, observed))
        .reduce(Counts::default, Counts::plus)
        .plus(Counts { missed_in_view: missed_in_view(log_odds, reference), ..Counts::default() })
}

/// Cells in view that are occupied in the reference and not in the map.
fn missed_in_view(log_odds: &[f32], reference: &VoxelReference<'_>) -> usize {
    let Some(in_view) = reference.in_view else { return 0 };
    let cells = log_odds.par_chunks(CELLS_PER_TASK).zip(reference.occupied.par_chunks(CELLS_PER_TASK));
    let missed = cells.zip(in_view.par_chunks(CELLS_PER_TASK)).map(|((log_odds, occupied), in_view)| {
        let cells = log_odds.iter().zip(occupied).zip(in_view);
        // A cell that was never touched (NaN) is not occupied either.
        let is_missed = |l: f32| l <= 0.0 || l.is_nan();
        cells.map(|((&l, &truth), &seen)| usize::from(truth & seen & is_missed(l))).sum::<usize>()
    });
    missed.sum()
}

/// Counts one chunk, in 32 bits so that the compiler can count many cells at once.
fn count_chunk(log_odds: &[f32], occupied: &[bool], observed: &[bool]) -> Counts {
    let mut sums = [0_u32; 6];
    for ((&l, &truth), &observed) in log_odds.iter().zip(occupied).zip(observed) {
        let (occupied, unknown) = (l > 0.0, l.is_nan());
        let flags = [
            occupied & truth,
            occupied & !truth,
            occupied & !truth & observed,
            !occupied & truth & !unknown,
            truth & unknown,
            !unknown,
        ];
        (0..6).for_each(|i| sums[i] += u32::from(flags[i]));
    }
    let [hits, mistakes, mistakes_observed, missed_free, missed_unknown, touched] = sums.map(|n| n as usize);
    Counts { hits, mistakes, mistakes_observed, missed_free, missed_unknown, touched, missed_in_view: 0 }
}
