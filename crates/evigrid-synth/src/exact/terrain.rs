//! Heights and slopes of the ground.

use evigrid_core::Pose;
use evigrid_grid::GridSpec;
use evigrid_grid::safe_ground::Surface;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::placed::objects;
use crate::ray::Ray;
use crate::scene::{Hint, Scene};
use crate::{SynthError, World};

/// The things on a place of the ground, as far as they concern the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GroundColumn {
    /// No surface below the robot's height.
    Empty,
    /// A solid reaches higher than the robot.
    Filled {
        /// The number of the `[[object]]`, copies counted.
        thing: usize,
    },
    /// The highest surface below the robot's height.
    Surface(GroundSurface),
}

/// A surface at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundSurface {
    /// Its height in the map frame, metres.
    pub height_m: f64,
    /// Its upward unit normal in the map frame.
    pub normal: Vector3<f64>,
    /// The number of the `[[object]]`, copies counted.
    pub thing: usize,
}

impl GroundSurface {
    /// The angle between the surface and a level one, radians.
    pub fn slope_rad(&self) -> f64 {
        self.surface().slope_rad()
    }

    /// The surface alone.
    pub fn surface(&self) -> Surface {
        Surface { height_m: self.height_m, normal: self.normal }
    }
}

/// True height and slope of the ground at the centre of every cell (i, j) of a grid's ground plan.
///
/// The height is that of the highest surface below the robot's height above the ground on which it stands at
/// the first frame (the "column height" of Murarka and Kuipers 2009, with real surfaces). Things that move at
/// any time are no ground and are left out.
#[derive(Debug, Clone)]
pub struct TerrainTruth {
    spec: GridSpec,
    columns: Vec<GroundColumn>,
}

impl TerrainTruth {
    /// The truth for the cells of `spec`, whose heights do not matter, and a
    /// robot that starts at `first_frame`.
    ///
    /// # Errors
    /// If the world says nothing of the robot, or nothing is below the robot or
    /// something is in it at that frame.
    pub fn new(
        world: &World,
        spec: GridSpec,
        map_from_world: &Pose,
        first_frame: usize,
    ) -> Result<Self, SynthError> {
        let probe = Probe::new(world, map_from_world, first_frame)?;
        let [nx, ny, _] = spec.shape();
        let row = |i: usize| (0..ny).map(move |j| [i, j]);
        let cells: Vec<[usize; 2]> = (0..nx).flat_map(row).collect();
        let column = |&cell: &[usize; 2]| probe.column(cell_point(&spec, cell, [0.5, 0.5]));
        Ok(Self { columns: cells.par_iter().with_min_len(256).map(column).collect(), spec })
    }

    /// The grid's geometry; only x and y matter.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The column on each cell (i, j); its place in the list is i * ny + j.
    pub fn columns(&self) -> &[GroundColumn] {
        &self.columns
    }

    /// The height of each cell in the map frame, metres; NaN where there is no surface below the robot's
    /// height or a solid reaches higher.
    pub fn heights_m(&self) -> Vec<f32> {
        self.of_surfaces(|surface| surface.height_m)
    }

    /// The slope of each cell, degrees; NaN where there is no height.
    pub fn slopes_deg(&self) -> Vec<f32> {
        self.of_surfaces(|surface| surface.slope_rad().to_degrees())
    }

    fn of_surfaces(&self, value: impl Fn(&GroundSurface) -> f64) -> Vec<f32> {
        let value = |column: &GroundColumn| match column {
            GroundColumn::Surface(surface) => value(surface) as f32,
            GroundColumn::Empty | GroundColumn::Filled { .. } => f32::NAN,
        };
        self.columns.iter().map(value).collect()
    }
}

/// The point of a cell at these shares of its edges, metres.
pub fn cell_point(spec: &GridSpec, [i, j]: [usize; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    let (origin, c) = (spec.origin_m(), spec.cell_size_m());
    [origin[0] + (i as f64 + x) * c, origin[1] + (j as f64 + y) * c]
}

/// Looks straight down from the robot's height.
pub struct Probe {
    scene: Scene,
    top_m: f64,
    /// Where the robot stands, in the map frame.
    pub robot_m: [f64; 2],
}

impl Probe {
    /// A probe for the robot at a frame.
    ///
    /// # Errors
    /// As [`TerrainTruth::new`].
    pub fn new(world: &World, map_from_world: &Pose, frame: usize) -> Result<Self, SynthError> {
        let Some(robot) = &world.robot else {
            let expected = "a table [robot], which ground and safety truth are relative to";
            return Err(SynthError::value("robot", expected, "none"));
        };
        let scene = Scene::new(objects(world, map_from_world, 0.0, |thing| !thing.moves()));
        let body = (map_from_world * world.world_from_body(world.time_s(frame))).translation;
        let mut probe = Self { scene, top_m: body.z + robot.height_m(), robot_m: [body.x, body.y] };
        let bad = |found: &str| {
            let expected = format!("ground below the robot at frame {frame} and room for its height");
            SynthError::value("robot.height_m", expected, found)
        };
        match probe.column(probe.robot_m) {
            GroundColumn::Surface(surface) => probe.top_m = surface.height_m + robot.height_m(),
            GroundColumn::Empty => return Err(bad("no ground")),
            GroundColumn::Filled { .. } => return Err(bad("a solid around its top")),
        }
        Ok(probe)
    }

    /// The column on this place of the map frame.
    pub fn column(&self, [x, y]: [f64; 2]) -> GroundColumn {
        let origin = Point3::new(x, y, self.top_m);
        if let Some(object) = self.scene.object_around(&origin) {
            return GroundColumn::Filled { thing: self.scene.object(object).thing };
        }
        let down = Ray { origin, direction: -Vector3::z() };
        match self.scene.cast(&down, f64::INFINITY, &mut Hint::default()) {
            None => GroundColumn::Empty,
            Some(hit) => {
                let object = self.scene.object(hit.object);
                GroundColumn::Surface(GroundSurface {
                    height_m: self.top_m - hit.range_m,
                    normal: object.in_world(&hit.local_normal),
                    thing: object.thing,
                })
            }
        }
    }
}

#[cfg(test)]
#[path = "terrain_tests.rs"]
mod tests;
