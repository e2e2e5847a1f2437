//! Eqs 7, 9 or 6, 5 and 4 of Brandao et al. for some neighbouring pixels of a row at once.

use evigrid_core::{CostScale, CostVolume, NO_COST};
use evigrid_grid::{Clamp, FrameEvidence, bounded_logit, probability};

use super::cost_exponent::CostExponent;
use crate::cost_statistics::FreeSpaceCosts;
use crate::fast_math::exp_negative;

/// Pixels of a block: as many as a cache line holds costs.
pub(crate) const LANES: usize = 32;

/// The constants that turn the costs of one frame into probabilities, in single precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CurveModel {
    /// Exponent of eq. 7 per unit of the volume.
    linear: f32,
    /// Exponent of eq. 7 per squared unit of the volume.
    quadratic: f32,
    /// The costs of free space, if they are modelled (eq. 6).
    free_space: Option<FreeSpaceModel>,
    /// Bounds of the evidence.
    bounds: Clamp,
    /// The P of the lower bound.
    least: f32,
}

/// The normal distribution of the costs of free space (eq. 6).
#[derive(Debug, Clone, Copy)]
struct FreeSpaceModel {
    /// Mean, in units of the volume.
    mean: f32,
    /// Precision 1 / (2 variance), per squared unit of the volume.
    precision: f32,
}

impl CurveModel {
    /// The constants for costs of this scale, with the evidence kept within `bounds`.
    pub fn new(
        exponent: CostExponent,
        scale: CostScale,
        free_space: Option<FreeSpaceCosts>,
        bounds: Clamp,
    ) -> Self {
        let g = scale.grey_levels;
        Self {
            linear: (exponent.linear * g) as f32,
            quadratic: (exponent.quadratic * g * g) as f32,
            free_space: free_space
                .map(|f| FreeSpaceModel { mean: f.mean as f32, precision: (0.5 / f.variance) as f32 }),
            bounds,
            least: probability(f64::from(bounds.min)) as f32,
        }
    }

    /// Key of the lowest evidence: a cell that is simply free.
    pub fn free_key(&self) -> i32 {
        FrameEvidence::key(self.bounds.min)
    }

    /// The key of a probability. One as low as the lower bound is free, whatever rounding says.
    #[inline(always)]
    pub fn key(&self, p: f32) -> i32 {
        let l = bounded_logit(p, self.bounds);
        FrameEvidence::key(if p > self.least { l } else { self.bounds.min })
    }
}

/// The curves of up to [`LANES`] neighbouring pixels, `[hypothesis][pixel]`, hypotheses from the nearest to
/// the farthest.
#[derive(Debug, Default)]
pub(crate) struct CurveBlock {
    /// The smallest cost of every pixel of the row.
    least: Vec<u16>,
    /// Probabilities p(O_i | E V_i) but for a factor, that of each pixel.
    pub weights: Vec<[f32; LANES]>,
    /// The factor of each pixel.
    scale: [f32; LANES],
    /// Keys of the log-odds of P(O_i | E).
    pub keys: Vec<[i32; LANES]>,
    /// The largest key of four hypotheses from each on, as far as there are four.
    pub largest_of_4: Vec<[i32; LANES]>,
    /// How many of each pixel's nearest hypotheses are simply free.
    pub free: [u32; LANES],
    /// Whether a pixel has any cost at all.
    pub measured: [bool; LANES],
}

impl CurveBlock {
    /// Sets the smallest costs of row y, which come before its blocks. Read in the order in which they are
    /// stored, the row is fetched ahead; its blocks then find it in the cache.
    #[inline(always)]
    pub fn fill_least(&mut self, volume: &CostVolume, y: usize) {
        self.least.clear();
        self.least.resize(volume.width(), NO_COST);
        for costs in volume.row(y).chunks_exact(volume.width()) {
            for (least, &cost) in self.least.iter_mut().zip(costs) {
                *least = if cost < *least { cost } else { *least };
            }
        }
    }

    /// Sets p(O_i | E V_i) of the pixels x0.. of row y, whose smallest costs are known.
    #[inline(always)]
    pub fn fill_p(&mut self, model: &CurveModel, volume: &CostVolume, y: usize, x0: usize) {
        let costs = BlockCosts::new(volume, y, x0);
        self.weights.resize(volume.disparities(), [0.0; LANES]);
        let least = block_of(&self.least[x0..]);
        self.measured = least.map(|c| c != NO_COST);
        self.fill_likelihoods(model, costs, &least);
        if let Some(free_space) = model.free_space {
            self.add_free_space(free_space, costs);
        }
    }

    /// Sets the weights by eq. 7, which is also eq. 9.
    #[inline(always)]
    fn fill_likelihoods(&mut self, model: &CurveModel, costs: BlockCosts<'_>, least: &[u16; LANES]) {
        let least = least.map(f32::from);
        let mut sum = [0.0_f32; LANES];
        for (i, p) in self.weights.iter_mut().enumerate() {
            let row = costs.row(i);
            for l in 0..LANES {
                let c = f32::from(row[l]);
                // The difference to the smallest exponent, a (c - c0) + b (c^2 - c0^2).
                let exponent = (c - least[l]) * (model.linear + model.quadratic * (c + least[l]));
                p[l] = if row[l] == NO_COST { 0.0 } else { exp_negative(exponent) };
                sum[l] += p[l];
            }
        }
        self.scale = reciprocals(sum);
    }

