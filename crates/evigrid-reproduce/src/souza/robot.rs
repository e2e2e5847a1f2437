//! The robot's drives through a corridor and a yard.

use anyhow::Result;
use evigrid_eval::{Config, Mapped};
use evigrid_grid::LogOddsGrid;
use evigrid_metrics::{Counts, VoxelReference, count};

use super::matchers::Matcher;

/// Frames that are used: all 170 take long, and neighbours are 0.1 m apart.
pub const FRAMES: &str = "0..170";
pub const STRIDE: usize = 4;
/// Cells that a wall is not lost in, and how far a camera pair of 6 cm is of use, metres.
pub const CELL_M: f64 = 0.1;
const DEPTH_M: f64 = 10.0;

/// A drive.
#[derive(Debug, Clone, Copy)]
pub struct Drive {
    /// World with exact poses, and with those of odometry.
    pub exact: &'static str,
    pub odometry: &'static str,
    /// Half the width of the grid, metres.
    pub half_m: f64,
}

pub const DRIVES: [Drive; 2] = [
    Drive { exact: "corridor", odometry: "corridor-odometry", half_m: 4.0 },
    Drive { exact: "yard", odometry: "yard-odometry", half_m: 8.0 },
];

impl Drive {
    /// The settings that all runs on it have in common: a grid from the floor to above the lights.
    pub fn config(&self, matcher: &Matcher, sets: &[String]) -> Result<Config> {
        let half = self.half_m;
        let base = [
            "grid.x_m=[0, 24]".to_owned(),
            format!("grid.y_m=[-{half}, {half}]"),
            // The camera is 0.5 m above the floor: a border of cells lies on either.
            "grid.z_m=[-0.7, 2.5]".to_owned(),
            format!("grid.cell_size_m={CELL_M}"),
            format!("run.frames={FRAMES}"),
            format!("run.stride={STRIDE}"),
            format!("souza.max_depth_m={DEPTH_M}"),
        ];
        let matcher = matcher.sets.iter().map(|&set| set.to_owned());
        let sets: Vec<String> = base.into_iter().chain(matcher).chain(sets.iter().cloned()).collect();
        let mut config = Config::load(None, &sets)?;
        config.run.methods = vec!["souza".to_owned()];
        Ok(config)
    }
}

/// The laser's reference of a drive, kept for other maps in the same frame.
#[derive(Debug, Clone)]
pub struct Surfaces {
    pub occupied: Vec<bool>,
    pub observed: Vec<bool>,
}

impl Surfaces {
    /// Of the drive that a map was made on, if it has a laser.
    pub fn of(mapped: &Mapped<'_>) -> Option<Self> {
        let truth = mapped.truth.voxels()?;
        Some(Self { occupied: truth.occupied.to_vec(), observed: truth.observed.to_vec() })
    }

    /// Scores of the cells with log-odds above 0.
    pub fn counts(&self, map: &LogOddsGrid) -> Counts {
        let (spec, occupied, observed) = (map.spec(), &self.occupied[..], &self.observed[..]);
        count(map.values(), &VoxelReference { spec, occupied, observed, in_view: None })
    }
}
