//! The occupancy grid of a single image.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use evigrid_grid::{Clamp, GridSpec, LogOddsGrid, bounded_logit};
use multiversion::multiversion;
use rayon::prelude::*;

use crate::blur::{Blur, PoseDeviation};

/// Cells whose marks are in one word.
const BLOCK: usize = 64;
/// Blocks that one task fuses.
const BLOCKS_PER_TASK: usize = 256;

/// The evidence of ONE image for every cell, as P. Within an image the obstacle has priority: a cell keeps
/// the largest P that it is offered (Andert 2009, section V-A, step 2b), so that neither the order of pixels
/// nor the number of threads matters.
#[derive(Debug)]
pub(crate) struct ImageGrid {
    spec: GridSpec,
    /// A bit per cell: whether anything was said of it. A marked cell has at least the least P; most have no
    /// more, and of them no more is ever written.
    marks: Vec<AtomicU64>,
    /// The bits of P, which order like P, where it is more than the least.
    cells: Vec<AtomicU32>,
    /// P of free space, the least that the image says of any cell.
    least: f32,
}

/// How the log-odds of an image are added to a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fusion {
    /// Bounds of the evidence of one image.
    pub evidence: Clamp,
    /// Bounds of the map.
    pub map: Clamp,
    /// Log-odds of the prior, l_0: a cell starts there, and every image says L - l_0 more (Souza eq. 3).
    pub prior: f32,
    /// The one level of cells that is mapped, if not all are.
    pub level: Option<usize>,
}

impl ImageGrid {
    /// An empty grid of which nothing is said.
    pub fn new(spec: GridSpec) -> Self {
        let count = spec.cell_count();
        Self {
            spec,
            marks: (0..count.div_ceil(BLOCK)).map(|_| AtomicU64::new(0)).collect(),
            cells: (0..count).map(|_| AtomicU32::new(0)).collect(),
            least: 0.0,
        }
    }

    /// The grid's geometry.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Begins an image whose least P, that of free space, is this.
    pub fn begin(&mut self, least: f32) {
        self.least = least;
    }

    /// Offers P, from the least on, to a cell.
    #[inline(always)]
    pub fn offer(&self, flat: usize, probability: f32) {
        self.offer_least(flat);
        let (slot, bits) = (&self.cells[flat], probability.to_bits());
        // Most lines of an image offer a cell what it already has: look before the locked write.
        if probability > self.least && slot.load(Ordering::Relaxed) < bits {
            slot.fetch_max(bits, Ordering::Relaxed);
        }
    }

    /// Offers the least P to a cell.
    #[inline(always)]
    pub fn offer_least(&self, flat: usize) {
        let (word, bit) = (&self.marks[flat / BLOCK], 1 << (flat % BLOCK));
        if word.load(Ordering::Relaxed) & bit == 0 {
            word.fetch_or(bit, Ordering::Relaxed);
        }
    }

    /// P of a cell; `None` if nothing was said of it.
    pub fn get(&self, flat: usize) -> Option<f32> {
        let marked = self.marks[flat / BLOCK].load(Ordering::Relaxed) >> (flat % BLOCK) & 1 == 1;
        marked.then(|| self.least.max(f32::from_bits(self.cells[flat].load(Ordering::Relaxed))))
    }

    /// The image's grid as log-odds (eq. 8); NaN where nothing was said.
    pub fn log_odds(&self, bounds: Clamp) -> LogOddsGrid {
        let mut grid = LogOddsGrid::unknown(self.spec);
        let values = grid.values_mut().par_chunks_mut(BLOCK).enumerate();
        values.for_each(|(block, values)| {
            for (value, flat) in values.iter_mut().zip(block * BLOCK..) {
                *value = self.get(flat).map_or(f32::NAN, |p| bounded_logit(p, bounds));
            }
        });
        grid
    }

    /// Empties the grid.
    pub fn clear(&mut self) {
        let blocks = self.cells.chunks_mut(BLOCK).zip(&mut self.marks);
        for (cells, marks) in blocks {
            if std::mem::take(marks.get_mut()) != 0 {
                cells.iter_mut().for_each(|cell| *cell.get_mut() = 0);
            }
        }
    }

