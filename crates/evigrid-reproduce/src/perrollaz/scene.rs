//! A drive through a world with the paper's matcher and both grids.

use anyhow::{Context, Result};
use evigrid_core::{Frame, View};
use evigrid_eval::{Config, MatchSource};
use evigrid_grid::{GridSettings, GridSpec, Mapper, PlanGrid, PlanSpec};
use evigrid_stereo::{GroundSource, MatcherKind};
use evigrid_truth::{LaserPlan, PlanBand};
use evigrid_udisparity::{Visibility, VisibilityFilteredSettings, VisibilitySettings};

use crate::murarka::mapping::Drive;

/// 20 m x 20 m ahead in cells of 0.2 m (6.1). The height of the grid does not matter.
const GRID: GridSettings =
    GridSettings { x_m: [0.0, 20.0], y_m: [-10.0, 10.0], z_m: [-2.0, 1.0], cell_size_m: 0.2 };
/// Obstacles of the laser's plan, metres over the ground.
const BAND_M: [f64; 2] = [0.3, 1.8];

/// Settings of the paper's camera: disparities 0 to 64.
pub fn config(ground: GroundSource) -> Config {
    let mut config = Config { grid: GRID, ..Config::default() };
    config.stereo.matcher = MatcherKind::DoubleCorrelation;
    config.stereo.disparities = super::exact::DISPARITIES + 1;
    config.stereo.double_correlation.ground = ground;
    config
}

/// The grids of a drive in the making.
pub struct Grids {
    pub drive: Drive,
    source: MatchSource,
    pub plain: Visibility,
    pub filtered: Visibility,
}

/// One frame of it.
pub struct Seen<'a> {
    pub drive: &'a Drive,
    pub frame: &'a Frame,
    pub plain: &'a Visibility,
    pub filtered: &'a Visibility,
}

impl Grids {
    /// Before the first frame; the plain grid with these settings.
    pub fn new(world: &str, settings: VisibilitySettings) -> Result<Self> {
        Self::with_filter(world, settings, VisibilityFilteredSettings::default().0)
    }

    /// The same, with these settings for the filtered grid.
    pub fn with_filter(world: &str, plain: VisibilitySettings, filtered: VisibilitySettings) -> Result<Self> {
        let drive = Drive::new(world)?;
        let config = config(GroundSource::Mounting);
        let spec = GridSpec::new(&config.grid)?;
        Ok(Self {
            source: MatchSource::new(&config, Some(drive.mounting), Some(&drive.world))?,
            plain: Visibility::new(spec, plain)?,
            filtered: Visibility::new(spec, filtered)?,
            drive,
        })
    }

    /// Adds a frame and shows what came of it.
    pub fn add(&mut self, index: usize, look: &mut dyn FnMut(&Seen<'_>) -> Result<()>) -> Result<()> {
        let frame = self.drive.frame(index)?;
        let matching = self.source.run(&frame, <Visibility as evigrid_grid::Method>::NEEDS)?;
        let view = View::new(&frame, Some(self.drive.mounting), &matching);
        self.plain.integrate(&view)?;
        self.filtered.integrate(&view)?;
        let (drive, plain, filtered) = (&self.drive, &self.plain, &self.filtered);
        look(&Seen { drive, frame: &frame, plain, filtered })?;
        self.source.recycle(matching);
        Ok(())
    }
}

impl Seen<'_> {
    /// The plan of a grid, with its cells where they are in the map.
    pub fn plan(map: &Visibility) -> Result<(PlanGrid, PlanSpec)> {
        let plan = map.layers().iter().find_map(|layer| layer.plan().cloned()).context("no plan")?;
        let moved = plan.map_from_plan().translation.vector;
        let cells = [moved.x, moved.y].map(|m| (m / plan.spec().cell_size_m()).round() as i64);
        let spec = plan.spec().moved(cells);
        Ok((plan, spec))
    }

    /// What the lasers of the frame say of the same cells; nothing without a scan.
    pub fn laser(&self, spec: PlanSpec) -> Option<LaserPlan> {
        let ground_m = self.frame.map_from_left().translation.z - self.drive.mounting.height_m;
        let band = PlanBand { ground_m, band_m: BAND_M, min_range_m: 1.0 };
        Some(LaserPlan::of(self.frame.laser()?, spec, &band))
    }
}