    /// Turns the weights into those of eq. 6, with a normal distribution of the costs of free space that is
    /// normalised along the curve.
    #[inline(always)]
    fn add_free_space(&mut self, free_space: FreeSpaceModel, costs: BlockCosts<'_>) {
        let FreeSpaceModel { mean, precision } = free_space;
        let off = |c: u16| (f32::from(c) - mean) * (f32::from(c) - mean) * precision;
        let mut least = [f32::INFINITY; LANES];
        for i in 0..costs.len() {
            let row = costs.row(i);
            for l in 0..LANES {
                let o = if row[l] == NO_COST { f32::INFINITY } else { off(row[l]) };
                least[l] = if o < least[l] { o } else { least[l] };
            }
        }
        let mut sum = [0.0_f32; LANES];
        for i in 0..costs.len() {
            let row = costs.row(i);
            for l in 0..LANES {
                sum[l] += if row[l] == NO_COST { 0.0 } else { exp_negative(off(row[l]) - least[l]) };
            }
        }
        let free_scale = reciprocals(sum);
        for (i, weights) in self.weights.iter_mut().enumerate() {
            let row = costs.row(i);
            for l in 0..LANES {
                let free = exp_negative(off(row[l]) - least[l]) * free_scale[l];
                let occupied = weights[l] * self.scale[l];
                weights[l] = if occupied > 0.0 { occupied / (occupied + free) } else { 0.0 };
            }
        }
        self.scale = [1.0; LANES];
    }

    /// Probability p(O_i | E V_i) of a pixel.
    #[inline]
    pub fn p(&self, i: usize, lane: usize) -> f32 {
        at_most_1(self.weights[i][lane] * self.scale[lane])
    }

    /// Sets the keys by eqs 5 and 4 along the hypotheses.
    #[inline(always)]
    pub fn fill_keys(&mut self, model: &CurveModel) {
        self.keys.resize(self.weights.len(), [0; LANES]);
        let free_key = model.free_key();
        let mut hidden = [0.0_f32; LANES];
        let mut all_free = [1_u32; LANES];
        self.free = [0; LANES];
        for (weights, keys) in self.weights.iter().zip(&mut self.keys) {
            for l in 0..LANES {
                let occupied = see(at_most_1(weights[l] * self.scale[l]), &mut hidden[l]);
                keys[l] = model.key(occupied);
                all_free[l] &= u32::from(keys[l] == free_key);
                self.free[l] += all_free[l];
            }
        }
    }

    /// Sets the largest key of every four neighbouring hypotheses.
    #[inline(always)]
    pub fn fill_largest_of_4(&mut self) {
        self.largest_of_4.resize(self.keys.len(), [0; LANES]);
        for (largest, keys) in self.largest_of_4.iter_mut().zip(self.keys.windows(4)) {
            for l in 0..LANES {
                largest[l] = keys[0][l].max(keys[1][l]).max(keys[2][l].max(keys[3][l]));
            }
        }
    }

    /// The largest key of the hypotheses from..=to of a pixel. Few cells hold more than four; for up to four
    /// there is nothing to mispredict.
    #[inline(always)]
    pub fn largest_key(&self, lane: usize, from: usize, to: usize) -> i32 {
        if from + 4 > to {
            let [second, third] = [from + 1, from + 2].map(|i| self.keys[i.min(to)][lane]);
            return self.keys[from][lane].max(self.keys[to][lane]).max(second.max(third));
        }
        let (mut i, mut key) = (from + 4, self.largest_of_4[from][lane].max(self.largest_of_4[to - 3][lane]));
        while i + 3 < to {
            key = key.max(self.largest_of_4[i][lane]);
            i += 4;
        }
        key
    }
}

/// One step outwards: P(O_i | E) (eq. 4) from p(O_i | E V_i) and 1 - v_i, which becomes that of the next cell
/// (eq. 5).
///
/// The sum is kept of 1 - v, since that is small where precision counts. P is above 0.5 only where p is, in
/// spite of rounding.
#[inline(always)]
pub(crate) fn see(p: f32, hidden: &mut f32) -> f32 {
    let visible = p * (1.0 - *hidden);
    let occupied = visible + 0.5 * *hidden;
    *hidden += visible;
    let at_most = if occupied < 0.5 { occupied } else { 0.5 };
    let at_least = if occupied > 0.5 { occupied } else { 0.5 };
    if p > 0.5 { at_least } else { at_most }
}

/// The reciprocals of sums, 0 for empty ones.
#[inline(always)]
fn reciprocals(sum: [f32; LANES]) -> [f32; LANES] {
    sum.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 })
}

/// A probability that rounding may have put above 1, cut off there.
#[inline(always)]
fn at_most_1(p: f32) -> f32 {
    if p < 1.0 { p } else { 1.0 }
}

/// The costs of a block, hypotheses from the nearest to the farthest; [`NO_COST`] beyond the row's end.
#[derive(Clone, Copy)]
struct BlockCosts<'a> {
    row: &'a [u16],
    width: usize,
    disparities: usize,
    x0: usize,
}

impl<'a> BlockCosts<'a> {
    fn new(volume: &'a CostVolume, y: usize, x0: usize) -> Self {
        Self { row: volume.row(y), width: volume.width(), disparities: volume.disparities(), x0 }
    }

    fn len(&self) -> usize {
        self.disparities
    }

    #[inline(always)]
    fn row(&self, i: usize) -> [u16; LANES] {
        let start = (self.disparities - 1 - i) * self.width;
        block_of(&self.row[start + self.x0..start + self.width])
    }
}

/// The first costs of a row's rest; [`NO_COST`] beyond its end.
#[inline(always)]
fn block_of(costs: &[u16]) -> [u16; LANES] {
    if let Some(costs) = costs.first_chunk() {
        return *costs;
    }
    let mut block = [NO_COST; LANES];
    block[..costs.len()].copy_from_slice(costs);
    block
}
