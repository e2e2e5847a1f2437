//! The evidence of one look: pixels whose matching windows share most of the image, along the ray in their middle.

use evigrid_core::{CostVolume, NO_COST};
use evigrid_grid::{Clamp, bounded_logit};

use crate::fast_math::exp_negative;
use crate::ray_sections::RaySections;

/// Pixels that are computed side by side.
const LANES: usize = 32;
/// Log-odds of what no rounding can tell from 0 or 1.
const WIDE: Clamp = Clamp { min: -40.0, max: 40.0 };

/// What all looks of a frame have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LookModel {
    /// 1 / b, per unit of the volume.
    pub sharpness: f32,
    /// Share of pixels whose costs say nothing.
    pub outliers: f32,
    /// Prior probability that a cell stops a ray that reaches it.
    pub stops: f32,
    /// The first hypothesis, counted from the nearest, that reaches beyond the greatest depth; their number if none does.
    pub first_beyond: usize,
}

/// The pixels of a look, and what is worked out for them; kept from look to look.
#[derive(Debug, Default)]
pub(crate) struct Look {
    pub sections: RaySections,
    /// The pixels that count, x and y.
    pub pixels: Vec<[usize; 2]>,
    /// Costs, then p(E | d) but for a scale, `[hypothesis][pixel]`, hypotheses from the nearest to the farthest.
    likelihoods: Vec<[f32; LANES]>,
    /// w_i, `[cell][pixel]`.
    weights: Vec<[f32; LANES]>,
    /// Per cell the sum over the pixels of ln odds(P_i) - ln odds(prior), in as many parts as places.
    lane_sums: Vec<[f32; LANES]>,
    /// The same, added up.
    pub sums: Vec<f32>,
}

/// How p(E | d) follows from what is in place: scale times it, plus the floor.
struct Told {
    scale: [f32; LANES],
    floor: f32,
}

impl Look {
    /// Sets [`Self::sums`] from the pixels and the cells of their ray.
    #[inline(always)]
    pub fn fill_sums(&mut self, model: &LookModel, volume: &CostVolume) {
        self.lane_sums.clear();
        self.lane_sums.resize(self.sections.cells.len(), [0.0; LANES]);
        for first in (0..self.pixels.len()).step_by(LANES) {
            let count = LANES.min(self.pixels.len() - first);
            let told = self.fill_likelihoods(model, volume, first, count);
            let all = self.fill_weights(model, &told);
            self.add_log_odds(model, all, count);
        }
        self.sums.clear();
        self.sums.extend(self.lane_sums.iter().map(|lanes| lanes.iter().sum::<f32>()));
    }

    /// p(E | d) of every hypothesis: (1 - outliers) m/n exp(-E/b) / sum + outliers / n for the m that have a cost, 1/n for the
    /// others, of which the costs say nothing. Left in place are exponentials, which are still to be scaled.
    #[inline(always)]
    fn fill_likelihoods(
        &mut self,
        model: &LookModel,
        volume: &CostVolume,
        first: usize,
        count: usize,
    ) -> Told {
        let least = self.fill_costs(volume, first, count);
        let nothing = 1.0 / self.likelihoods.len() as f32;
        let (mut sum, mut measured) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for row in &mut self.likelihoods {
            for l in 0..LANES {
                // Missing costs are infinite: their exponential is 0.
                measured[l] += if row[l] < f32::INFINITY { nothing } else { 0.0 };
                row[l] = exp_negative((row[l] - least[l]) * model.sharpness);
                sum[l] += row[l];
            }
        }
        let mut told = Told { scale: [0.0; LANES], floor: model.outliers * nothing };
        for l in 0..LANES {
            let scale = (1.0 - model.outliers) * measured[l] / sum[l];
            told.scale[l] = if sum[l] > 0.0 { scale } else { 0.0 };
        }
        if measured.iter().any(|share| *share < 1.0 - 0.5 * nothing) {
            return self.fill_missing(volume, [first, count], told);
        }
        told
    }

    /// The same where some have no cost: scales what is in place, and sets 1/n where a cost is missing.
    #[inline(never)]
    fn fill_missing(&mut self, volume: &CostVolume, [first, count]: [usize; 2], told: Told) -> Told {
        let (n, width) = (self.likelihoods.len(), volume.width());
        for (d, row) in self.likelihoods.iter_mut().rev().enumerate() {
            for (l, p) in row.iter_mut().enumerate() {
                let [x, y] = self.pixels[first + if l < count { l } else { 0 }];
                let missing = volume.row(y)[d * width + x] == NO_COST;
                *p = if missing { 1.0 / n as f32 } else { *p * told.scale[l] + told.floor };
            }
        }
        Told { scale: [1.0; LANES], floor: 0.0 }
    }

