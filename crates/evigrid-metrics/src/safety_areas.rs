//! Whether named hazards are found, and from how far.

use evigrid_grid::SafetyMap;

use crate::safety_cells::{PlanningDisc, judged_cells};
use crate::{NamedArea, SafetyCounts, SafetyReference, ratio};

/// A named hazard or safe area in the maps of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaTally {
    /// The area.
    pub area: NamedArea,
    /// Its cells within the planning radius, summed over frames.
    pub counts: SafetyCounts,
    /// The frame in which the robot is nearest, first of equals.
    pub nearest: Option<AreaView>,
    /// The first frame in which a cell of it is right.
    pub first: Option<AreaView>,
    /// The first frame in which half of its cells within the planning radius are right.
    pub half: Option<AreaView>,
}

/// An area in the map of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaView {
    /// Distance of the robot from the nearest of its cells, metres.
    pub distance_m: f64,
    /// Its cells within the planning radius.
    pub counts: SafetyCounts,
}

impl AreaTally {
    /// An area that no map has shown yet.
    pub fn new(area: NamedArea) -> Self {
        let (nearest, first, half) = (None, None, None);
        Self { area, counts: SafetyCounts::default(), nearest, first, half }
    }

    /// Share of its cells that are right: unsafe ones of a hazard, safe ones of a safe area. NaN without cells.
    pub fn recall(&self, counts: &SafetyCounts) -> f64 {
        ratio(self.right(counts), counts.truly_safe() + counts.truly_unsafe())
    }

    /// Share of its cells that are wrong: safe ones of a hazard, unsafe ones of a safe area. NaN without cells.
    pub fn wrong(&self, counts: &SafetyCounts) -> f64 {
        ratio(counts.false_negatives + counts.false_positives, counts.truly_safe() + counts.truly_unsafe())
    }

    fn right(&self, counts: &SafetyCounts) -> usize {
        if self.area.is_safe { counts.true_negatives } else { counts.true_positives }
    }

    fn add(&mut self, view: AreaView) {
        self.counts.add(&view.counts);
        if self.nearest.is_none_or(|nearest| view.distance_m < nearest.distance_m) {
            self.nearest = Some(view);
        }
        if self.right(&view.counts) > 0 {
            self.first.get_or_insert(view);
        }
        if self.recall(&view.counts) >= 0.5 {
            self.half.get_or_insert(view);
        }
    }
}

/// Adds a map after a frame to the tallies of a truth's areas, which stand in the same order.
pub(crate) fn add_to_areas(
    tallies: &mut [AreaTally],
    found: &SafetyMap,
    truth: &SafetyReference,
    disc: PlanningDisc,
) {
    let spec = truth.map().spec();
    let mut counts_of = vec![None; spec.cell_count()];
    for cell in judged_cells(found, truth, Some(disc)) {
        counts_of[cell.flat] = Some((cell.safe, cell.found.is_safe()));
    }
    for tally in tallies {
        let mut counts = SafetyCounts::default();
        let mut distance_m = f64::INFINITY;
        for &flat in &tally.area.cells {
            if let Some((safe, label)) = counts_of[flat] {
                *counts.of(safe, label) += 1;
                distance_m = distance_m.min(disc.distance_m(spec, flat));
            }
        }
        if distance_m.is_finite() {
            tally.add(AreaView { distance_m, counts });
        }
    }
}
