//! Semi-global matching: H. Hirschmueller, "Stereo processing by semiglobal matching and mutual information", PAMI 30(2),
//! 2008, section II-B.

mod block_costs;
mod finish;
mod pass;
mod paths;
mod pixel_costs;
mod settings;
mod travel;

use evigrid_core::GrayImage;

pub use settings::{PixelCost, SemiGlobalSettings};

use crate::block_matcher::require_same_size;
use crate::matching::{Buffers, Matching, Shape};
use crate::{BlockMatchingSettings, StereoError};
use finish::OutRows;
use pass::{Pass, Sums, run_steps};
use pixel_costs::{CHUNK, Planes};
use travel::Travel;

/// Semi-global matching: block costs summed along 4 or 8 paths that end at each pixel, on which steps of the disparity
/// are penalised; winner-take-all with a parabola for the sub-pixel part, peak ratio, left-right difference.
///
/// Pixel (x, y) of the left image is compared with (x - d, y) of the right one, for all d with x - d inside. Blocks that
/// reach over a border repeat the border's pixel costs. The volume holds the mean over the paths, rounded to the nearest
/// whole number (halves up), so that it keeps the unit of a block's cost; winners and ratios are those of the exact sums.
/// Buffers are kept from frame to frame.
#[derive(Debug)]
pub struct SemiGlobalMatcher {
    settings: SemiGlobalSettings,
    min_disparity: usize,
    disparities: usize,
    uniqueness_percent: u32,
    planes: Planes,
    passes: [Pass; 2],
    sums: Vec<u16>,
}

impl SemiGlobalMatcher {
    /// A matcher with these settings for the whole disparities `min_disparity .. min_disparity + disparities`.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(
        settings: SemiGlobalSettings,
        min_disparity: usize,
        disparities: usize,
    ) -> Result<Self, StereoError> {
        // The same bounds as for blocks.
        BlockMatchingSettings { min_disparity, disparities, ..Default::default() }.checked()?;
        Ok(Self {
            settings: settings.checked()?,
            min_disparity,
            disparities,
            uniqueness_percent: 0,
            planes: Planes::default(),
            passes: Default::default(),
            sums: Vec::new(),
        })
    }

    /// The same matcher, which drops a match if a hypothesis that is no neighbour of the winner costs less than
    /// `100 / (100 - percent)` times as much; 0 (at first) drops none. The rule is OpenCV's.
    #[must_use]
    pub fn with_uniqueness(self, percent: u32) -> Self {
        Self { uniqueness_percent: percent.min(99), ..self }
    }

    /// Matches a pair. `keep_volume` keeps all costs; `recycled` is the result of an earlier frame, whose buffers are
    /// filled again. The result does not depend on the number of threads, of which up to two are used.
    ///
    /// # Errors
    /// If the images differ in size, or there are more than 2^31 costs.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        keep_volume: bool,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        require_same_size(left, right)?;
        let shape = Shape {
            width: left.width(),
            height: left.height(),
            min_disparity: self.min_disparity,
            disparities: self.disparities,
        };
        let Shape { width, height, disparities, .. } = shape;
        if width.saturating_mul(height).saturating_mul(disparities) > MOST_COSTS {
            return Err(StereoError::TooManyCosts { width, height, disparities, most: MOST_COSTS });
        }
        self.planes.fill(&self.settings, shape, left, right);
        let job = Job::new(self.settings, shape, self.uniqueness_percent, left, &self.planes);
        let row_len = shape.width * job.padded;
        self.sums.resize(shape.height * row_len, 0);
        let mut out = Buffers::new(shape, keep_volume, recycled);
        run_passes(&job, &mut self.passes, &mut self.sums, &mut out);
        out.into_matching(shape)
    }
}

/// Costs of one pair, 2 bytes each: 4 GiB, and as much again where the volume is kept.
const MOST_COSTS: usize = 1 << 31;

