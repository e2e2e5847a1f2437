//! The Bayesian occupancy filter: occupancy and a distribution of velocities for every cell, predicted by moving cells
//! with their velocities and corrected by an observed grid (Coue, Pradalier, Laugier, Fraichard and Bessiere 2006; Tay,
//! Mekhnacha, Chen, Yguel and Laugier 2008). Perrollaz et al. 2012 name it and leave it at that.
//!
//! Each cell holds P(occupied, v) for a square of velocities. Prediction takes P(occupied, v) from where a cell would
//! have been. The two forms differ in what follows:
//! - *mass-conserving*: what is taken somewhere arrives somewhere. A block keeps its mass, whatever stands around it.
//! - *normalised*, as Tay et al. have it: P(free, v) moves in the same way, and every cell is divided by the sum of
//!   all that arrives. Cells with velocities of their own compete with those that have none, so that a moving block
//!   that nobody observes fades.

use evigrid_core::{SettingError, require_setting};
use evigrid_grid::{CellVelocity, MapError};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How grids are filtered over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FilterForm {
    /// Not at all.
    None,
    /// Occupied cells keep their mass.
    MassConserving,
    /// Cells are divided by all that arrives in them.
    Normalised,
}

/// Numbers of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterSettings {
    /// Which form.
    pub form: FilterForm,
    /// Velocities per axis, an odd number: as many on both sides of 0.
    pub velocities: usize,
    /// Difference between neighbouring velocities, m/s.
    pub step_mps: f64,
    /// Of what is not yet known to move: the share that stands.
    pub static_share: f64,
    /// Share that changes its velocity to one of the four next ones in a second.
    pub change_per_s: f64,
    /// Power of the evidence of one frame: neighbouring frames err alike.
    pub weight: f64,
    /// Least and largest P(occupied), so that a cell can change its mind.
    pub bounds: [f64; 2],
}

/// A cell of which nothing is known is as likely to be occupied as free.
const PRIOR: f32 = 0.5;
/// Neighbouring velocities must part by so much of a cell within a frame; with less they cannot be told apart before
/// they have blurred.
const LEAST_STEP_CELLS: f64 = 0.02;
/// Cells per task.
const CELLS_PER_TASK: usize = 512;

impl FilterSettings {
    /// `Ok` if the numbers are possible.
    ///
    /// # Errors
    /// If one is outside its domain; named as a setting of `section`.
    pub fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let n = self.velocities;
        let odd = n % 2 == 1 && n <= 41;
        require_setting(odd, section, "velocities", "an odd number from 1 to 41", n)?;
        let positive = self.step_mps.is_finite() && self.step_mps > 0.0;
        require_setting(positive, section, "velocity_step_mps", "a positive number", self.step_mps)?;
        let share = |v: f64| (0.0..=1.0).contains(&v);
        let is = share(self.static_share);
        require_setting(is, section, "static_share", "a number from 0 to 1", self.static_share)?;
        let is = self.change_per_s.is_finite() && self.change_per_s >= 0.0;
        require_setting(is, section, "velocity_change_per_s", "a finite number from 0", self.change_per_s)?;
        let is = self.weight > 0.0 && self.weight <= 1.0;
        require_setting(is, section, "observation_weight", "a number above 0 and up to 1", self.weight)?;
        let [low, high] = self.bounds;
        let is = low > 0.0 && low < 0.5 && high > 0.5 && high < 1.0;
        require_setting(is, section, "filter_bounds", "[in 0..0.5, in 0.5..1]", format!("[{low}, {high}]"))
    }
}

/// The state of the filter over a window of cells.
#[derive(Debug, Clone)]
pub struct Filter {
    settings: FilterSettings,
    shape: [usize; 2],
    cell_m: f64,
    /// Velocities along x and y, m/s, the slowest first.
    velocities: Vec<[f64; 2]>,
    /// P(v) of a cell of which nothing is known.
    prior: Vec<f32>,
    /// Numbers of the four next velocities.
    next: Vec<Vec<usize>>,
    /// P(occupied, v): a plane of cells per velocity.
    occupied: Planes,
    /// P(free, v), in the normalised form.
    free: Planes,
    probability: Vec<f32>,
    last_ns: Option<i64>,
}

