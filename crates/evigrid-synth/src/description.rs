//! The TOML of a world.

use std::collections::BTreeMap;

use evigrid_grid::{GridSettings, GridSpec};
use serde::Deserialize;
use toml::Spanned;

use crate::SynthError;
use crate::camera::StereoSpec;
use crate::hazard_spec::{HazardSpec, SafeAreaSpec};
use crate::laser::LaserSpec;
use crate::light::LightSpec;
use crate::material::MaterialSpec;
use crate::name::Name;
use crate::number::{Count, Positive};
use crate::object_spec::{ModelSpec, ObjectSpec};
use crate::reported_pose::PoseErrorSpec;
use crate::robot::RobotSpec;
use crate::trajectory::TrajectorySpec;

/// A whole world.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldSpec {
    /// Its name, used in tables and file names.
    pub name: Name,
    /// Seed of all random numbers and textures.
    pub seed: u32,
    /// How many frames there are.
    pub frames: Count,
    /// Frames per second.
    pub rate_hz: Positive,
    /// The drive.
    pub trajectory: TrajectorySpec,
    /// Errors of the poses that the robot reports; none if it is not given.
    #[serde(default)]
    pub reported_pose: PoseErrorSpec,
    /// The cameras.
    pub stereo: StereoSpec,
    /// The laser scanners.
    #[serde(default)]
    pub laser: Vec<LaserSpec>,
    /// The robot; needed for safety maps alone.
    pub robot: Option<RobotSpec>,
    /// Where the voxels and the ground plan of the exact truth on disk lie in the map frame; by default the
    /// grid that maps have.
    #[serde(default)]
    pub truth_grid: Option<Spanned<GridSettings>>,
    /// The light.
    pub light: LightSpec,
    /// The materials by their names.
    pub material: BTreeMap<String, MaterialSpec>,
    /// Things of several parts by their names.
    #[serde(default)]
    pub model: BTreeMap<String, ModelSpec>,
    /// The things and single shapes of the world.
    pub object: Vec<Spanned<ObjectSpec>>,
    /// Named places that are dangerous to the robot.
    #[serde(default)]
    pub hazard: Vec<HazardSpec>,
    /// Named places that the robot may drive on.
    #[serde(default)]
    pub safe_area: Vec<SafeAreaSpec>,
}

impl WorldSpec {
    /// Reads a world; `text` is only needed for messages afterwards.
    ///
    /// # Errors
    /// If the text is no TOML, or has unknown, missing or impossible keys; the message names the line.
    pub fn parse(text: &str) -> Result<Self, SynthError> {
        toml::from_str(text).map_err(|e| SynthError::from_parser(text, &e))
    }

    /// The grid of the exact truth.
    ///
    /// # Errors
    /// If it is empty or far too large.
    pub fn truth_grid(&self, text: &str) -> Result<GridSpec, SynthError> {
        let settings = self.truth_grid.as_ref();
        let grid = GridSpec::new(&settings.map(|grid| *grid.get_ref()).unwrap_or_default());
        let line = settings.map_or(0, |grid| grid.span().start);
        grid.map_err(|error| SynthError::at(text, line, &format!("truth_{error}")))
    }
}
