//! The grid over columns and disparities.

use rayon::prelude::*;

use crate::counts::{Counts, LANES, Rows};
use crate::probability::{CellCounts, CellProbabilities, Parameters, Table};
use crate::{LevelView, Pixels};

/// Occupancy over the columns of the image and the whole disparities from 1 on.
#[derive(Debug)]
pub struct UDisparityGrid {
    parameters: Parameters,
    count_road: bool,
    columns: usize,
    rows: Rows,
    table: Table,
    counts: Counts,
    /// Cells with road, with one more column and row on all sides.
    around: Vec<u8>,
    /// Cells with road among a cell and its neighbours, disparity by disparity.
    road: Vec<u8>,
    total: Vec<f32>,
}

/// Disparities per task.
const ROWS_PER_TASK: usize = 8;

impl UDisparityGrid {
    /// An empty grid for the disparities 1 to `disparities`, of heights up to `top_m` over the ground. `count_road`:
    /// road pixels beyond a cell count as visible.
    pub fn new(
        view: &LevelView,
        top_m: f64,
        disparities: usize,
        parameters: Parameters,
        count_road: bool,
    ) -> Self {
        let (columns, rows) = (view.rig.width, Rows::new(view, top_m, disparities));
        let cells = columns * disparities;
        let table = Table::new(parameters, view.rig.height);
        let (counts, road, total) = (Counts::default(), vec![0; cells], vec![0.5; cells]);
        let around = Vec::new();
        Self { parameters, count_road, columns, rows, table, counts, around, road, total }
    }

    /// Fills the grid from the pixels of a frame.
    pub fn fill(&mut self, pixels: &Pixels) {
        self.counts.fill(pixels, &self.rows, self.count_road);
        let (columns, rows, counts, table) = (self.columns, &self.rows, &self.counts, &self.table);
        let stride = columns + 2;
        self.around.resize((rows.disparities() + 2) * stride, 0);
        for (d, cells) in self.around.chunks_exact_mut(stride).enumerate().skip(1).take(rows.disparities()) {
            for (block, cells) in counts.blocks().iter().zip(cells[1..=columns].chunks_mut(LANES)) {
                cells.copy_from_slice(&block.is_road[d][..cells.len()]);
            }
        }
        let around = &self.around;
        let cells = self.total.par_chunks_exact_mut(columns).zip(self.road.par_chunks_exact_mut(columns));
        cells.enumerate().with_min_len(ROWS_PER_TASK).for_each(|(index, (total, road))| {
            let d = index + 1;
            neighbouring_road(around, d, road);
            let row = table.row(rows.possible(d));
            for (number, block) in counts.blocks().iter().enumerate() {
                let from = number * LANES;
                let cells = total[from..].iter_mut().zip(&road[from..]);
                let counts = block.visible[d].iter().zip(&block.observed[d]);
                for ((total, &road), (&visible, &observed)) in cells.zip(counts) {
                    *total = row.total(visible, observed, road);
                }
            }
        });
    }

    /// The rows of the image that could show each disparity.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The largest disparity.
    pub fn disparities(&self) -> usize {
        self.rows.disparities()
    }

    /// P(T) of every cell: all columns of disparity 1, of disparity 2, and so on.
    pub fn total(&self) -> &[f32] {
        &self.total
    }

    /// The pixels of a cell; disparities count from 1.
    pub fn counts(&self, column: usize, disparity: usize) -> CellCounts {
        CellCounts {
            possible: self.rows.possible(disparity),
            visible: self.counts.visible(column, disparity),
            observed: self.counts.observed(column, disparity),
            road: self.road[(disparity - 1) * self.columns + column],
        }
    }

    /// All probabilities of a cell; disparities count from 1.
    pub fn probabilities(&self, column: usize, disparity: usize) -> CellProbabilities {
        self.parameters.cell(self.counts(column, disparity))
    }
}

/// For each column the number of road cells among the cell at `d` and its eight neighbours; outside is none. `around`
/// holds the road cells of all disparities from 0 on, with one more column on both sides.
fn neighbouring_road(around: &[u8], d: usize, out: &mut [u8]) {
    let stride = out.len() + 2;
    out.fill(0);
    for row in d - 1..=d + 1 {
        let cells = &around[row * stride..(row + 1) * stride];
        let (left, here, right) = (&cells[..out.len()], &cells[1..][..out.len()], &cells[2..][..out.len()]);
        for (((out, left), here), right) in out.iter_mut().zip(left).zip(here).zip(right) {
            *out += left + here + right;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::{GroundPlane, Mounting, StereoRig};

    #[test]
    fn cells_are_those_of_the_equations() {
        let rig = StereoRig {
            width: 45,
            height: 60,
            focal_px: 50.0,
            centre_x_px: 22.0,
            centre_y_px: 25.0,
            baseline_m: 0.4,
        };
        let ground = GroundPlane::below(&Mounting::over_middle(1.0, 0.0)).disparities(&rig);
        let view = LevelView::new(&rig, &ground).unwrap();
        let parameters =
            Parameters { false_positive: 0.1, false_negative: 0.03, tau_obstacle: 0.2, tau_road: 0.3 };
        let mut grid = UDisparityGrid::new(&view, 1.5, 12, parameters, false);
        let obstacles: Vec<u16> =
            (0..45 * 60).map(|n| if n % 5 < 2 { (n * 7 % 13) as u16 } else { 0 }).collect();
        let road: Vec<u16> =
            (0..45 * 60).map(|n| if n % 11 == 3 { (n * 5 % 14) as u16 } else { 0 }).collect();
        grid.fill(&Pixels { width: 45, height: 60, obstacles, road: road.clone() });
        let seen = |u: i64, d: i64| {
            let is_in = (0..45).contains(&u) && (1..=12).contains(&d);
            is_in && (0..60).any(|row| i64::from(road[(row * 45 + u) as usize]) == d)
        };
        for (u, d) in (0..45).flat_map(|u| (1..=12).map(move |d| (u, d))) {
            let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (u as i64 + a, d as i64 + b)));
            let counts = grid.counts(u, d);
            assert_eq!(usize::from(counts.road), around.filter(|(u, d)| seen(*u, *d)).count(), "{u} {d}");
            let total = f64::from(grid.total()[(d - 1) * 45 + u]);
            assert!((total - grid.probabilities(u, d).total).abs() < 1e-7);
        }
    }
}