    /// The indices from..to per axis around all blocks of which something was said.
    fn used_box(&self) -> [Range<usize>; 3] {
        let used = (0..self.marks.len()).filter(|&b| self.marks[b].load(Ordering::Relaxed) != 0);
        let last = self.spec.cell_count() - 1;
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for block in used {
            let ends = [block * BLOCK, last.min(block * BLOCK + BLOCK - 1)].map(|flat| self.spec.voxel(flat));
            for a in 0..3 {
                // A block that goes on in the next row has cells at both ends of it.
                let whole = ends[0][..a] != ends[1][..a];
                let (first, last) =
                    if whole { (0, self.spec.shape()[a] - 1) } else { (ends[0][a], ends[1][a]) };
                (low[a], high[a]) = (low[a].min(first), high[a].max(last + 1));
            }
        }
        std::array::from_fn(|a| low[a].min(high[a])..high[a])
    }

    /// Adds the image, blurred, to a map and empties it; the number of cells of which it said something
    /// before.
    pub fn fuse_blurred(
        &mut self,
        map: &mut LogOddsGrid,
        fusion: &Fusion,
        blur: &mut Blur,
        vehicle_m: [f64; 3],
        deviation: &PoseDeviation,
    ) -> u64 {
        let (shape, around) = (self.spec.shape(), self.used_box());
        let margin = deviation.margin(&self.spec, vehicle_m, &around);
        let low: [usize; 3] = std::array::from_fn(|a| around[a].start.saturating_sub(margin));
        let size: [usize; 3] = std::array::from_fn(|a| (around[a].end + margin).min(shape[a]) - low[a]);
        if around.iter().any(Range::is_empty) {
            return 0;
        }
        blur.values.clear();
        blur.touched.clear();
        for flat in flats(&self.spec, low, size) {
            let known = self.get(flat);
            // What is blurred is what the image adds: nothing where it says nothing.
            blur.values.push(known.map_or(0.0, |p| bounded_logit(p, fusion.evidence) - fusion.prior));
            blur.touched.push(u8::from(known.is_some()));
        }
        let count = blur.touched.iter().map(|&t| u64::from(t)).sum();
        let values = map.values_mut();
        blur.run(&self.spec, low, size, vehicle_m, deviation, |flat, l| {
            if fusion.level.is_none_or(|only| only == flat % shape[2]) {
                values[flat] = fusion.add(values[flat], l + fusion.prior);
            }
        });
        self.clear();
        count
    }

    /// Adds the image to a map and empties it; the number of cells of which it said something.
    pub fn fuse_into(&mut self, map: &mut LogOddsGrid, fusion: &Fusion) -> u64 {
        let levels = self.spec.shape()[2];
        let count = AtomicU64::new(0);
        let tasks = self.cells.par_chunks_mut(BLOCK * BLOCKS_PER_TASK);
        let least = self.least;
        let marks = self.marks.par_chunks_mut(BLOCKS_PER_TASK);
        let values = map.values_mut().par_chunks_mut(BLOCK * BLOCKS_PER_TASK);
        tasks.zip(marks).zip(values).enumerate().for_each(|(task, ((cells, marks), values))| {
            let mut different = 0;
            for (block, marks) in marks.iter_mut().enumerate() {
                let marks = std::mem::take(marks.get_mut());
                if marks == 0 {
                    continue;
                }
                different += u64::from(marks.count_ones());
                let range = block * BLOCK..cells.len().min((block + 1) * BLOCK);
                let first = task * BLOCK * BLOCKS_PER_TASK + range.start;
                let marks = fusion.wanted(marks, first, levels);
                fuse_block(&mut cells[range.clone()], &mut values[range], marks, least, fusion);
            }
            count.fetch_add(different, Ordering::Relaxed);
        });
        count.into_inner()
    }
}

/// The cells of a box, whole numbers from `low` on.
fn flats(spec: &GridSpec, low: [usize; 3], shape: [usize; 3]) -> impl Iterator<Item = usize> {
    let [x, y, z] = spec.strides();
    let first = low[0] * x + low[1] * y + low[2] * z;
    let rows = (0..shape[0]).flat_map(move |i| (0..shape[1]).map(move |j| first + i * x + j * y));
    rows.flat_map(move |row| (0..shape[2]).map(move |k| row + k * z))
}

