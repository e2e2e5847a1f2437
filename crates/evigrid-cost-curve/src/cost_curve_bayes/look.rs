//! The evidence of one look: pixels whose matching windows share most of the image, along the ray in their
//! middle.

use evigrid_core::{CostVolume, NO_COST};
use evigrid_grid::{Clamp, bounded_logit};

use super::ray_sections::RaySections;
use crate::fast_math::exp_negative;
use crate::pixels::Pixel;

/// Pixels that are computed side by side.
const LANES: usize = 32;
/// Log-odds of probabilities that no rounding can tell from 0 or 1.
const WIDE: Clamp = Clamp { min: -40.0, max: 40.0 };

/// The constants that turn the costs of one frame into probabilities.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LookModel {
    /// Sharpness 1 / b of the likelihood, per unit of the volume.
    pub sharpness: f32,
    /// Share of pixels whose costs say nothing.
    pub outliers: f32,
    /// Prior probability that a cell stops a ray that reaches it.
    pub stops: f32,
    /// The first hypothesis, counted from the nearest, that reaches beyond the greatest depth; their number
    /// if none does.
    pub first_beyond: usize,
}

/// The pixels of a look and the evidence that is worked out from them; the buffers are kept from look to
/// look.
#[derive(Debug, Default)]
pub(crate) struct Look {
    /// The cells of the ray in the middle of the look.
    pub sections: RaySections,
    /// The pixels that count.
    pub pixels: Vec<Pixel>,
    /// Costs, then p(E | d) but for a scale, `[hypothesis][pixel]`, hypotheses from the nearest to the
    /// farthest.
    likelihoods: Vec<[f32; LANES]>,
    /// Weights w_i, `[cell][pixel]`.
    weights: Vec<[f32; LANES]>,
    /// Per cell the sum over the pixels of ln odds(P_i) - ln odds(prior), one part of it per lane.
    lane_sums: Vec<[f32; LANES]>,
    /// Per cell the sum over the pixels of ln odds(P_i) - ln odds(prior).
    pub sums: Vec<f32>,
}

/// How p(E | d) follows from the likelihoods that are stored: scale times the stored number, plus the floor.
struct ScaledLikelihoods {
    /// The scale of each pixel.
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
            let scaled = self.fill_likelihoods(model, volume, first, count);
            let all = self.fill_weights(model, &scaled);
            self.add_log_odds(model, all, count);
        }
        self.sums.clear();
        self.sums.extend(self.lane_sums.iter().map(|lanes| lanes.iter().sum::<f32>()));
    }

    /// Sets p(E | d) of every hypothesis: (1 - outliers) m/n exp(-E/b) / sum + outliers / n for the m that
    /// have a cost, 1/n for the others, of which the costs say nothing. Exponentials are stored, which are
    /// still to be scaled.
    #[inline(always)]
    fn fill_likelihoods(
        &mut self,
        model: &LookModel,
        volume: &CostVolume,
        first: usize,
        count: usize,
    ) -> ScaledLikelihoods {
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
        let mut scaled = ScaledLikelihoods { scale: [0.0; LANES], floor: model.outliers * nothing };
        for l in 0..LANES {
            let scale = (1.0 - model.outliers) * measured[l] / sum[l];
            scaled.scale[l] = if sum[l] > 0.0 { scale } else { 0.0 };
        }
        if measured.iter().any(|share| *share < 1.0 - 0.5 * nothing) {
            return self.fill_missing(volume, first, count, &scaled);
        }
        scaled
    }

    /// Sets p(E | d) of pixels of which some costs are missing: scales the exponentials that are stored, and
    /// sets 1/n where a cost is missing.
    #[inline(never)]
    fn fill_missing(
        &mut self,
        volume: &CostVolume,
        first: usize,
        count: usize,
        scaled: &ScaledLikelihoods,
    ) -> ScaledLikelihoods {
        let (n, width) = (self.likelihoods.len(), volume.width());
        for (d, row) in self.likelihoods.iter_mut().rev().enumerate() {
            for (l, p) in row.iter_mut().enumerate() {
                let Pixel { x, y } = self.pixels[first + if l < count { l } else { 0 }];
                let missing = volume.row(y)[d * width + x] == NO_COST;
                *p = if missing { 1.0 / n as f32 } else { *p * scaled.scale[l] + scaled.floor };
            }
        }
        ScaledLikelihoods { scale: [1.0; LANES], floor: 0.0 }
    }

    /// Stores the costs of some of the pixels, each of which has one at least; returns the smallest of each.
    #[inline(always)]
    fn fill_costs(&mut self, volume: &CostVolume, first: usize, count: usize) -> [f32; LANES] {
        let (n, width) = (volume.disparities(), volume.width());
        self.likelihoods.clear();
        self.likelihoods.resize(n, [0.0; LANES]);
        // Places without a pixel repeat the first.
        let at = |l: usize| self.pixels[first + if l < count { l } else { 0 }];
        let curves: [&[u16]; LANES] = std::array::from_fn(|l| &volume.row(at(l).y)[at(l).x..]);
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

    /// Sets the weight w_i = stops (1 - stops)^(i-1) g_i of every cell, where g_i is the mean of p(E | d)
    /// over its length, 1/n where no hypothesis is. Returns the sum of all weights, with that of obstacles
    /// beyond all cells.
    #[inline(always)]
    fn fill_weights(&mut self, model: &LookModel, scaled: &ScaledLikelihoods) -> [f32; LANES] {
        self.weights.clear();
        let mut prior = model.stops;
        let mut all = [0.0_f32; LANES];
        for cell in 0..self.sections.cells.len() {
            let parts = self.sections.parts_of(cell);
            let measured: f32 = parts.iter().map(|part| part.share).sum();
            let unmeasured = if measured < 1.0 { 1.0 - measured } else { 0.0 };
            let known = (measured * scaled.floor + unmeasured / self.likelihoods.len() as f32) * prior;
            let mut mean = [0.0_f32; LANES];
            for part in parts {
                let g = &self.likelihoods[part.hypothesis as usize];
                for l in 0..LANES {
                    mean[l] += part.share * g[l];
                }
            }
            let mut weight = [0.0_f32; LANES];
            for l in 0..LANES {
                weight[l] = mean[l] * scaled.scale[l] * prior + known;
                all[l] += weight[l];
            }
            self.weights.push(weight);
            prior *= 1.0 - model.stops;
        }
        self.add_beyond(model, scaled, prior / model.stops, all)
    }

    /// Adds the weight of obstacles beyond all cells: the hypotheses that reach there are equally likely; 1/n
    /// where none does.
    #[inline(always)]
    fn add_beyond(
        &self,
        model: &LookModel,
        scaled: &ScaledLikelihoods,
        prior: f32,
        mut all: [f32; LANES],
    ) -> [f32; LANES] {
        let beyond = &self.likelihoods[model.first_beyond.min(self.likelihoods.len())..];
        let per_one = prior / beyond.len().max(1) as f32;
        let known = if beyond.is_empty() { 1.0 / self.likelihoods.len() as f32 } else { scaled.floor };
        let mut sum = [0.0_f32; LANES];
        for row in beyond {
            for l in 0..LANES {
                sum[l] += row[l];
            }
        }
        for l in 0..LANES {
            all[l] += sum[l] * scaled.scale[l] * per_one + known * prior;
        }
        all
    }

    /// Adds ln odds(P_i) - ln odds(prior) of every cell and pixel to the sums, where
    /// P_i = (w_i + stops sum_{j<i} w_j) / all.
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
