use evigrid_core::GrayImage;

use super::pixel_costs::{CHUNK, Planes};
use super::settings::SemiGlobalSettings;
use super::travel::{Offset, Travel};
use crate::buffers::Shape;

/// One pair to match.
pub(super) struct Job<'a> {
    pub settings: SemiGlobalSettings,
    pub shape: Shape,
    pub uniqueness_percent: u32,
    pub left: &'a GrayImage,
    pub planes: &'a Planes,
    /// Number of hypotheses, padded to whole chunks.
    pub padded: usize,
    pub cost_shift: u32,
    pub p1: u16,
}

impl<'a> Job<'a> {
    pub fn new(
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

    /// Number of hypotheses of pixel `x`: those for which x - d is inside the right image.
    #[inline(always)]
    pub fn hypotheses(&self, x: usize) -> usize {
        (x + 1).saturating_sub(self.shape.min_disparity).min(self.shape.disparities)
    }

    /// Place in reversed rows of the right pixel that the smallest hypothesis of pixel `x` points to; those
    /// of the larger ones follow.
    #[inline(always)]
    pub fn facing(&self, x: usize) -> usize {
        self.shape.width - 1 - x + self.shape.min_disparity
    }

    /// Penalty for large steps between a pixel and the one before it on a path, which lies at `before` from
    /// it.
    #[inline(always)]
    pub fn p2(&self, travel: Travel, position: usize, step: usize, before: Offset) -> u16 {
        let SemiGlobalSettings { p1, p2, adapt_p2, .. } = self.settings;
        if !adapt_p2 {
            return (p2 >> self.cost_shift) as u16;
        }
        let grey = |position: usize, step: usize| {
            let position = position.min(self.shape.width - 1);
            self.left.row(travel.row(step))[travel.column(position)]
        };
        let other =
            grey(position.saturating_add_signed(before.positions), step.saturating_add_signed(before.steps));
        let difference = usize::from(grey(position, step).abs_diff(other)).max(1);
        ((p2 / difference).max(p1) >> self.cost_shift) as u16
    }
}
