use std::ops::{Range, RangeInclusive};

use evigrid_core::DisparityPlane;

use super::settings::DoubleCorrelationSettings;
use super::shear::Shear;
use crate::block::job::Job;

/// One pair to match under both hypotheses.
pub(super) struct DoubleJob<'a> {
    pub upright: Job<'a>,
    pub shear: &'a Shear,
    pub ground: DisparityPlane,
    pub settings: DoubleCorrelationSettings,
    /// Largest residual disparity of any row, pixels.
    pub reach: usize,
}

/// Columns of a row in which one residual disparity stands for one hypothesis.
pub(super) struct RoadRun {
    /// Number of the residual disparity.
    pub number: usize,
    /// Number of the hypothesis, from the smallest disparity on.
    pub hypothesis: usize,
    pub columns: Range<usize>,
}

impl DoubleJob<'_> {
    pub fn width(&self) -> usize {
        self.upright.width()
    }

    /// The disparities of the road less those of the ground that are tried, pixels.
    pub fn residuals(&self) -> RangeInclusive<isize> {
        -(self.reach as isize)..=self.reach as isize
    }

    /// Every residual disparity that the road may have in row `y`, where its window lies in both images.
    #[inline(always)]
    pub fn for_each_road_run(&self, y: usize, mut each: impl FnMut(RoadRun)) {
        let (settings, radius, width) =
            (&self.upright.settings, self.upright.settings.radius() as isize, self.width() as isize);
        let hypotheses =
            settings.min_disparity as isize..(settings.min_disparity + settings.disparities) as isize;
        let above = self.shear.extent(y - settings.radius())[0];
        let below = self.shear.extent(y + settings.radius())[1];
        // Columns of the sheared image beyond its ends go with the first and the last run.
        let all = self.shear.runs(y);
        for (number, run) in all.iter().enumerate() {
            let from = if number == 0 { -width } else { run.columns.start as isize };
            let to = if number + 1 == all.len() { 2 * width } else { run.columns.end as isize };
            let tolerance = self.settings.tolerance_px(run.shift as f64).min(self.reach) as isize;
            for residual in -tolerance..=tolerance {
                let disparity = run.shift + residual;
                if !hypotheses.contains(&disparity) {
                    continue;
                }
                // Left and right ends of the window in both images, in all of its rows.
                let first = (from + residual).max(radius).max(radius + below + residual);
                let end = (to + residual).min(width - radius);
                let end = end.min(width - radius + above + residual);
                if first < end {
                    each(RoadRun {
                        number: (residual + self.reach as isize) as usize,
                        hypothesis: (disparity - hypotheses.start) as usize,
                        columns: first as usize..end as usize,
                    });
                }
            }
        }
    }

    /// What the ground's disparity at a pixel has beyond its whole part, pixels: the whole ones of a window are
    /// rounded row by row, so that those of its middle row are right on average.
    pub fn ground_fraction(&self, x: usize, y: usize) -> f32 {
        let ground = self.ground.at(x as f64, y as f64);
        (ground - ground.round()) as f32
    }
}
