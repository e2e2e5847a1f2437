//! What a perfect matcher would see in a world.

use anyhow::{Context, Result};
use evigrid_core::GroundPlane;
use evigrid_eval::Recording;
use evigrid_synth::{LeftViewTruth, World};
use evigrid_udisparity::{LevelView, Parameters, Pixels, UDisparityGrid};

/// Disparities of the grid: 1 to this.
pub const DISPARITIES: usize = 64;
/// Surfaces nearer to the ground are road, metres.
const ROAD_WITHIN_M: f64 = 0.15;
/// The paper's parameters (6.1), and its largest height, metres.
pub const PAPER: Parameters =
    Parameters { false_positive: 0.02, false_negative: 0.02, tau_obstacle: 0.1, tau_road: 0.1 };
pub const TOP_M: f64 = 1.8;

/// A frame of a world.
pub struct Scene {
    pub pixels: Pixels,
    pub view: LevelView,
}

impl Scene {
    /// True disparities, rounded to whole ones (halves up); what is beyond [`DISPARITIES`] is left out.
    pub fn new(name: &str, frame: usize) -> Result<Self> {
        let world = World::builtin(name)?;
        let info = Recording::from(world.clone()).sequence().info().clone();
        let mounting = info.mounting.context("a world whose camera stands nowhere")?;
        let (ground, rig) = (GroundPlane::below(&mounting), info.rig);
        let truth = LeftViewTruth::new(&world, frame);
        let mut pixels = Pixels { width: truth.width(), height: truth.height(), ..Pixels::default() };
        for (n, pixel) in truth.pixels().iter().enumerate() {
            let ray = rig.ray((n % pixels.width) as f64, (n / pixels.width) as f64);
            let is_road = ground.height_of_m(&(ray * pixel.depth_m)).abs() < ROAD_WITHIN_M;
            let whole = (pixel.disparity_px + 0.5).floor() as usize;
            let whole = if whole <= DISPARITIES { whole as u16 } else { 0 };
            pixels.obstacles.push(if is_road { 0 } else { whole });
            pixels.road.push(if is_road { whole } else { 0 });
        }
        Ok(Self { pixels, view: LevelView::new(&rig, &ground.disparities(&rig))? })
    }

    /// The grid of the frame.
    pub fn grid(&self, parameters: Parameters) -> UDisparityGrid {
        let mut grid = UDisparityGrid::new(&self.view, TOP_M, DISPARITIES, parameters, false);
        grid.fill(&self.pixels);
        grid
    }
}
