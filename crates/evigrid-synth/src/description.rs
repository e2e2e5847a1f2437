//! The TOML of a world.

use std::collections::BTreeMap;
use std::path::Path;

use evigrid_core::{Pose, name_hint};
use evigrid_grid::{GridSettings, GridSpec};
use nalgebra::{Isometry3, Translation3};
use serde::Deserialize;
use toml::Spanned;

use crate::camera::StereoSpec;
use crate::laser::LaserSpec;
use crate::light::LightSpec;
use crate::material::MaterialSpec;
use crate::noise::hash;
use crate::number::{Count, Finite, Positive, vector};
use crate::reported_pose::PoseErrorSpec;
use crate::robot::RobotSpec;
use crate::shape_spec::{MAX_TRIANGLES, ShapeSpec};
use crate::thing::{MotionSpec, Part, Thing};
use crate::trajectory::TrajectorySpec;
use crate::{SynthError, angle};

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
    /// What the robot can drive over; needed for safety maps alone.
    pub robot: Option<RobotSpec>,
    /// Where the voxels and the ground plan of the exact truth on disk lie in the map frame; by default the grid that
    /// maps have.
    #[serde(default)]
    pub truth_grid: Option<Spanned<GridSettings>>,
    /// The light.
    pub light: LightSpec,
    /// The materials by their names.
    pub material: BTreeMap<String, MaterialSpec>,
    /// Things of several parts by their names.
    #[serde(default)]
    pub model: BTreeMap<String, ModelSpec>,
    /// What stands in the world.
    pub object: Vec<Spanned<ObjectSpec>>,
}

/// A name that can be part of a file name.
#[derive(Debug, Clone, Deserialize)]
#[serde(try_from = "String")]
pub struct Name(pub String);

impl TryFrom<String> for Name {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if (1..=64).contains(&name.len()) && name.chars().all(allowed) {
            return Ok(Self(name));
        }
        Err(format!("expected 1 to 64 letters, digits, - and _, found {name:?}"))
    }
}

/// A thing of several parts.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSpec {
    part: Vec<PartSpec>,
}

/// A part of a model.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartSpec {
    shape: Spanned<ShapeSpec>,
    /// Its centre in the model's frame, metres.
    centre_m: [Finite; 3],
    #[serde(default)]
    yaw_deg: Finite,
    #[serde(default)]
    pitch_deg: Finite,
    #[serde(default)]
    roll_deg: Finite,
    material: Spanned<String>,
    repeat: Option<RepeatSpec>,
}

/// A shape or a model in the world, or a row of equal ones.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// What it is called in tables; copies get numbers.
    name: Option<Name>,
    /// Its form and size, if it is one shape.
    shape: Option<Spanned<ShapeSpec>>,
    /// Name of its material, if it is one shape.
    material: Option<Spanned<String>>,
    /// Name of the model, if it is one.
    model: Option<Spanned<String>>,
    /// Its centre (a model's origin) in the world, metres; of a thing that moves along a path, in the path's frame.
    centre_m: [Finite; 3],
    /// Its turn about the vertical, anticlockwise from above.
    #[serde(default)]
    yaw_deg: Finite,
    /// How far its front (x) is up.
    #[serde(default)]
    pitch_deg: Finite,
    /// How far its left side (y) is up.
    #[serde(default)]
    roll_deg: Finite,
    /// Copies of it in a row.
    repeat: Option<RepeatSpec>,
    /// How it moves; not at all if it is not given.
    motion: Option<MotionSpec>,
    /// Its upper face is ground to drive on: it gets a plane in the tables.
    #[serde(default)]
    ground: bool,
    /// Its visible width is measured in every frame.
    #[serde(default)]
    board: bool,
}

/// A row of equal shapes, each with a texture of its own.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RepeatSpec {
    /// How many there are in all.
    count: Count,
    /// From one to the next, metres.
    step_m: [Finite; 3],
}

impl RepeatSpec {
    fn of(repeat: Option<&Self>) -> (usize, [Finite; 3]) {
        repeat.map_or((1, [Finite(0.0); 3]), |r| (r.count.get(), r.step_m))
    }
}

/// No more shapes than this, to bound the memory.
const MAX_SHAPES: usize = 200_000;

/// What stands in a world.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// The shapes.
    pub parts: Vec<Part>,
    /// What they are parts of.
    pub things: Vec<Thing>,
}

/// Reads objects one after another.
struct Builder<'a> {
    spec: &'a WorldSpec,
    text: &'a str,
    folder: Option<&'a Path>,
    contents: Contents,
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

    /// All things and their shapes, repeated ones written out. A material index is the position of the name among
    /// the sorted names. Mesh files are looked for in `folder`.
    ///
    /// # Errors
    /// If a material, model or file is unknown or unsound (with its line in `text`), or there are no objects or far
    /// too many.
    pub fn contents(&self, text: &str, folder: Option<&Path>) -> Result<Contents, SynthError> {
        let mut builder = Builder { spec: self, text, folder, contents: Contents::default() };
        let [shapes, triangles] = builder.sizes()?;
        if !(1..=MAX_SHAPES).contains(&shapes) {
            return Err(SynthError::value("object", "1 to 200000 shapes, repeated ones counted", shapes));
        }
        if triangles > MAX_TRIANGLES {
            let expected = format!("at most {MAX_TRIANGLES} triangles, repeated ones counted");
            return Err(SynthError::value("object", expected, triangles));
        }
        for object in &self.object {
            builder.add(object)?;
        }
        Ok(builder.contents)
    }
}

