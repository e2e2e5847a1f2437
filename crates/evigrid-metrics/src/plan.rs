use evigrid_grid::PlanGrid;

use crate::{PlanReference, PlanState, ratio};

/// A ground plan with its reference, and the counts and cells that its metrics are made of.
#[derive(Debug, Clone)]
pub struct PlanCase<'a> {
    /// The plan.
    pub plan: &'a PlanGrid,
    /// The reference.
    pub reference: &'a PlanReference,
    /// Cells of the plan that the reference knows.
    pub cells: Vec<PlanCell>,
    /// Cells counted by what plan and reference say of them.
    pub counts: PlanCounts,
}

/// A cell of a plan that the reference knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanCell {
    /// P(occupied); 0.5 where the plan knows nothing.
    pub probability: f32,
    /// Whether the reference says occupied (else free).
    pub occupied: bool,
}

/// Cells of a ground plan counted by what the plan and the reference say of them. Only cells count that the
/// reference knows; a cell of the plan is occupied if P > 0.5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlanCounts {
    /// Occupied in both.
    pub hits: usize,
    /// Occupied in the plan, free in the reference.
    pub mistakes: usize,
    /// Occupied in the reference and not in the plan, or where the plan has no cell.
    pub missed: usize,
}

impl<'a> PlanCase<'a> {
    /// Looks up every cell of the plan in the reference by its centre in the map frame.
    pub fn new(plan: &'a PlanGrid, reference: &'a PlanReference) -> Self {
        let cells: Vec<PlanCell> = known_cells(plan, reference).collect();
        let mut counts = PlanCounts { missed: true_cells_outside(plan, reference), ..PlanCounts::default() };
        for cell in &cells {
            let occupied = cell.probability > 0.5;
            counts.hits += usize::from(occupied && cell.occupied);
            counts.mistakes += usize::from(occupied && !cell.occupied);
            counts.missed += usize::from(!occupied && cell.occupied);
        }
        Self { plan, reference, cells, counts }
    }

    /// Area under the receiver operating characteristic: the chance that an occupied cell of the reference
    /// has a higher probability than a free one, ties counting half (Mann and Whitney's U). NaN without cells
    /// of both kinds.
    pub fn auc(&self) -> f64 {
        let mut cells = self.cells.clone();
        cells.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        // Twice the number of pairs in the right order, so that ties stay whole.
        let (mut free, mut occupied, mut twice_ordered) = (0, 0, 0);
        for ties in cells.chunk_by(|a, b| a.probability == b.probability) {
            let occupied_here = ties.iter().filter(|c| c.occupied).count();
            let free_here = ties.len() - occupied_here;
            twice_ordered += occupied_here * (2 * free + free_here);
            free += free_here;
            occupied += occupied_here;
        }
        ratio(twice_ordered, 2 * free * occupied)
    }
}

impl PlanCounts {
    /// Share of the plan's occupied cells that are so in the reference; NaN for an empty plan.
    pub fn precision(&self) -> f64 {
        ratio(self.hits, self.hits + self.mistakes)
    }

    /// Share of the reference's occupied cells that are so in the plan; NaN for an empty reference.
    pub fn recall(&self) -> f64 {
        ratio(self.hits, self.hits + self.missed)
    }

    /// Harmonic mean of precision and recall. An empty plan has no precision, but its F1 is 0.
    pub fn f1(&self) -> f64 {
        let doubled = 2 * self.hits;
        ratio(doubled, doubled + self.mistakes + self.missed)
    }
}

/// Cells of the plan whose centre lies in a cell that the reference knows.
fn known_cells(plan: &PlanGrid, reference: &PlanReference) -> impl Iterator<Item = PlanCell> {
    plan.probabilities().iter().enumerate().filter_map(|(flat, &p)| {
        let occupied = match reference.cells[reference.spec.cell_of(plan.centre_in_map_m(flat))?] {
            PlanState::Unknown => return None,
            PlanState::Free => false,
            PlanState::Occupied => true,
        };
        Some(PlanCell { probability: if p.is_nan() { 0.5 } else { p }, occupied })
    })
}

/// Number of occupied cells of the reference whose centre no cell of the plan covers.
fn true_cells_outside(plan: &PlanGrid, reference: &PlanReference) -> usize {
    let is_outside = |flat: usize| {
        let centre = plan.map_from_plan().inverse_transform_point(&reference.spec.centre_m(flat).into());
        plan.spec().cell_of(centre.into()).is_none()
    };
    let occupied = reference.cells.iter().enumerate().filter(|(_, state)| **state == PlanState::Occupied);
    occupied.filter(|(flat, _)| is_outside(*flat)).count()
}
