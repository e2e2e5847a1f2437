//! Semi-global matching: H. Hirschmueller, "Stereo processing by semiglobal matching and mutual information",
//! PAMI 30(2), 2008, section II-B.
//!
//! Two passes go over the image, one from the top and one from the bottom, on two threads. Each follows half
//! of the paths. A pass leaves the sums of its first half of the image in memory. The other pass comes by
//! later, adds its own sums and finishes the rows (winner, ratio, left-right difference) while they are in
//! the cache. So each sum is stored once and read once, and the result does not depend on the threads.
//!
//! - A cost curve is a run of hypotheses, padded to a multiple of 32. The rows of the right image are kept
//!   reversed, so that the pixels of all hypotheses of one left pixel lie side by side.
//! - Both passes compute the block costs for themselves, by running sums. That is cheaper than to store and
//!   read them.
//! - Each direction keeps one curve per column of the row before. The curves lie in slots that move by 0, 1
//!   or 2 with every row, so a path always comes from the slot after its own, and its curve overwrites one
//!   that is no longer needed.
//! - A hypothesis with x - d outside the image costs more than any path with all penalties. So no path takes
//!   it, and the loops need not ask.

mod block_costs;
mod finish;
mod job;
mod pass;
mod paths;
mod pixel_costs;
mod settings;
mod travel;

use std::ops::Range;

use evigrid_core::{GrayImage, Matching};

pub use settings::{PixelCost, SemiGlobalSettings};

use crate::buffers::{Buffers, Shape};
use crate::error::StereoError;
use crate::pair_matcher::{PairMatcher, PairTask, require_disparities, require_same_size};
use finish::OutRows;
use job::Job;
use pass::{Pass, Sums, run_steps};
use pixel_costs::Planes;
use travel::Travel;

/// Semi-global matching: block costs summed along 4 or 8 paths that end at each pixel, on which steps of the
/// disparity are penalised; winner-take-all with a parabola for the sub-pixel part, peak ratio, left-right
/// difference.
///
/// Pixel (x, y) of the left image is compared with (x - d, y) of the right one, for all d with x - d inside.
/// Blocks that reach over a border repeat the border's pixel costs. The volume holds the mean over the paths,
/// rounded to the nearest whole number (halves up), so that it keeps the unit of a block's cost; winners and
/// ratios are those of the exact sums. Buffers are kept from frame to frame.
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
    /// A matcher with these settings that tries the whole disparities of a range, pixels.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: SemiGlobalSettings, disparities: Range<usize>) -> Result<Self, StereoError> {
        require_disparities(disparities.start, disparities.len())?;
        Ok(Self {
            settings: settings.checked()?,
            min_disparity: disparities.start,
            disparities: disparities.len(),
            uniqueness_percent: 0,
            planes: Planes::default(),
            passes: Default::default(),
            sums: Vec::new(),
        })
    }

    /// Makes the matcher drop a match if a hypothesis that is no neighbour of the winner costs less than
    /// `100 / (100 - percent)` times as much; 0 (at first) drops none. The rule is OpenCV's.
    #[must_use]
    pub fn with_uniqueness(self, percent: u32) -> Self {
        Self { uniqueness_percent: percent.min(99), ..self }
    }

    /// Matches a pair. `keep_volume` keeps all costs; `recycled` is the result of an earlier frame, whose
    /// buffers are filled again. The result does not depend on the number of threads, of which up to two are
    /// used.
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
        require_few_costs(shape)?;
        self.planes.fill(&self.settings, shape, left, right);
        let job = Job::new(self.settings, shape, self.uniqueness_percent, left, &self.planes);
        let row_len = shape.width * job.padded;
        self.sums.resize(shape.height * row_len, 0);
        let mut out = Buffers::new(shape, keep_volume, recycled);
        run_passes(&job, &mut self.passes, &mut self.sums, &mut out);
        Ok(out.into_matching(shape, self.settings.cost_scale())?)
    }
}

impl PairMatcher for SemiGlobalMatcher {
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        Self::run(self, task.left, task.right, task.wanted.costs, task.recycled)
    }
}

/// Largest number of costs of one pair. They take 2 bytes each: 4 GiB, and as much again where the volume is
/// kept.
const MOST_COSTS: usize = 1 << 31;

/// Refuses a pair with more than [`MOST_COSTS`] costs.
fn require_few_costs(shape: Shape) -> Result<(), StereoError> {
    let Shape { width, height, disparities, .. } = shape;
    if width.saturating_mul(height).saturating_mul(disparities) <= MOST_COSTS {
        return Ok(());
    }
    Err(StereoError::TooLarge {
        matcher: "semi-global matching",
        expected: format!("at most {MOST_COSTS} costs"),
        found: format!("{width}x{height} pixels with {disparities} disparities"),
    })
}

/// Runs two passes, one from the top and one from the bottom. Each leaves the sums of its first half of the
/// image to the other, which adds its own and finishes the rows.
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
