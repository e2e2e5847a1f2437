//! Elfes' occupancy profile around a measured cell, as a table over the width of the measurement's error.

use evigrid_grid::{Clamp, FrameEvidence, logit};

use crate::occupancy_from_weights;

/// Table rows per cell of deviation.
const ROWS_PER_CELL: f32 = 128.0;
/// The largest deviation of the table, cells.
const MAX_DEVIATION_CELLS: f32 = 16.0;

/// The likelihood of a range measurement, Normal(r; j, sigma^2) over cell indices (Brandao et al., eq. 3), put through
/// Elfes' model. The ray has as many cells on either side of r as have any weight.
#[derive(Debug, Clone)]
pub struct GaussianProfile {
    /// P from the cell `before` steps in front of the measured cell on.
    occupancy: Vec<f64>,
    before: usize,
}

impl GaussianProfile {
    /// The profile for an error of `deviation_cells` (standard deviation, cells).
    pub fn new(deviation_cells: f64) -> Self {
        let variance = deviation_cells * deviation_cells;
        let ln2 = std::f64::consts::LN_2;
        // The weights 2^-j exp(-j^2 / (2 var)) are a Gaussian around -var ln 2: 9 deviations hold all of it.
        let before = (variance * ln2 + 9.0 * deviation_cells).ceil() as usize + 1;
        let behind = (9.0 * deviation_cells).ceil() as usize + 1;
        let largest = 0.5 * variance * ln2 * ln2;
        let weights: Vec<f64> = (0..=before + behind)
            .map(|k| {
                let j = k as f64 - before as f64;
                (-j * ln2 - j * j / (2.0 * variance) - largest).exp()
            })
            .collect();
        Self { occupancy: occupancy_from_weights(&weights), before }
    }

    /// P(O | r) of the cell `steps` in front of the measured cell (0: that cell itself, negative: behind it).
    pub fn at(&self, steps: i64) -> f64 {
        let index = self.before as i64 - steps;
        if index < 0 {
            return 0.0;
        }
        self.occupancy.get(index as usize).copied().unwrap_or(0.5)
    }
}

/// [`GaussianProfile`] as log-odds keys, for the measured cell and those in front of it.
///
/// The deviation is rounded to 1/128 of a cell, which moves P by less than 0.006 (asserted in the tests). Deviations
/// above 16 cells are taken as 16: by then the measured cell itself is left with P < 0.52.
#[derive(Debug, Clone)]
pub struct ProfileTable {
    keys: Vec<i32>,
    /// Where each row begins in `keys`.
    starts: Vec<usize>,
    free: i32,
}

impl ProfileTable {
    /// The table, with its log-odds kept within `clamp`.
    pub fn new(clamp: Clamp) -> Self {
        let mut table = Self { keys: Vec::new(), starts: vec![0], free: FrameEvidence::key(clamp.min) };
        for row in 1..=(MAX_DEVIATION_CELLS * ROWS_PER_CELL) as u32 {
            let profile = GaussianProfile::new(f64::from(row) / f64::from(ROWS_PER_CELL));
            for steps in 0.. {
                let log_odds = (logit(profile.at(steps)) as f32).clamp(clamp.min, clamp.max);
                if log_odds <= clamp.min {
                    break;
                }
                table.keys.push(FrameEvidence::key(log_odds));
            }
            table.starts.push(table.keys.len());
        }
        table
    }

    /// The keys for a deviation in cells: entry k belongs to the cell k steps in front of the measured one.
    /// Cells further in front than the row is long are free ([`Self::free`]).
    #[inline]
    pub fn row(&self, deviation_cells: f32) -> &[i32] {
        let row = (deviation_cells.min(MAX_DEVIATION_CELLS) * ROWS_PER_CELL + 0.5) as usize;
        let row = row.max(1) - 1;
        &self.keys[self.starts[row]..self.starts[row + 1]]
    }

    /// The key of a cell far in front of the measured one.
    #[inline]
    pub fn free(&self) -> i32 {
        self.free
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occupancy;

    #[test]
    fn the_profile_is_the_closed_form_on_a_long_ray() {
        for deviation in [0.3_f64, 1.0, 5_f64.sqrt(), 4.0] {
            let profile = GaussianProfile::new(deviation);
            let r = 200;
            let g: Vec<f64> =
                (1..=300).map(|j| (-f64::from(j - r).powi(2) / (2.0 * deviation * deviation)).exp()).collect();
            for (j, p) in (1..=300).zip(occupancy(&g)) {
                let found = profile.at(i64::from(r - j));
                assert!((found - p).abs() < 1e-9, "deviation {deviation}, cell {j}: {found}, expected {p}");
            }
        }
    }

    #[test]
    fn the_table_stays_within_its_stated_error() {
        let clamp = Clamp { min: -5.0, max: 5.0 };
        let table = ProfileTable::new(clamp);
        let value = |keys: &[i32], steps: usize| {
            let key = keys.get(steps).copied().unwrap_or(table.free());
            let bits = key ^ (((key >> 31) as u32) >> 1) as i32;
            evigrid_grid::probability(f64::from(f32::from_bits(bits as u32)))
        };
        let mut worst = 0.0_f64;
        for k in 0..3999 {
            let deviation = 0.002 + 0.004 * f64::from(k);
            let profile = GaussianProfile::new(deviation);
            let row = table.row(deviation as f32);
            for steps in 0..(row.len() + 3) {
                let p = profile.at(steps as i64);
                let clamped = p.clamp(evigrid_grid::probability(-5.0), evigrid_grid::probability(5.0));
                worst = worst.max((value(row, steps) - clamped).abs());
            }
        }
        assert!(worst < 0.006, "{worst}");
        assert!(GaussianProfile::new(16.0).at(0) < 0.52);
    }
}
