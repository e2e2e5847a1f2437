//! Moves cells between segments: Algorithm 1 cuts by layers of voxels, so the foot of a ramp belongs to the floor
//! until it has risen by half a voxel. (Own addition.)

use crate::columns::Columns;
use crate::segments::{Segment, Segments};

impl Segments {
    /// Moves cells to a neighbouring segment whose plane their points lie nearer to (root mean square) by more than
    /// `gain_m`, and fits the planes anew, until nothing moves. A plane grows by one cell a round, and by one metre
    /// at most.
    pub(crate) fn reassigned(mut self, columns: &Columns, gain_m: f64) -> Self {
        let rounds = (1.0 / columns.spec().cell_size_m()).ceil() as usize;
        for _ in 0..rounds {
            let moves = self.moves(columns, gain_m);
            if moves.is_empty() {
                break;
            }
            moves.iter().for_each(|&(cell, to)| self.of_cell[cell as usize] = Some(to as u32));
            self.gather(columns);
        }
        self
    }

    /// Cells that fit another segment better, with that segment.
    fn moves(&self, columns: &Columns, gain_m: f64) -> Vec<(u32, usize)> {
        let mut moves = Vec::new();
        for (own, segment) in self.list.iter().enumerate() {
            let moved = segment
                .cells
                .iter()
                .filter_map(|&cell| Some((cell, self.better(columns, own, cell, gain_m)?)));
            moves.extend(moved);
        }
        moves
    }

    /// The segment next to a cell whose plane fits it best, if that is not its own.
    fn better(&self, columns: &Columns, own: usize, cell: u32, gain_m: f64) -> Option<usize> {
        let others = columns.spec().neighbours(cell as usize).filter_map(|n| self.of(n));
        let mut others = others.filter(|&other| other != own).peekable();
        others.peek()?;
        let moments = columns.get(cell as usize)?.moments;
        let misfit = |segment: usize| Some(moments.distance_m(&self.list[segment].plane?));
        let mut best = (misfit(own).map_or(f64::INFINITY, |own| own - gain_m), own);
        for other in others {
            if let Some(misfit_m) = misfit(other).filter(|&m| m < best.0) {
                best = (misfit_m, other);
            }
        }
        (best.1 != own).then_some(best.1)
    }

    /// Collects the cells of all segments again. Segments without cells are dropped.
    fn gather(&mut self, columns: &Columns) {
        let mut cells = vec![Vec::new(); self.list.len()];
        for cell in self.list.iter().flat_map(|segment| &segment.cells) {
            if let Some(to) = self.of(*cell as usize) {
                cells[to].push(*cell);
            }
        }
        self.list.clear();
        for cells in cells.into_iter().filter(|cells| !cells.is_empty()) {
            let number = self.list.len() as u32;
            cells.iter().for_each(|&cell| self.of_cell[cell as usize] = Some(number));
            self.list.push(Segment { cells, interior: 0, plane: None });
        }
        self.fit_planes(columns);
    }
}
