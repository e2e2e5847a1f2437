//! A ray cut at the faces of cells and at the ends of hypotheses.

use evigrid_grid::ViewRays;

use crate::depth_walk::DepthWalk;
use crate::hypotheses::Hypotheses;

/// A cell that a ray passes before its greatest depth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    /// Flat index of the cell; `None` outside the grid.
    pub flat: Option<usize>,
    /// Where its parts begin in [`RaySections::parts`]; they end where those of the next begin.
    pub first_part: usize,
}

/// The part of a cell that one hypothesis takes up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    /// Number of the hypothesis, counted from the nearest.
    pub hypothesis: u32,
    /// Share of the cell's length, 0 to 1.
    pub share: f32,
}

/// All cells of a ray up to the greatest depth, in the grid or not.
#[derive(Debug, Default)]
pub(crate) struct RaySections {
    /// The cells from the camera on.
    pub cells: Vec<Section>,
    /// The parts of all cells, one cell after the other.
    parts: Vec<Part>,
}

impl RaySections {
    /// Cuts the ray with a direction in cells per metre of depth.
    pub fn fill(&mut self, rays: &ViewRays<'_>, hypotheses: &Hypotheses, direction: [f64; 3]) {
        self.cells.clear();
        self.parts.clear();
        let mut walk = DepthWalk::new(rays, direction);
        // In front of the nearest hypothesis there is none.
        let mut i = 0;
        while walk.enter_m < rays.max_depth_m {
            let (enter, leave) = (walk.enter_m, walk.leave_m().min(rays.max_depth_m));
            if leave > enter {
                let flat = rays.spec.flat(walk.cell);
                self.cells.push(Section { flat, first_part: self.parts.len() });
                i = self.cut(hypotheses, i, enter, leave);
            }
            walk.step();
        }
    }

    /// Adds the parts of a cell; `i` is the first hypothesis that may lie in it. Returns that of the next
    /// cell.
    fn cut(&mut self, hypotheses: &Hypotheses, mut i: usize, enter: f64, leave: f64) -> usize {
        let per_metre = 1.0 / (leave - enter);
        let far_m = hypotheses.far_m();
        while i < far_m.len() && hypotheses.near_m(i) < leave {
            let length = far_m[i].min(leave) - hypotheses.near_m(i).max(enter);
            if length > 0.0 {
                self.parts.push(Part { hypothesis: i as u32, share: (length * per_metre) as f32 });
            }
            if far_m[i] > leave {
                break;
            }
            i += 1;
        }
        i
    }

    /// The parts of a cell.
    #[inline(always)]
    pub fn parts_of(&self, cell: usize) -> &[Part] {
        let end = self.cells.get(cell + 1).map_or(self.parts.len(), |next| next.first_part);
        &self.parts[self.cells[cell].first_part..end]
    }
}
