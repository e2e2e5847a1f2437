use evigrid_core::{CostVolume, MatchFilter};
use evigrid_grid::ViewRays;

use super::curve_block::CurveModel;
use crate::hypotheses::Hypotheses;

/// The cost curves of one frame, with everything that turns them into evidence for the cells of their rays.
pub(crate) struct FrameCurves<'a> {
    /// The costs of all pixels.
    pub volume: &'a CostVolume,
    /// From costs to probabilities.
    pub model: CurveModel,
    /// The depths that the costs of a pixel stand for.
    pub hypotheses: &'a Hypotheses,
    /// The rays of the pixels.
    pub rays: ViewRays<'a>,
    /// The pixels that are drawn: those that the right image confirms, if it is asked.
    pub filter: MatchFilter<'a>,
}

impl FrameCurves<'_> {
    /// Whether a pixel is to be drawn: all are, unless the right image is asked.
    #[inline(always)]
    pub fn accepts(&self, x: usize, y: usize) -> bool {
        self.filter.is_confirmed(y * self.volume.width() + x)
    }
}