#[derive(Debug, Clone, Default)]
struct Planes {
    now: Vec<Vec<f32>>,
    predicted: Vec<Vec<f32>>,
}

impl Filter {
    /// A filter over so many cells of this edge, nothing known.
    pub fn new(settings: FilterSettings, shape: [usize; 2], cell_m: f64) -> Self {
        let velocities = velocities(&settings);
        let prior = prior(&settings, velocities.len());
        let cells = shape[0] * shape[1];
        let planes = |share: f32| {
            let now: Vec<Vec<f32>> = prior.iter().map(|p| vec![share * p; cells]).collect();
            Planes { predicted: now.clone(), now }
        };
        let is_normalised = settings.form == FilterForm::Normalised;
        let free = if is_normalised { planes(1.0 - PRIOR) } else { Planes::default() };
        Self {
            next: next(&velocities, settings.step_mps),
            occupied: planes(PRIOR),
            free,
            probability: vec![PRIOR; cells],
            velocities,
            prior,
            settings,
            shape,
            cell_m,
            last_ns: None,
        }
    }

    /// Puts a cell into a state: P(occupied) and the velocity it has then, the one nearest to `mps`; P(v) of a free
    /// cell stays that of one of which nothing is known.
    pub fn set(&mut self, cell: usize, probability: f64, mps: Option<[f64; 2]>) {
        let distance = |v: &[f64; 2], mps: [f64; 2]| (v[0] - mps[0]).hypot(v[1] - mps[1]);
        let nearest = mps.and_then(|mps| {
            let order = |a: &usize, b: &usize| {
                distance(&self.velocities[*a], mps).total_cmp(&distance(&self.velocities[*b], mps))
            };
            (0..self.velocities.len()).min_by(order)
        });
        let share = |v: usize| nearest.map_or(self.prior[v], |nearest| f32::from(u8::from(nearest == v)));
        let shares: Vec<f32> = (0..self.velocities.len()).map(share).collect();
        let probability = probability as f32;
        for (plane, share) in self.occupied.now.iter_mut().zip(&shares) {
            plane[cell] = probability * share;
        }
        for (plane, share) in self.free.now.iter_mut().zip(&shares) {
            plane[cell] = (1.0 - probability) * share;
        }
        self.probability[cell] = probability;
    }

    /// One step: prediction to the time of a frame, then correction by what it observes, P(occupied) cell by cell (NaN
    /// and 0.5: nothing). The window went on by `by` cells since the frame before.
    ///
    /// # Errors
    /// If the frame is not later than the one before, or velocities cannot be told apart at this rate, or the fastest
    /// crosses half the window between two frames. The state is then as it was.
    pub fn step(&mut self, stamp_ns: i64, by: [i64; 2], observed: &[f32]) -> Result<(), MapError> {
        if let Some(last_ns) = self.last_ns {
            let seconds = self.seconds(last_ns, stamp_ns)?;
            self.predict(seconds, by);
            self.sum_up();
            if self.settings.form == FilterForm::Normalised {
                self.normalise();
            }
            self.correct(observed, self.changing(seconds));
        } else {
            self.occupied.predicted.clone_from(&self.occupied.now);
            self.free.predicted.clone_from(&self.free.now);
            self.correct(observed, 0.0);
        }
        self.last_ns = Some(stamp_ns);
        Ok(())
    }