impl<'a> Builder<'a> {
    /// How many shapes and triangles there will be.
    fn sizes(&self) -> Result<[usize; 2], SynthError> {
        let mut sizes = [0_usize; 2];
        let mut add = |copies: usize, shape: &ShapeSpec| {
            sizes[0] = sizes[0].saturating_add(copies);
            sizes[1] = sizes[1].saturating_add(copies.saturating_mul(shape.triangles()));
        };
        for object in self.spec.object.iter().map(Spanned::get_ref) {
            let (copies, _) = RepeatSpec::of(object.repeat.as_ref());
            if let Some(shape) = &object.shape {
                add(copies, shape.get_ref());
            }
            if let Some(model) = &object.model {
                for part in &self.model(model)?.part {
                    let (of_part, _) = RepeatSpec::of(part.repeat.as_ref());
                    add(copies.saturating_mul(of_part), part.shape.get_ref());
                }
            }
        }
        Ok(sizes)
    }

    fn add(&mut self, object: &Spanned<ObjectSpec>) -> Result<(), SynthError> {
        let (line, object) = (object.span().start, object.get_ref());
        let (count, step) = RepeatSpec::of(object.repeat.as_ref());
        let rotation = angle::attitude(object.yaw_deg.0, object.pitch_deg.0, object.roll_deg.0);
        for i in 0..count {
            let offset = vector(object.centre_m) + vector(step) * i as f64;
            let name = object.name.as_ref().map(|Name(name)| match count {
                1 => name.clone(),
                _ => format!("{name}-{}", i + 1),
            });
            let first_part = self.contents.parts.len();
            match (&object.shape, &object.material, &object.model) {
                (Some(shape), Some(material), None) => self.part(shape, material, Pose::identity())?,
                (None, None, Some(model)) => {
                    for part in &self.model(model)?.part {
                        self.parts(part)?;
                    }
                }
                _ => {
                    let reason = "expected either `shape` and `material`, or `model`";
                    return Err(SynthError::at(self.text, line, reason));
                }
            }
            let at = Isometry3::from_parts(Translation3::from(offset), rotation);
            let parts = first_part..self.contents.parts.len();
            let mut thing = Thing::new(name, at, object.motion.as_ref(), parts, &self.contents.parts)
                .map_err(|reason| SynthError::at(self.text, line, &reason.to_string()))?;
            (thing.is_ground, thing.is_board) = (object.ground, object.board);
            self.contents.things.push(thing);
        }
        Ok(())
    }

    fn parts(&mut self, part: &PartSpec) -> Result<(), SynthError> {
        let (count, step) = RepeatSpec::of(part.repeat.as_ref());
        let rotation = angle::attitude(part.yaw_deg.0, part.pitch_deg.0, part.roll_deg.0);
        for i in 0..count {
            let centre = vector(part.centre_m) + vector(step) * i as f64;
            let pose = Isometry3::from_parts(Translation3::from(centre), rotation);
            self.part(&part.shape, &part.material, pose)?;
        }
        Ok(())
    }

    /// Adds a shape; its texture seed comes from the world's seed and its number.
    fn part(
        &mut self,
        shape: &Spanned<ShapeSpec>,
        material: &Spanned<String>,
        pose: Pose,
    ) -> Result<(), SynthError> {
        let seed = hash(self.contents.parts.len() as u32, 1, self.spec.seed);
        let (built, thing_from_shape) = shape
            .get_ref()
            .build(seed, self.folder)
            .map_err(|reason| SynthError::at(self.text, shape.span().start, &reason))?;
        self.contents.parts.push(Part {
            shape: built,
            thing: self.contents.things.len(),
            thing_from_local: pose * thing_from_shape,
            material: self.material_index(material)?,
            seed,
        });
        Ok(())
    }

    fn material_index(&self, name: &Spanned<String>) -> Result<usize, SynthError> {
        let mut names = self.spec.material.keys();
        names
            .position(|known| known == name.get_ref())
            .ok_or_else(|| self.unknown("material", name, self.spec.material.keys()))
    }

    fn model(&self, name: &Spanned<String>) -> Result<&'a ModelSpec, SynthError> {
        let known = self.spec.model.get(name.get_ref());
        known.ok_or_else(|| self.unknown("model", name, self.spec.model.keys()))
    }

    fn unknown<'k>(
        &self,
        what: &str,
        name: &Spanned<String>,
        known: impl Iterator<Item = &'k String>,
    ) -> SynthError {
        let known: Vec<&str> = known.map(String::as_str).collect();
        let reason = match known[..] {
            [] => format!("unknown {what}, there are none"),
            _ => format!("unknown {what}{}", name_hint(name.get_ref(), known)),
        };
        SynthError::at(self.text, name.span().start, &reason)
    }
}