/// Two passes, one from the top and one from the bottom. Each leaves the sums of its first half of the image to the
/// other, which adds its own and finishes the rows.
fn run_passes(job: &Job<'_>, passes: &mut [Pass; 2], sums: &mut [u16], out: &mut Buffers) {
    let Shape { width, height, .. } = job.shape;
    let [down, up] = passes;
    let [downwards, upwards] = [false, true].map(|upwards| Travel { upwards, width, height });
    let middle = height / 2;
    let (top, bottom) = sums.split_at_mut(middle * width * job.padded);
    let (out_top, out_bottom) = halves(job, middle, out);
    down.resize(job);
    up.resize(job);
    rayon::join(
        || run_steps(job, down, downwards, 0..middle, 0, Sums::Leave(top)),
        || run_steps(job, up, upwards, 0..height - middle, middle, Sums::Leave(bottom)),
    );
    rayon::join(
        || run_steps(job, down, downwards, middle..height, middle, Sums::Finish(bottom, out_bottom)),
        || run_steps(job, up, upwards, height - middle..height, 0, Sums::Finish(top, out_top)),
    );
}

/// The output above and from row `middle` on.
fn halves<'a>(job: &Job<'_>, middle: usize, out: &'a mut Buffers) -> (OutRows<'a>, OutRows<'a>) {
    let pixels = middle * job.shape.width;
    let (disparity_top, disparity) = out.disparity.split_at_mut(pixels);
    let (ratio_top, peak_ratio) = out.peak_ratio.split_at_mut(pixels);
    let (left_right_top, left_right) = out.left_right.split_at_mut(pixels);
    let (volume_top, volume) =
        out.volume.as_mut().map(|v| v.split_at_mut(middle * job.shape.volume_row_len())).unzip();
    (
        OutRows {
            disparity: disparity_top,
            peak_ratio: ratio_top,
            left_right: left_right_top,
            volume: volume_top,
        },
        OutRows { disparity, peak_ratio, left_right, volume },
    )
}

/// One pair to match.
pub(crate) struct Job<'a> {
    settings: SemiGlobalSettings,
    shape: Shape,
    uniqueness_percent: u32,
    left: &'a GrayImage,
    planes: &'a Planes,
    /// Hypotheses, padded to whole chunks.
    padded: usize,
    cost_shift: u32,
    p1: u16,
}

impl<'a> Job<'a> {
    fn new(
        settings: SemiGlobalSettings,
        shape: Shape,
        uniqueness_percent: u32,
        left: &'a GrayImage,
        planes: &'a Planes,
    ) -> Self {
        let cost_shift = settings.cost_shift();
        let padded = shape.disparities.next_multiple_of(CHUNK);
        let p1 = (settings.p1 >> cost_shift) as u16;
        Self { settings, shape, uniqueness_percent, left, planes, padded, cost_shift, p1 }
    }

    /// How many hypotheses pixel `x` has: those for which x - d is inside the right image.
    #[inline(always)]
    fn hypotheses(&self, x: usize) -> usize {
        (x + 1).saturating_sub(self.shape.min_disparity).min(self.shape.disparities)
    }

    /// Where the right pixel of the smallest hypothesis of pixel `x` stands in reversed rows; the others follow.
    #[inline(always)]
    fn facing(&self, x: usize) -> usize {
        self.shape.width - 1 - x + self.shape.min_disparity
    }

    /// The penalty for large steps between a pixel and the one before it on a path.
    #[inline(always)]
    fn p2(&self, travel: Travel, position: usize, step: usize, (dx, dy): (isize, isize)) -> u16 {
        let SemiGlobalSettings { p1, p2, adapt_p2, .. } = self.settings;
        if !adapt_p2 {
            return (p2 >> self.cost_shift) as u16;
        }
        let grey = |position: usize, step: usize| {
            let position = position.min(self.shape.width - 1);
            self.left.row(travel.row(step))[travel.column(position)]
        };
        let before = grey(position.saturating_add_signed(dx), step.saturating_add_signed(dy));
        let difference = usize::from(grey(position, step).abs_diff(before)).max(1);
        ((p2 / difference).max(p1) >> self.cost_shift) as u16
    }
}