    /// The time between two frames, if the filter can deal with it.
    fn seconds(&self, last_ns: i64, stamp_ns: i64) -> Result<f64, MapError> {
        let seconds = (i128::from(stamp_ns) - i128::from(last_ns)) as f64 * 1e-9;
        let refuse = |what, expected, found: String| Err(MapError::View { what, expected, found });
        if seconds <= 0.0 {
            let found = format!("{stamp_ns} ns after {last_ns} ns");
            return refuse("time stamp of a filtered frame", "one after that of the frame before", found);
        }
        let step = self.settings.step_mps * seconds / self.cell_m;
        if self.velocities.len() > 1 && step < LEAST_STEP_CELLS {
            let found = format!("{step:.4} cells in {seconds:.4} s");
            return refuse("velocity_step_mps", "at least 0.02 cells from frame to frame", found);
        }
        let fastest = step * (self.settings.velocities / 2) as f64;
        if fastest > 0.5 * self.shape[0].min(self.shape[1]) as f64 {
            let found = format!("{fastest:.1} cells in {seconds:.4} s");
            return refuse("fastest velocity", "at most half the grid from frame to frame", found);
        }
        Ok(seconds)
    }

    fn changing(&self, seconds: f64) -> f32 {
        (1.0 - (-self.settings.change_per_s * seconds).exp()) as f32
    }

    /// What every cell holds comes from where it would have been at each velocity; a place between cells is shared by
    /// the four around it.
    fn predict(&mut self, seconds: f64, by: [i64; 2]) {
        let cells_of = |v: &[f64; 2]| [0, 1].map(|a| v[a] * seconds / self.cell_m - by[a] as f64);
        let (shape, velocities, prior) = (self.shape, &self.velocities, &self.prior);
        for (planes, share) in [(&mut self.occupied, PRIOR), (&mut self.free, 1.0 - PRIOR)] {
            let all = planes.predicted.par_iter_mut().zip(&planes.now).zip(velocities).zip(prior);
            all.for_each(|(((to, from), v), prior)| moved(from, to, shape, cells_of(v), share * prior));
        }
    }

    /// P(occupied) of every cell after the prediction.
    fn sum_up(&mut self) {
        let planes = &self.occupied.predicted;
        let tasks = self.probability.par_chunks_mut(CELLS_PER_TASK).enumerate();
        tasks.for_each(|(task, sums)| {
            sums.fill(0.0);
            add_planes(planes, task * CELLS_PER_TASK, sums);
        });
    }

    /// Divides every cell by all that has arrived in it.
    fn normalise(&mut self) {
        let free = &self.free.predicted;
        let mut scale = vec![0.0; self.probability.len()];
        let tasks = scale.par_chunks_mut(CELLS_PER_TASK).zip(self.probability.par_chunks_mut(CELLS_PER_TASK));
        tasks.enumerate().for_each(|(task, (scale, probability))| {
            add_planes(free, task * CELLS_PER_TASK, scale);
            for (scale, probability) in scale.iter_mut().zip(probability) {
                *scale = 1.0 / (*scale + *probability).max(1e-12);
                *probability *= *scale;
            }
        });
        let planes = self.occupied.predicted.par_iter_mut().chain(&mut self.free.predicted);
        planes.for_each(|plane| plane.iter_mut().zip(&scale).for_each(|(cell, scale)| *cell *= scale));
    }

