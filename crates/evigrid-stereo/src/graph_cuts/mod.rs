//! Graph cuts: V. Kolmogorov, R. Zabih, "Computing visual correspondence with occlusions using graph cuts",
//! ICCV 2001; V. Kolmogorov, P. Monasse, P. Tan, "Kolmogorov and Zabih's graph cuts stereo matching
//! algorithm", IPOL 4, 2014.
//!
//! The energy is in `energy.rs`, one expansion move in `expansion.rs`, the minimum cut in `max_flow.rs` and
//! the graph that is cut in `flow_graph.rs`.
//!
//! - The unknowns are assignments of a left pixel to a right one. No pixel of either image has two active
//!   ones, so matches are unique, and occluded pixels have none. Assignments are never stored: a move
//!   computes their costs from both images when it needs them.
//! - The graph of a move holds only assignments that the move may change. An assignment that costs more than
//!   the penalties of all its neighbours could spare is dropped first; that may drop its neighbours too. Of
//!   the active assignments, only those count that a candidate touches. The move is still the best of all:
//!   the tests compare it with every possible move on tiny images.
//! - A move is made only if it lowers the energy. So ties keep the labels as they are, and the result depends
//!   on nothing but the images and the settings.

mod energy;
mod expansion;
mod flow_graph;
mod max_flow;
mod settings;
#[cfg(test)]
mod tests;

use std::ops::Range;

use evigrid_core::{GrayImage, Matching};

pub use settings::GraphCutSettings;

use crate::buffers::{Buffers, Shape};
use crate::error::StereoError;
use crate::pair_matcher::{PairMatcher, PairTask, require_disparities, require_same_size};
use energy::{Energy, OCCLUDED};
use expansion::{Expansion, Labels};

/// Pixels of the largest image. A pixel needs up to about 250 bytes.
const MAX_PIXELS: usize = 1 << 22;

/// Matching by graph cuts: whole disparities, or none, for all pixels at once, so that the sum of matching
/// costs, occlusion penalties and smoothness penalties is low. No two left pixels match the same right one.
/// It is lowered by the best expansion of one disparity after the other, from the smallest to the largest,
/// until none lowers it.
///
/// A match has peak ratio infinity and left-right difference 0, for it is unique already, and no runner-up is
/// known. There is no cost volume. Times grow with pixels times disparities: about 20 s for 450x375 pixels
/// and 64 disparities, minutes for 1242x375 and 128.
#[derive(Debug, Clone)]
pub struct GraphCutMatcher {
    settings: GraphCutSettings,
    min_disparity: usize,
    disparities: usize,
}

impl GraphCutMatcher {
    /// A matcher with these settings that tries the whole disparities of a range, pixels.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: GraphCutSettings, disparities: Range<usize>) -> Result<Self, StereoError> {
        let (min_disparity, count) = (disparities.start, disparities.len());
        require_disparities(min_disparity, count)?;
        Ok(Self { settings: settings.checked()?, min_disparity, disparities: count })
    }

    /// Matches a pair. `recycled` is the result of an earlier frame, whose buffers are filled again. The
    /// result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size or have more than 4194304 pixels.
    pub fn run(
        &self,
        left: &GrayImage,
        right: &GrayImage,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        require_same_size(left, right)?;
        let (width, height) = (left.width(), left.height());
        require_few_pixels(width, height)?;
        let Self { min_disparity, disparities, .. } = *self;
        let shape = Shape { width, height, min_disparity, disparities };
        let energy = Energy::new(&self.settings, shape, left, right);
        let labels = minimise(&energy, self.settings.max_rounds, |_| {});
        let mut out = Buffers::new(shape, false, recycled);
        for (i, &label) in labels.left.iter().enumerate() {
            (out.disparity[i], out.peak_ratio[i], out.left_right[i]) = match label {
                OCCLUDED => (f32::NAN, f32::NAN, u16::MAX),
                label => (energy.shift(label) as f32, f32::INFINITY, 0),
            };
        }
        Ok(out.into_matches(shape)?.into())
    }
}

impl PairMatcher for GraphCutMatcher {
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        Self::run(self, task.left, task.right, task.recycled)
    }
}

/// Refuses an image of more than [`MAX_PIXELS`] pixels.
fn require_few_pixels(width: usize, height: usize) -> Result<(), StereoError> {
    if width * height <= MAX_PIXELS {
        return Ok(());
    }
    Err(StereoError::TooLarge {
        matcher: "graph cuts",
        expected: format!("an image of at most {MAX_PIXELS} pixels"),
        found: format!("{width}x{height}"),
    })
}

/// Expands one disparity after the other until a whole round changes nothing, or so many rounds are done.
/// `after_move` is told the energy after every move.
fn minimise(energy: &Energy, max_rounds: usize, mut after_move: impl FnMut(i64)) -> Labels {
    let pixels = energy.shape.width * energy.shape.height;
    let mut labels = Labels::occluded(pixels);
    let mut expansion = Expansion::new(pixels);
    let (mut now, mut unchanged) = (0, 0);
    for _ in 0..max_rounds {
        for label in 0..energy.shape.disparities as u16 {
            let before = now;
            now = expansion.run(energy, &mut labels, before, label);
            after_move(now);
            unchanged = if now < before { 0 } else { unchanged + 1 };
            if unchanged >= energy.shape.disparities {
                return labels;
            }
        }
    }
    labels
}
