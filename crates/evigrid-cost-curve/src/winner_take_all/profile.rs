//! Elfes' occupancy profile around a measured cell, as a table over the width of the measurement's error.

use evigrid_grid::{Clamp, FrameEvidence, logit};

use crate::elfes::{PRIOR_TOLERANCE, occupancy_from_weights};

/// Table rows per cell of deviation.
const ROWS_PER_CELL: f32 = 128.0;
/// The largest deviation of the table, cells.
const MAX_DEVIATION_CELLS: f32 = 16.0;

/// The likelihood of a range measurement, Normal(r; j, sigma^2) over cell indices (Brandao et al., eq. 3),
/// put through Elfes' model. The ray has as many cells on either side of r as have any weight.
#[derive(Debug, Clone)]
pub struct GaussianProfile {
    /// P of the cells from `before` steps in front of the measured cell on, outwards.
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

    /// Occupancy P(O | r) of the cell `steps` in front of the measured cell (0: that cell itself, negative:
    /// behind it).
    pub fn at(&self, steps: i64) -> f64 {
        let index = self.before as i64 - steps;
        if index < 0 {
            return 0.0;
        }
        self.occupancy.get(index as usize).copied().unwrap_or(0.5)
    }
}

/// The profiles of all deviations ([`GaussianProfile`]) as log-odds keys around the measured cell.
///
/// The deviation is rounded to 1/128 of a cell, which moves P by less than 0.006 (asserted in the tests).
/// Deviations above 16 cells are taken as 16: by then the measured cell itself is left with P < 0.52.
#[derive(Debug, Clone)]
pub struct ProfileTable {
    keys: Vec<i32>,
    rows: Vec<Row>,
    free: i32,
}

/// The keys of one deviation: their range in the table, and how many belong to cells behind the measured one.
#[derive(Debug, Clone, Copy)]
struct Row {
    start: u32,
    end: u32,
    behind: i32,
}

/// The profile of one measurement.
#[derive(Debug, Clone, Copy)]
pub struct Profile<'a> {
    /// Keys from the last cell behind the measured one that still gets evidence to the first in front of it
    /// that is simply free.
    keys: &'a [i32],
    /// How many cells behind the measured one get evidence.
    behind: i32,
    /// Key of a cell that is simply free.
    free: i32,
}

impl ProfileTable {
    /// The table, with the evidence kept within `bounds`. In front, a profile ends where it has sunk to the
    /// lower bound; behind, where it has come back to the prior within [`crate::PRIOR_TOLERANCE`].
    pub fn new(bounds: Clamp) -> Self {
        let mut table = Self { keys: Vec::new(), rows: Vec::new(), free: FrameEvidence::key(bounds.min) };
        for row in 1..=(MAX_DEVIATION_CELLS * ROWS_PER_CELL) as u32 {
            let profile = GaussianProfile::new(f64::from(row) / f64::from(ROWS_PER_CELL));
            let start = table.keys.len() as u32;
            let log_odds = |steps: i64| logit(profile.at(steps)) as f32;
            let behind = (1..).take_while(|&k| log_odds(-k) >= PRIOR_TOLERANCE).count() as i32;
            let keys = (i64::from(-behind)..)
                .map(log_odds)
                .enumerate()
                .take_while(|&(k, l)| k as i32 <= behind || l > bounds.min)
                .map(|(_, l)| FrameEvidence::key(l.clamp(bounds.min, bounds.max)));
            table.keys.extend(keys);
            table.rows.push(Row { start, end: table.keys.len() as u32, behind });
        }
        table
    }

    /// The key of a cell that is simply free: the lower bound.
    pub fn free(&self) -> i32 {
        self.free
    }

    /// The profile for a deviation in cells.
    #[inline]
    pub fn profile(&self, deviation_cells: f32) -> Profile<'_> {
        let row = (deviation_cells.min(MAX_DEVIATION_CELLS) * ROWS_PER_CELL + 0.5) as usize;
        let Row { start, end, behind } = self.rows[row.max(1) - 1];
        Profile { keys: &self.keys[start as usize..end as usize], behind, free: self.free }
    }
}

impl Profile<'_> {
    /// How many cells behind the measured one get evidence.
    #[inline]
    pub fn behind(&self) -> i32 {
        self.behind
    }

    /// How many cells in front of the measured one are more than simply free, the measured one included.
    #[inline]
    pub fn in_front(&self) -> i32 {
        self.keys.len() as i32 - self.behind
    }

    /// The keys of a ray's cells one after the other, from the one `steps` in front of the measured cell
    /// (less than [`Self::in_front`]) to the last one behind it. None if `steps` is already behind that.
    #[inline]
    pub fn keys_from(&self, steps: i32) -> impl Iterator<Item = &i32> {
        let count = (steps + self.behind + 1).clamp(0, self.keys.len() as i32);
        self.keys[..count as usize].iter().rev()
    }

    /// The key of the cell `steps` in front of the measured one (negative: behind it); `steps` is at least
    /// `-behind()`.
    #[inline]
    pub fn key(&self, steps: i32) -> i32 {
        self.keys.get(steps.saturating_add(self.behind) as usize).copied().unwrap_or(self.free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elfes::occupancy;

    #[test]
    fn the_profile_is_the_closed_form_on_a_long_ray() {
        for deviation in [0.3_f64, 1.0, 5_f64.sqrt(), 4.0] {
            let profile = GaussianProfile::new(deviation);
            let r = 200;
            let g: Vec<f64> = (1..=300)
                .map(|j| (-f64::from(j - r).powi(2) / (2.0 * deviation * deviation)).exp())
                .collect();
            for (j, p) in (1..=300).zip(occupancy(&g)) {
                let found = profile.at(i64::from(r - j));
                assert!((found - p).abs() < 1e-9, "deviation {deviation}, cell {j}: {found}, expected {p}");
            }
        }
    }

    #[test]
    fn the_table_stays_within_its_stated_error() {
        let bounds = Clamp { min: -5.0, max: 5.0 };
        let table = ProfileTable::new(bounds);
        let probability_of = |key: i32| {
            let bits = key ^ (((key >> 31) as u32) >> 1) as i32;
            evigrid_grid::probability(f64::from(f32::from_bits(bits as u32)))
        };
        let mut worst = 0.0_f64;
        for k in 0..3999 {
            let deviation = 0.002 + 0.004 * f64::from(k);
            let (exact, row) = (GaussianProfile::new(deviation), table.profile(deviation as f32));
            for steps in -row.behind()..row.in_front() + 3 {
                let p = exact.at(i64::from(steps));
                let bounded = p.clamp(evigrid_grid::probability(-5.0), evigrid_grid::probability(5.0));
                worst = worst.max((probability_of(row.key(steps)) - bounded).abs());
            }
            // The cells behind that are not drawn are within 0.01 log-odds of the prior, give or take the
            // rounded deviation.
            assert!(logit(exact.at(-i64::from(row.behind()) - 1)) < 0.0125);
        }
        assert!(worst < 0.006, "{worst}");
        assert!(GaussianProfile::new(16.0).at(0) < 0.52);
    }
}
