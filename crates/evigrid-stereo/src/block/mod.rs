//! Block matching by the sum of absolute differences (SAD).

pub(crate) mod bands;
pub(crate) mod job;
pub(crate) mod match_rows;
mod settings;

use evigrid_core::{GrayImage, Matching};
use rayon::prelude::*;

pub use settings::BlockMatchingSettings;

use crate::buffers::Buffers;
use crate::error::StereoError;
use crate::pair_matcher::{PairMatcher, PairTask};
use bands::{bands, clear_border};
use job::Job;
use match_rows::{Scratch, match_rows};

/// Block matching by the sum of absolute differences (SAD): cost volume, winner-take-all with a parabola for
/// the sub-pixel part, peak ratio, left-right difference.
///
/// Pixel (x, y) of the left image is compared with (x - d, y) of the right one. A hypothesis has a cost where
/// its window lies in both images. Buffers are kept from frame to frame.
#[derive(Debug)]
pub struct BlockMatcher {
    settings: BlockMatchingSettings,
    uniqueness_percent: u32,
    bands: Vec<Scratch>,
}

impl BlockMatcher {
    /// A matcher with these settings.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: BlockMatchingSettings) -> Result<Self, StereoError> {
        Ok(Self { settings: settings.checked()?, uniqueness_percent: 0, bands: Vec::new() })
    }

    /// Makes the matcher drop a match if a hypothesis that is no neighbour of the winner costs less than
    /// `100 / (100 - percent)` times as much; 0 (at first) drops none. The rule is OpenCV's.
    #[must_use]
    pub fn with_uniqueness(self, percent: u32) -> Self {
        Self { uniqueness_percent: percent.min(99), ..self }
    }

    /// Matches a pair. `keep_volume` keeps all costs; `recycled` is the result of an earlier frame, whose
    /// buffers are filled again. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size or are smaller than the window.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        keep_volume: bool,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        let job = Job::new(self.settings, self.uniqueness_percent, left, right)?;
        let mut out = Buffers::new(job.shape(), keep_volume, recycled);
        clear_border(&mut out, &job);
        let band_count = rayon::current_num_threads().clamp(1, job.rows());
        let band_rows = job.rows().div_ceil(band_count);
        self.bands.resize_with(band_count, Scratch::default);
        bands(&mut out, &job, band_rows)
            .into_par_iter()
            .zip(&mut self.bands)
            .for_each(|(band, scratch)| match_rows(&job, band, scratch));
        Ok(out.into_matching(job.shape(), self.settings.cost_scale())?)
    }
}

impl PairMatcher for BlockMatcher {
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        Self::run(self, task.left, task.right, task.wanted.costs, task.recycled)
    }
}
