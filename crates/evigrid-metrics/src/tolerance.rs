use evigrid_grid::GridSpec;
use rayon::prelude::*;

use crate::{VoxelReference, harmonic_mean, ratio};

/// Cells per task: enough to hide the cost of starting it.
const CELLS_PER_TASK: usize = 1 << 14;

/// Scores that forgive a small distance, as Tanks and Temples (Knapitsch et al. 2017) does for points: much
/// of what counts as a mistake lies one cell beside the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerant {
    /// Largest distance between the centres of a cell and its nearest counterpart, metres.
    pub tolerance_m: f64,
    /// Share of the map's occupied cells that have a true cell within the tolerance.
    pub accuracy: f64,
    /// Share of the true cells that have an occupied cell of the map within the tolerance.
    pub completeness: f64,
    /// Harmonic mean of the two.
    pub f_score: f64,
}

/// Scores a map (log-odds by flat index) within a tolerance.
pub fn within_tolerance(log_odds: &[f32], reference: &VoxelReference<'_>, tolerance_m: f64) -> Tolerant {
    let ball = Ball::new(reference.spec, tolerance_m);
    let is_true = |cell: usize| reference.occupied[cell];
    let is_occupied = |cell: usize| log_odds[cell] > 0.0;
    let cells = log_odds.len().min(reference.occupied.len());
    let judge = |sum: &mut [usize; 4], cell: usize| {
        let (occupied, truth) = (is_occupied(cell), is_true(cell));
        if occupied || truth {
            let accurate = occupied && (truth || ball.any(cell, is_true));
            let complete = truth && (occupied || ball.any(cell, is_occupied));
            let flags = [occupied, accurate, truth, complete];
            (0..4).for_each(|i| sum[i] += usize::from(flags[i]));
        }
    };
    let [occupied, accurate, truths, complete] = (0..cells.div_ceil(CELLS_PER_TASK))
        .into_par_iter()
        .map(|task| {
            let mut sum = [0; 4];
            let first = task * CELLS_PER_TASK;
            (first..cells.min(first + CELLS_PER_TASK)).for_each(|cell| judge(&mut sum, cell));
            sum
        })
        .reduce(|| [0; 4], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    let (accuracy, completeness) = (ratio(accurate, occupied), ratio(complete, truths));
    Tolerant { tolerance_m, accuracy, completeness, f_score: harmonic_mean(accuracy, completeness) }
}

/// The cells within a distance of a cell.
struct Ball {
    shape: [i64; 3],
    strides: [i64; 3],
    offsets: Vec<[i64; 3]>,
}

impl Ball {
    fn new(spec: &GridSpec, radius_m: f64) -> Self {
        // 0.4 m are two cells of 0.2 m, whatever the last bit of the quotient says.
        let radius = radius_m / spec.cell_size_m() + 1e-6;
        // No cell is farther away than the grid is long.
        let reach = spec.shape().map(|n| (radius as i64).min(n as i64 - 1));
        let axis = move |a: usize| -reach[a]..=reach[a];
        let mut offsets: Vec<_> = axis(0)
            .flat_map(|i| axis(1).flat_map(move |j| axis(2).map(move |k| [i, j, k])))
            .filter(|o| (squared_norm(o) as f64) <= radius * radius && *o != [0; 3])
            .collect();
        offsets.sort_by_key(squared_norm);
        Self { shape: spec.shape().map(|n| n as i64), strides: spec.strides().map(|n| n as i64), offsets }
    }

    /// Whether any cell of the ball around `flat`, itself excluded, satisfies `holds`.
    fn any(&self, flat: usize, holds: impl Fn(usize) -> bool) -> bool {
        let [_, ny, nz] = self.shape;
        let flat = flat as i64;
        let at = [flat / (ny * nz), flat / nz % ny, flat % nz];
        self.offsets.iter().any(|offset| {
            let inside = (0..3).all(|a| (0..self.shape[a]).contains(&(at[a] + offset[a])));
            let shift: i64 = (0..3).map(|a| offset[a] * self.strides[a]).sum();
            inside && holds((flat + shift) as usize)
        })
    }
}

fn squared_norm(offset: &[i64; 3]) -> i64 {
    offset.iter().map(|v| v * v).sum()
}