    /// Bayes' rule with the observation as evidence, to the power of its weight; velocities change by the way.
    fn correct(&mut self, observed: &[f32], changing: f32) {
        let settings = self.settings;
        let [low, high] = settings.bounds.map(|bound| bound as f32);
        // What P(occupied, v) is multiplied by, what is added to it by P(v) of the prior, and the same of free.
        let mut changes = vec![[0.0_f32; 3]; self.probability.len()];
        let tasks = changes.par_iter_mut().zip(self.probability.par_iter_mut()).zip(observed);
        tasks.with_min_len(CELLS_PER_TASK).for_each(|((change, probability), &observed)| {
            let before = *probability;
            let evidence = evidence(observed, settings.weight);
            if evidence == 1.0 {
                // What nobody observes keeps what it has.
                *change = [1.0, 0.0, 1.0];
                return;
            }
            let born = (low - before).max(0.0);
            let prior = (before + born).min(high);
            let after = (prior * evidence / (prior * evidence + 1.0 - prior)).clamp(low, high);
            let kept = after / (before + born);
            let of_free = if before < 1.0 { (1.0 - after) / (1.0 - before) } else { 0.0 };
            *change = [kept, kept * born, of_free];
            *probability = after;
        });
        let (next, prior) = (&self.next, &self.prior);
        for (planes, is_occupied) in [(&mut self.occupied, true), (&mut self.free, false)] {
            let predicted = &planes.predicted;
            planes.now.par_iter_mut().enumerate().for_each(|(v, to)| {
                let others: Vec<&Vec<f32>> = next[v].iter().map(|&other| &predicted[other]).collect();
                let mixed = Mix { own: &predicted[v], others: &others, changing };
                for (cell, (to, change)) in to.iter_mut().zip(&changes).enumerate() {
                    let [kept, born, of_free] = *change;
                    let mass = mixed.at(cell);
                    *to = if is_occupied { mass * kept + born * prior[v] } else { mass * of_free };
                }
            });
        }
    }

    /// P(occupied) of every cell.
    pub fn probabilities(&self) -> &[f32] {
        &self.probability
    }

    /// The most probable velocity of every cell if it is occupied, and how far the others spread around the mean; of
    /// equally probable ones the slowest.
    pub fn velocities(&self) -> Vec<CellVelocity> {
        let mut all = vec![CellVelocity::default(); self.probability.len()];
        all.par_iter_mut().enumerate().with_min_len(CELLS_PER_TASK).for_each(|(cell, to)| {
            let masses =
                self.velocities.iter().zip(&self.occupied.now).map(|(v, plane)| (v, f64::from(plane[cell])));
            let (mut sum, mut mean, mut square, mut best) = (0.0, [0.0; 2], 0.0, (0.0, [0.0; 2]));
            for (v, mass) in masses {
                sum += mass;
                mean = [mean[0] + mass * v[0], mean[1] + mass * v[1]];
                square += mass * (v[0] * v[0] + v[1] * v[1]);
                if mass > best.0 {
                    best = (mass, *v);
                }
            }
            let mean = mean.map(|m| m / sum);
            let variance = square / sum - mean[0] * mean[0] - mean[1] * mean[1];
            *to = CellVelocity {
                mode_mps: best.1.map(|v| v as f32),
                spread_mps: variance.max(0.0).sqrt() as f32,
            };
        });
        all
    }
}

/// A plane of masses with a share of them taken from the next velocities. What would go beyond the fastest velocity
/// stays.
struct Mix<'a> {
    own: &'a [f32],
    others: &'a [&'a Vec<f32>],
    changing: f32,
}

impl Mix<'_> {
    #[inline(always)]
    fn at(&self, cell: usize) -> f32 {
        let quarter = 0.25 * self.changing;
        let stays = 1.0 - quarter * self.others.len() as f32;
        self.others.iter().fold(stays * self.own[cell], |sum, other| sum + quarter * other[cell])
    }
}

/// P(z | occupied) over P(z | free) to the power of the weight.
#[inline(always)]
fn evidence(observed: f32, weight: f64) -> f32 {
    if observed.is_nan() || observed == 0.5 {
        return 1.0;
    }
    let observed = observed.clamp(1e-3, 1.0 - 1e-3);
    (observed / (1.0 - observed)).powf(weight as f32)
}

/// Adds the cells from `first` on of all planes.
#[inline(always)]
fn add_planes(planes: &[Vec<f32>], first: usize, sums: &mut [f32]) {
    for plane in planes {
        let cells = &plane[first..first + sums.len()];
        sums.iter_mut().zip(cells).for_each(|(sum, cell)| *sum += cell);
    }
}