/// Adds the marked cells of one block to the map, and empties them. Without branches, since cells that are
/// met lie among others.
#[multiversion(targets("x86_64+avx2"))]
fn fuse_block(cells: &mut [AtomicU32], values: &mut [f32], marks: u64, least: f32, fusion: &Fusion) {
    let mut probabilities = [least; BLOCK];
    for (p, cell) in probabilities.iter_mut().zip(cells) {
        let more = f32::from_bits(std::mem::take(cell.get_mut()));
        *p = if more > least { more } else { least };
    }
    for (n, (value, &p)) in values.iter_mut().zip(&probabilities).enumerate() {
        let after = fusion.add(*value, bounded_logit(p, fusion.evidence));
        *value = if marks >> n & 1 == 1 { after } else { *value };
    }
}

impl Fusion {
    /// The marks of a block, whose first cell is `first`, of those cells that are mapped.
    fn wanted(&self, marks: u64, first: usize, levels: usize) -> u64 {
        let Some(only) = self.level else { return marks };
        (0..BLOCK).filter(|n| (first + n) % levels == only).fold(0, |kept, n| kept | marks & 1 << n)
    }

    /// Log-odds of a cell after one more image: l_t = l_{t-1} + L - l_0 (Souza eq. 3, with the prior's
    /// log-odds subtracted as Bayes' rule has it; the print adds them). A cell that was never touched (NaN)
    /// is at the prior.
    #[inline(always)]
    pub fn add(&self, before: f32, log_odds: f32) -> f32 {
        let before = if before.is_nan() { self.prior } else { before };
        let after = before + log_odds - self.prior;
        let after = if after < self.map.max { after } else { self.map.max };
        if after > self.map.min { after } else { self.map.min }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::{GridSettings, logit};

    fn grid() -> ImageGrid {
        let settings = GridSettings { x_m: [0.0, 30.0], y_m: [0.0, 4.0], z_m: [0.0, 3.0], cell_size_m: 1.0 };
        ImageGrid::new(GridSpec::new(&settings).unwrap())
    }

    const WIDE: Clamp = Clamp { min: -5.0, max: 5.0 };

    #[test]
    fn obstacles_have_priority_and_images_add_up() {
        let mut image = grid();
        let mut map = LogOddsGrid::unknown(*image.spec());
        let fusion = Fusion { evidence: WIDE, map: WIDE, prior: 0.0, level: None };
        image.begin(0.35);
        for times in [1.0, 2.0] {
            for p in [0.35, 0.8, 0.6] {
                image.offer(300, p);
            }
            image.offer_least(300);
            image.offer_least(2);
            assert_eq!((image.get(300), image.get(2), image.get(1)), (Some(0.8), Some(0.35), None));
            assert_eq!(image.log_odds(WIDE).touched().count(), 2);
            assert_eq!(image.fuse_into(&mut map, &fusion), 2);
            assert_eq!(image.get(300), None);
            for (cell, p) in [(300, 0.8), (2, 0.35)] {
                let found = f64::from(map.log_odds(cell).unwrap());
                assert!((found - times * logit(p)).abs() < 1e-5);
            }
        }
        assert_eq!(map.touched().count(), 2);
    }

    #[test]
    fn a_prior_is_subtracted_once_per_image() {
        // Bayes by hand: odds = p0/(1-p0) * prod (p/(1-p)) / (p0/(1-p0)).
        let (prior, ps) = (0.2_f64, [0.7_f64, 0.35, 0.6]);
        let odds = |p: f64| p / (1.0 - p);
        let expected = ps.iter().fold(odds(prior), |o, &p| o * odds(p) / odds(prior)).ln();
        let mut image = grid();
        let mut map = LogOddsGrid::unknown(*image.spec());
        let fusion = Fusion { evidence: WIDE, map: WIDE, prior: logit(prior) as f32, level: Some(1) };
        for p in ps {
            image.offer(4, p as f32);
            image.offer(5, p as f32);
            image.fuse_into(&mut map, &fusion);
        }
        assert!((f64::from(map.log_odds(4).unwrap()) - expected).abs() < 1e-5);
        // Cell 5 is on level 2, and level 1 alone is mapped.
        assert_eq!(map.log_odds(5), None);
    }
}
