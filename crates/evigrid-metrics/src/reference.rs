use std::ops::Range;

use evigrid_grid::{GridSpec, PlanSpec};

/// Occupied and observed voxels that a map is scored against, by flat index. All describe the same grid as
/// the map.
#[derive(Debug, Clone, Copy)]
pub struct VoxelReference<'a> {
    /// The grid.
    pub spec: &'a GridSpec,
    /// Cells that were ever occupied.
    pub occupied: &'a [bool],
    /// Cells of which the reference knows anything: those that any laser ray touched.
    pub observed: &'a [bool],
    /// Cells that hold a return of the laser which the left camera could see: it projects into the left image of the
    /// same frame, within the limits of depth. `None`: nobody tells.
    pub in_view: Option<&'a [bool]>,
}

impl VoxelReference<'_> {
    /// Number of occupied cells.
    pub fn true_cells(&self) -> usize {
        self.occupied.iter().filter(|c| **c).count()
    }

    /// Number of occupied cells in view; `None` if nobody tells what is in view.
    pub fn true_cells_in_view(&self) -> Option<usize> {
        let in_view = self.in_view?;
        Some(self.occupied.iter().zip(in_view).filter(|(occupied, in_view)| **occupied && **in_view).count())
    }

    /// Number of observed cells.
    pub fn observed_cells(&self) -> usize {
        self.observed.iter().filter(|c| **c).count()
    }
}

/// State of one cell of a ground plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanState {
    /// Never observed.
    Unknown,
    /// Observed, and nothing in it.
    Free,
    /// Something in it.
    Occupied,
}

/// A ground plan that plans are scored against, fixed in the map frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanReference {
    /// The geometry of the cells, in the map frame.
    pub spec: PlanSpec,
    /// State of each cell of `spec`, by flat index.
    pub cells: Vec<PlanState>,
}

impl PlanReference {
    /// The plan of the voxels in these levels: a column is occupied if any of its voxels is, else free if any
    /// was observed, else unknown.
    ///
    /// # Panics
    /// If there are fewer levels than that.
    pub fn projected(voxels: &VoxelReference<'_>, levels: Range<usize>) -> Self {
        let nz = voxels.spec.shape()[2];
        let columns = voxels.occupied.chunks_exact(nz).zip(voxels.observed.chunks_exact(nz));
        let any = |column: &[bool]| column[levels.clone()].contains(&true);
        let cells = columns.map(|(occupied, observed)| match (any(occupied), any(observed)) {
            (true, _) => PlanState::Occupied,
            (false, true) => PlanState::Free,
            (false, false) => PlanState::Unknown,
        });
        Self { spec: voxels.spec.plan(), cells: cells.collect() }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::GridSettings;

    #[test]
    fn a_column_is_occupied_before_it_is_free_and_free_before_it_is_unknown() {
        let settings = GridSettings { x_m: [0.0, 4.0], y_m: [0.0, 1.0], z_m: [0.0, 3.0], cell_size_m: 1.0 };
        let spec = GridSpec::new(&settings).unwrap();
        let (no, yes) = (false, true);
        let occupied = [no, yes, no, no, no, no, yes, no, no, no, no, no];
        let observed = [no, yes, no, no, yes, no, yes, no, no, yes, no, no];
        let voxels = VoxelReference { spec: &spec, occupied: &occupied, observed: &observed, in_view: None };
        assert_eq!((voxels.true_cells(), voxels.observed_cells()), (2, 4));
        let plan = PlanReference::projected(&voxels, 1..3);
        assert_eq!(plan.spec, spec.plan());
        use PlanState::{Free, Occupied, Unknown};
        assert_eq!(plan.cells, [Occupied, Free, Unknown, Unknown]);
        assert_eq!(PlanReference::projected(&voxels, 3..3).cells, [Unknown; 4]);
    }
}