/// All velocities, the slowest first.
fn velocities(settings: &FilterSettings) -> Vec<[f64; 2]> {
    let half = (settings.velocities / 2) as i64;
    let mut steps: Vec<[i64; 2]> = (-half..=half).flat_map(|x| (-half..=half).map(move |y| [x, y])).collect();
    steps.sort_by_key(|[x, y]| (x * x + y * y, *x, *y));
    steps.into_iter().map(|v| v.map(|n| n as f64 * settings.step_mps)).collect()
}

/// P(v) of a cell of which nothing is known: the static share stands, the rest has any velocity.
fn prior(settings: &FilterSettings, count: usize) -> Vec<f32> {
    let moving = (1.0 - settings.static_share) / count as f64;
    (0..count).map(|v| (moving + if v == 0 { settings.static_share } else { 0.0 }) as f32).collect()
}

/// For each velocity the numbers of the ones a step to each side.
fn next(velocities: &[[f64; 2]], step_mps: f64) -> Vec<Vec<usize>> {
    let number = |v: [f64; 2]| {
        velocities.iter().position(|other| (0..2).all(|a| (other[a] - v[a]).abs() < 0.5 * step_mps))
    };
    let sides = [[step_mps, 0.0], [-step_mps, 0.0], [0.0, step_mps], [0.0, -step_mps]];
    let next = |v: &[f64; 2]| sides.iter().filter_map(|s| number([v[0] + s[0], v[1] + s[1]])).collect();
    velocities.iter().map(next).collect()
}

/// A plane moved by a number of cells along x and y, with parts of cells shared among neighbours; `outside` comes in
/// from beyond the window.
fn moved(from: &[f32], to: &mut [f32], [nx, ny]: [usize; 2], by: [f64; 2], outside: f32) {
    let whole = by.map(|v| v.floor());
    let part = [0, 1].map(|a| (by[a] - whole[a]) as f32);
    let [dx, dy] = whole.map(|v| v as i64);
    let row = |i: i64| {
        let is_inside = (0..nx as i64).contains(&i);
        is_inside.then(|| &from[i as usize * ny..(i as usize + 1) * ny])
    };
    let mut blended = vec![0.0; ny];
    for (i, out) in to.chunks_exact_mut(ny).enumerate() {
        let (near, far) = (row(i as i64 - dx), row(i as i64 - dx - 1));
        blend(near, far, part[0], outside, &mut blended);
        let at = |j: i64| if (0..ny as i64).contains(&j) { blended[j as usize] } else { outside };
        // Cells whose two sources lie inside.
        let inner = (dy + 1).clamp(0, ny as i64) as usize..(ny as i64 + dy).clamp(0, ny as i64) as usize;
        let inner = inner.start..inner.end.max(inner.start);
        for j in (0..inner.start).chain(inner.end..ny) {
            let from = j as i64 - dy;
            out[j] = (1.0 - part[1]) * at(from) + part[1] * at(from - 1);
        }
        if !inner.is_empty() {
            let first = (inner.start as i64 - dy) as usize;
            let (near, far) = (&blended[first..][..inner.len()], &blended[first - 1..][..inner.len()]);
            for ((out, near), far) in out[inner].iter_mut().zip(near).zip(far) {
                *out = (1.0 - part[1]) * near + part[1] * far;
            }
        }
    }
}

/// Two rows in the given shares; rows outside hold one value.
#[inline(always)]
fn blend(near: Option<&[f32]>, far: Option<&[f32]>, part: f32, outside: f32, out: &mut [f32]) {
    match (near, far) {
        (Some(near), Some(far)) => {
            let rows = out.iter_mut().zip(near).zip(far);
            rows.for_each(|((out, near), far)| *out = (1.0 - part) * near + part * far);
        }
        (Some(row), None) => {
            out.iter_mut().zip(row).for_each(|(out, near)| *out = (1.0 - part) * near + part * outside);
        }
        (None, Some(row)) => {
            out.iter_mut().zip(row).for_each(|(out, far)| *out = (1.0 - part) * outside + part * far);
        }
        (None, None) => out.fill(outside),
    }
}

#[cfg(test)]
#[path = "filter_tests.rs"]
mod tests;
