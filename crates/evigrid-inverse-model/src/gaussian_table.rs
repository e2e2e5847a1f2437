//! Andert's eqs 9 to 11 by table, in units of cells.

use crate::model::{Obstacle, SensorModel};

/// The largest error of P by [`GaussianTable`] against Andert's eqs 9 to 11, whatever k, p_min and the
/// deviation; asserted in the tests. In log-odds that is this over P (1 - P): at most 0.004 between P = 0.25
/// and 0.75.
pub const TABLE_ERROR: f64 = 6e-4;

/// Deviations from the measured range at which the Gaussian is taken as 0.
pub(crate) const LAST_DEVIATION: f32 = 4.0;
const STEPS_PER_DEVIATION: f32 = 512.0;
const LAST_STEP: f32 = LAST_DEVIATION * STEPS_PER_DEVIATION;
const ENTRIES: usize = 4096;

/// Table of exp(-t^2 / 2) for t from 0 to 4 in steps of 1/512, and 0 from there on: all that takes time in
/// eq. 9 of Andert 2009, where P is linear in it. 8 KiB are in use, which stay in the nearest cache.
#[derive(Debug, Clone)]
pub struct GaussianTable {
    values: Box<[f32; ENTRIES]>,
}

/// One measurement along its ray, in units of cells.
#[derive(Debug, Clone, Copy)]
pub struct Profile {
    /// Range l_p.
    pub range: f32,
    /// Deviation dl_p of the range.
    pub deviation: f32,
    /// P at the range, 0.5 + A.
    pub peak: f32,
    /// P in front.
    pub min_probability: f32,
    /// Steps of the table per cell.
    scale: f32,
}

impl Profile {
    /// A measurement: range and deviation in cells, P at its peak and in front.
    #[inline(always)]
    pub(crate) fn new(range: f32, deviation: f32, peak: f32, min_probability: f32) -> Self {
        // However near the pixel, 0 cells off are 0 deviations off.
        let scale = (STEPS_PER_DEVIATION / deviation).min(1e30);
        Self { range, deviation, peak, min_probability, scale }
    }

    /// The profile of a measurement in a grid with cells of this size.
    pub fn of(obstacle: &Obstacle, cell_size_m: f64) -> Self {
        let cells = |metres: f64| (metres / cell_size_m) as f32;
        let (peak, front) = (0.5 + obstacle.peak, obstacle.min_probability);
        Self::new(cells(obstacle.range_m), cells(obstacle.deviation_m), peak as f32, front as f32)
    }

    /// Range in cells in front of which P is the least there is.
    #[inline(always)]
    pub(crate) fn start(&self) -> f32 {
        self.range - 0.5 - LAST_DEVIATION * self.deviation
    }
}

impl Default for GaussianTable {
    fn default() -> Self {
        let mut values = Box::new([0.0; ENTRIES]);
        for (step, value) in values.iter_mut().enumerate().take(LAST_STEP as usize) {
            let t = step as f64 / f64::from(STEPS_PER_DEVIATION);
            *value = (-0.5 * t * t).exp() as f32;
        }
        Self { values }
    }
}

impl GaussianTable {
    /// The largest P within half a cell of a range in cells (Andert 2009, eqs 9 to 11).
    #[inline(always)]
    pub fn max_probability(&self, profile: &Profile, range: f32) -> f32 {
        let off = range - profile.range;
        let steps = (off.abs() - 0.5) * profile.scale + 0.5;
        let steps = if steps > 0.0 { steps } else { 0.0 };
        let steps = if steps < LAST_STEP { steps } else { LAST_STEP };
        let gaussian = self.values[steps as i32 as usize & (ENTRIES - 1)];
        let before = if off <= 0.0 { profile.min_probability } else { 0.5 };
        before + (profile.peak - before) * gaussian
    }
}

/// The constants of a frame's [`SensorModel`] as drawing needs them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FastModel {
    /// Deviation dz of a depth per square metre of depth, dd / (b f).
    per_square_depth: f64,
    motion_error_m: f64,
    /// A times the deviation in cells, k / (sqrt(2 pi) c).
    peak_per_deviation: f64,
    max_peak: f64,
    min_probability: f32,
}

impl FastModel {
    /// The constants for a rig (b f in metres times pixels) and a cell size in metres.
    pub fn new(model: &SensorModel, base_times_focal: f64, cell_size_m: f64) -> Self {
        Self {
            per_square_depth: model.disparity_error_px / base_times_focal,
            motion_error_m: model.motion_error_m,
            peak_per_deviation: model.k / (std::f64::consts::TAU.sqrt() * cell_size_m),
            max_peak: model.max_peak,
            min_probability: model.min_probability as f32,
        }
    }

    /// The profile of a depth in metres on a ray of `cells_per_metre` of depth (eqs 4, 6, 7 and 9).
    #[inline(always)]
    pub fn profile(&self, depth_m: f64, cells_per_metre: f64) -> Profile {
        let deviation = (depth_m * depth_m * self.per_square_depth + self.motion_error_m) * cells_per_metre;
        let peak = self.peak_per_deviation / deviation;
        let peak = if peak < self.max_peak { peak } else { self.max_peak };
        let range = depth_m * cells_per_metre;
        Profile::new(range as f32, deviation as f32, (0.5 + peak) as f32, self.min_probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Measurement;
    use evigrid_grid::probability;

    #[test]
    fn the_table_keeps_its_stated_error() {
        let table = GaussianTable::default();
        let mut worst = 0.0_f64;
        for (peak, min_probability) in [(0.4999, 0.001), (0.4, 0.35), (0.1, 0.35), (0.01, 0.499)] {
            for deviation_m in [1e-6, 0.013, 0.2, 1.7, 30.0] {
                let obstacle = Obstacle { range_m: 14.3, deviation_m, peak, min_probability };
                let profile = Profile::of(&obstacle, 0.25);
                for n in 0..20_000 {
                    let l = 0.0021 * f64::from(n);
                    let exact = probability(Measurement::Obstacle(obstacle).max_log_odds(l, 0.25));
                    // Single precision moves the range by a part in 10^7: much beside a deviation of 1 um.
                    if (deviation_m > 1e-3) | ((l - 14.3).abs() > 0.126) | ((l - 14.3).abs() < 0.124) {
                        let found = f64::from(table.max_probability(&profile, (l / 0.25) as f32));
                        worst = worst.max((found - exact).abs());
                    }
                }
            }
        }
        assert!(worst < TABLE_ERROR, "{worst}");
    }
}
