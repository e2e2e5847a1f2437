//! Where the errors of safety maps lie: how far from the robot, on its way, and how far from what is unsafe.

use evigrid_grid::SafetyMap;

use crate::safety_cells::{PlanningDisc, judged_cells};
use crate::{SafetyCounts, SafetyReference};

/// Largest distances of truly safe cells from the nearest unsafe one, in cells; the last group has no end. The
/// first is that of the eight neighbours.
const NEAR_CELLS: [f64; 5] = [1.5, 2.5, 3.5, 5.5, 10.5];

/// Cells counted by where they lie, summed over frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SafetyPlaces {
    /// By distance from the robot: from `n` to `n + 1` metres.
    rings: Vec<SafetyCounts>,
    /// Cells that the robot drives over in a later frame.
    driven: SafetyCounts,
    /// Truly safe cells by distance from the nearest unsafe one.
    from_unsafe: [SafetyCounts; NEAR_CELLS.len() + 1],
}

/// Counts of the cells of one sort of place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceCounts {
    /// `ring`, `driven over later` or `safe, by distance from unsafe`.
    pub place: &'static str,
    /// Smallest and largest distance, metres; `None` where there is no such limit.
    pub range_m: [Option<f64>; 2],
    /// The cells.
    pub counts: SafetyCounts,
}

impl SafetyPlaces {
    /// Adds a map after a frame of the run (its position, from 0).
    pub fn add(&mut self, found: &SafetyMap, truth: &SafetyReference, disc: PlanningDisc, position: usize) {
        let spec = truth.map().spec();
        for cell in judged_cells(found, truth, Some(disc)) {
            let ring = disc.distance_m(spec, cell.flat) as usize;
            if self.rings.len() <= ring {
                self.rings.resize(ring + 1, SafetyCounts::default());
            }
            let label = cell.found.is_safe();
            *self.rings[ring].of(cell.safe, label) += 1;
            if truth.is_driven_after(cell.flat, position) {
                *self.driven.of(cell.safe, label) += 1;
            }
            if cell.safe {
                let cells = truth.from_unsafe_m(cell.flat) / spec.cell_size_m();
                let group = NEAR_CELLS.iter().filter(|&&limit| cells > limit).count();
                *self.from_unsafe[group].of(true, label) += 1;
            }
        }
    }

    /// All places with their counts. `cell_size_m` is that of the true map.
    pub fn list(&self, cell_size_m: f64) -> Vec<PlaceCounts> {
        let place = |place, range_m, counts| PlaceCounts { place, range_m, counts };
        let rings = self.rings.iter().enumerate().map(|(n, &counts)| {
            place("ring around the robot", [Some(n as f64), Some(n as f64 + 1.0)], counts)
        });
        let limit = |n: usize| NEAR_CELLS.get(n).map(|cells| cells * cell_size_m);
        let near = self.from_unsafe.iter().enumerate().map(|(n, &counts)| {
            let from = n.checked_sub(1).and_then(limit).unwrap_or(0.0);
            place("safe, by distance from unsafe", [Some(from), limit(n)], counts)
        });
        let driven = place("driven over later", [None, None], self.driven);
        rings.chain([driven]).chain(near).collect()
    }
}