    /// The costs of some of the pixels, each of which has one at least; returns the smallest of each.
    #[inline(always)]
    fn fill_costs(&mut self, volume: &CostVolume, first: usize, count: usize) -> [f32; LANES] {
        let (n, width) = (volume.disparities(), volume.width());
        self.likelihoods.clear();
        self.likelihoods.resize(n, [0.0; LANES]);
        // Places without a pixel repeat the first.
        let at = |l: usize| self.pixels[first + if l < count { l } else { 0 }];
        let curves: [&[u16]; LANES] = std::array::from_fn(|l| &volume.row(at(l)[1])[at(l)[0]..]);
        let mut least = [NO_COST; LANES];
        for (d, costs) in self.likelihoods.iter_mut().rev().enumerate() {
            let mut row = [NO_COST; LANES];
            for l in 0..LANES {
                row[l] = curves[l][d * width];
            }
            for l in 0..LANES {
                costs[l] = if row[l] == NO_COST { f32::INFINITY } else { f32::from(row[l]) };
                least[l] = if row[l] < least[l] { row[l] } else { least[l] };
            }
        }
        least.map(f32::from)
    }

    /// w_i = stops (1 - stops)^(i-1) g_i of every cell, where g_i is the mean of p(E | d) over its length, 1/n where no
    /// hypothesis is; returns their sum and what is left for obstacles beyond all cells.
    #[inline(always)]
    fn fill_weights(&mut self, model: &LookModel, told: &Told) -> [f32; LANES] {
        self.weights.clear();
        let mut prior = model.stops;
        let mut all = [0.0_f32; LANES];
        for cell in 0..self.sections.cells.len() {
            let parts = self.sections.parts_of(cell);
            let measured: f32 = parts.iter().map(|part| part.share).sum();
            let unmeasured = if measured < 1.0 { 1.0 - measured } else { 0.0 };
            let known = (measured * told.floor + unmeasured / self.likelihoods.len() as f32) * prior;
            let mut mean = [0.0_f32; LANES];
            for part in parts {
                let g = &self.likelihoods[part.hypothesis as usize];
                for l in 0..LANES {
                    mean[l] += part.share * g[l];
                }
            }
            let mut weight = [0.0_f32; LANES];
            for l in 0..LANES {
                weight[l] = mean[l] * told.scale[l] * prior + known;
                all[l] += weight[l];
            }
            self.weights.push(weight);
            prior *= 1.0 - model.stops;
        }
        self.add_beyond(model, told, prior / model.stops, all)
    }

    /// Obstacles beyond all cells: the hypotheses that reach there are equally likely; 1/n where none does.
    #[inline(always)]
    fn add_beyond(&self, model: &LookModel, told: &Told, prior: f32, mut all: [f32; LANES]) -> [f32; LANES] {
        let beyond = &self.likelihoods[model.first_beyond.min(self.likelihoods.len())..];
        let per_one = prior / beyond.len().max(1) as f32;
        let known = if beyond.is_empty() { 1.0 / self.likelihoods.len() as f32 } else { told.floor };
        let mut sum = [0.0_f32; LANES];
        for row in beyond {
            for l in 0..LANES {
                sum[l] += row[l];
            }
        }
        for l in 0..LANES {
            all[l] += sum[l] * told.scale[l] * per_one + known * prior;
        }
        all
    }

    /// ln odds(P_i) - ln odds(prior), P_i = (w_i + stops sum_{j<i} w_j) / all.
    #[inline(always)]
    fn add_log_odds(&mut self, model: &LookModel, all: [f32; LANES], count: usize) {
        let prior = bounded_logit(model.stops, WIDE);
        let mut per_all = [0.0_f32; LANES];
        for l in 0..LANES {
            per_all[l] = 1.0 / all[l];
        }
        let mut before = [0.0_f32; LANES];
        let mut counts = [0.0_f32; LANES];
        counts[..count].fill(1.0);
        for (weights, sums) in self.weights.iter().zip(&mut self.lane_sums) {
            for l in 0..LANES {
                let p = (weights[l] + model.stops * before[l]) * per_all[l];
                sums[l] += (bounded_logit(if p < 1.0 { p } else { 1.0 }, WIDE) - prior) * counts[l];
                before[l] += weights[l];
            }
        }
    }
}
