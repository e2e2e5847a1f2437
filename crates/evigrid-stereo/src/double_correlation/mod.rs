//! Double correlation: road and obstacles told apart while they are matched (Perrollaz et al. 2012, 3.3; Perrollaz
//! et al. 2010 call it so).
//!
//! A pixel is matched under two hypotheses. If it shows an obstacle, its neighbourhood stands upright: the window is
//! the same in both images. If it shows the road, disparities grow from row to row as those of the ground do: the
//! window is sheared, and its disparity is tied to its row. The cheaper one of the two decides the class. So no
//! height is compared with a threshold.

mod job;
mod match_rows;
mod settings;
mod shear;
mod v_disparity;

use evigrid_core::{Disparity, DisparityPlane, Matching, RoadSplit};
use rayon::prelude::*;

pub use settings::{DoubleCorrelationSettings, GroundSource};

use crate::block::BlockMatchingSettings;
use crate::block::bands::{bands, clear_border};
use crate::block::job::Job;
use crate::buffers::{Buffers, Shape};
use crate::error::StereoError;
use crate::pair_matcher::{PairMatcher, PairTask};
use job::DoubleJob;
use match_rows::{Scratch, match_rows};
use shear::Shear;
use v_disparity::VDisparity;

/// Block matching by the sum of absolute differences under two hypotheses, an upright window and one that follows
/// the ground.
///
/// - The road's disparity may differ from the ground's by a tolerance that grows with it.
/// - Costs of both are sums over windows of the same size, and compared as they are. Where they are equal the pixel
///   is road.
/// - Peak ratio and left-right difference are those of the lower one of both costs of each disparity.
/// - A hypothesis has a cost where its window lies in both images.
#[derive(Debug)]
pub struct DoubleCorrelationMatcher {
    settings: DoubleCorrelationSettings,
    block: BlockMatchingSettings,
    uniqueness_percent: u32,
    bands: Vec<Scratch>,
    shear: Shear,
    v_disparity: Option<VDisparity>,
    is_road: Vec<bool>,
}

impl DoubleCorrelationMatcher {
    /// A matcher with these settings; of `block` the disparities count.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(
        settings: DoubleCorrelationSettings,
        block: BlockMatchingSettings,
    ) -> Result<Self, StereoError> {
        let settings = settings.checked()?;
        let block = BlockMatchingSettings { window: settings.window, ..block }.checked()?;
        let v_disparity = match settings.ground {
            GroundSource::Mounting => None,
            GroundSource::VDisparity => Some(VDisparity::new(block)?),
        };
        let (bands, shear, is_road) = (Vec::new(), Shear::default(), Vec::new());
        Ok(Self { settings, block, uniqueness_percent: 0, bands, shear, v_disparity, is_road })
    }

    /// As [`crate::BlockMatcher::with_uniqueness`].
    #[must_use]
    pub fn with_uniqueness(self, percent: u32) -> Self {
        Self { uniqueness_percent: percent.min(99), ..self }
    }

    /// Largest difference between the disparities of road and ground in any row, pixels, among the disparities that
    /// are tried.
    fn reach(&self, ground: &DisparityPlane, shape: Shape) -> usize {
        let corner = |column: usize, row: usize| ground.at(column as f64, row as f64);
        let (width, height) = (shape.width, shape.height);
        let corners = [corner(0, 0), corner(width, 0), corner(0, height), corner(width, height)];
        let largest = corners.into_iter().fold(0.0, f64::max);
        // Ground that is so near that its tolerance does not reach the range is no hypothesis.
        let DoubleCorrelationSettings { road_tolerance_px: px, road_tolerance_share: share, .. } =
            self.settings;
        let tried = (shape.min_disparity + shape.disparities) as f64;
        let nearest = (tried + px + 1.0) / (1.0 - share).max(0.01);
        // Rounding may take a row's ground one pixel further.
        self.settings.tolerance_px(largest.min(nearest) + 1.0).min(width)
    }

    /// The ground of a pair: that of the frame, if it is asked for and found, else that of the mounting.
    fn ground(&mut self, task: &PairTask<'_>) -> Result<DisparityPlane, StereoError> {
        let of_frame = match &mut self.v_disparity {
            Some(v_disparity) => v_disparity.ground(task.left, task.right)?,
            None => None,
        };
        of_frame.or(task.ground).ok_or(StereoError::NoGround)
    }
}

impl PairMatcher for DoubleCorrelationMatcher {
    fn run(&mut self, task: PairTask<'_>) -> Result<Matching, StereoError> {
        let ground = self.ground(&task)?;
        let upright = Job::new(self.block, self.uniqueness_percent, task.left, task.right)?;
        let shape = upright.shape();
        let reach = self.reach(&ground, shape);
        self.shear.fill(task.right, &ground, reach);
        let settings = self.settings;
        let job = DoubleJob { upright, shear: &self.shear, ground, settings, reach };

        let (mut out, split) = recycled(task.recycled, shape);
        clear_border(&mut out, &job.upright);
        let (width, top) = (shape.width, self.block.radius());
        self.is_road.clear();
        self.is_road.resize(width * shape.height, false);
        let band_count = rayon::current_num_threads().clamp(1, job.upright.rows());
        let band_rows = job.upright.rows().div_ceil(band_count);
        self.bands.resize_with(band_count, Scratch::default);
        let classes = self.is_road[top * width..].par_chunks_mut(band_rows * width);
        bands(&mut out, &job.upright, band_rows)
            .into_par_iter()
            .zip(classes)
            .zip(&mut self.bands)
            .for_each(|((band, is_road), scratch)| match_rows(&job, band, is_road, scratch));
        let matches = out.into_matches(shape)?;
        let road = task.wanted.road.then(|| self.split(&matches.disparity, split, ground)).transpose()?;
        Ok(Matching { matches, volume: None, road })
    }
}

impl DoubleCorrelationMatcher {
    /// Road and obstacles apart, in the buffers of an earlier frame.
    fn split(
        &self,
        all: &Disparity,
        [mut road, mut obstacles]: [Vec<f32>; 2],
        ground: DisparityPlane,
    ) -> Result<RoadSplit, StereoError> {
        let (width, height) = (all.width(), all.height());
        road.resize(width * height, f32::NAN);
        obstacles.resize(width * height, f32::NAN);
        let pixels = all.values().iter().zip(&self.is_road);
        for ((road, obstacle), (&disparity, &is_road)) in road.iter_mut().zip(&mut obstacles).zip(pixels) {
            *road = if is_road { disparity } else { f32::NAN };
            *obstacle = if is_road { f32::NAN } else { disparity };
        }
        let (road, obstacles) =
            (Disparity::new(width, height, road)?, Disparity::new(width, height, obstacles)?);
        let tried = self.block.min_disparity..self.block.min_disparity + self.block.disparities;
        Ok(RoadSplit { road, obstacles, ground, tried })
    }
}

/// The buffers of an earlier frame: those of the matches, and those of road and obstacles.
fn recycled(earlier: Option<Matching>, shape: Shape) -> (Buffers, [Vec<f32>; 2]) {
    let Some(mut earlier) = earlier else { return (Buffers::new(shape, false, None), [vec![], vec![]]) };
    let split = earlier.road.take();
    let split = split
        .map_or_else(Default::default, |split| [split.road.into_values(), split.obstacles.into_values()]);
    (Buffers::new(shape, false, Some(earlier)), split)
}
