//! Things that stand or move in a world, and the shapes they are made of.

use std::ops::Range;

use evigrid_core::Pose;
use nalgebra::{Translation3, Vector3};
use serde::Deserialize;

use crate::SynthError;
use crate::number::{Finite, vector};
use crate::scene::Object;
use crate::shape::Shape;
use crate::trajectory::{Path, TrajectorySpec, WaypointSpec};

/// How a thing moves as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MotionSpec {
    /// Steadily, metres per second along the world's axes.
    VelocityMps([Finite; 3]),
    /// Along way-points, its front where it goes; the thing's centre and angles count from there.
    Path(Vec<WaypointSpec>),
}

#[derive(Debug, Clone)]
enum Motion {
    None,
    Steady(Vector3<f64>),
    Path(Box<Path>),
}

/// A thing of one or more shapes.
#[derive(Debug, Clone)]
pub struct Thing {
    /// Name in tables.
    pub name: Option<String>,
    /// Its upper face is ground to drive on.
    pub is_ground: bool,
    /// Its visible width is measured.
    pub is_board: bool,
    /// Its shapes.
    pub parts: Range<usize>,
    /// Lowest and highest coordinates in its own frame, metres.
    pub bounds: [Vector3<f64>; 2],
    at: Pose,
    motion: Motion,
}

/// A shape that is part of a thing.
#[derive(Debug, Clone)]
pub struct Part {
    pub shape: Shape,
    /// Index of the thing.
    pub thing: usize,
    pub thing_from_local: Pose,
    /// Index of its material.
    pub material: usize,
    /// Seed of its textures.
    pub seed: u32,
}

impl Thing {
    /// A thing of these `parts` of `all` at a place.
    ///
    /// # Errors
    /// If its path is impossible.
    pub fn new(
        name: Option<String>,
        at: Pose,
        motion: Option<&MotionSpec>,
        parts: Range<usize>,
        all: &[Part],
    ) -> Result<Self, SynthError> {
        let motion = match motion {
            None => Motion::None,
            Some(MotionSpec::VelocityMps(velocity)) => Motion::Steady(vector(*velocity)),
            Some(MotionSpec::Path(waypoints)) => {
                let spec = TrajectorySpec { waypoints: waypoints.clone(), look_at_m: None };
                Motion::Path(Box::new(Path::new(&spec, "motion.path")?))
            }
        };
        let bounds = all[parts.clone()].iter().map(|part| part.object(&Pose::identity()).bounds());
        let bounds = bounds.reduce(|[a, b], [c, d]| [a.inf(&c), b.sup(&d)]);
        let bounds = bounds.unwrap_or([Vector3::zeros(); 2]);
        Ok(Self { name, is_ground: false, is_board: false, parts, bounds, at, motion })
    }

    /// Whether it ever moves.
    pub fn moves(&self) -> bool {
        !matches!(self.motion, Motion::None)
    }

    /// Its pose at this time.
    pub fn world_from_thing(&self, time_s: f64) -> Pose {
        match &self.motion {
            Motion::None => self.at,
            Motion::Steady(velocity) => Translation3::from(velocity * time_s) * self.at,
            Motion::Path(path) => path.world_from_body(time_s) * self.at,
        }
    }

    /// Its velocity at this time, metres per second.
    pub fn velocity_mps(&self, time_s: f64) -> Vector3<f64> {
        match &self.motion {
            Motion::None => Vector3::zeros(),
            Motion::Steady(velocity) => *velocity,
            Motion::Path(path) => path.velocity_mps(time_s),
        }
    }
}

impl Part {
    /// The shape in its place, given that of its thing.
    pub fn object(&self, world_from_thing: &Pose) -> Object {
        let mut object = Object {
            shape: self.shape.clone(),
            centre: nalgebra::Point3::origin(),
            local_from_world: nalgebra::Matrix3::identity(),
            material: self.material,
            seed: self.seed,
            thing: self.thing,
        };
        object.place(&(world_from_thing * self.thing_from_local));
        object
    }
}
