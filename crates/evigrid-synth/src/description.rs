//! The TOML of a world.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use crate::camera::StereoSpec;
use crate::laser::LaserSpec;
use crate::light::LightSpec;
use crate::material::MaterialSpec;
use crate::noise::hash;
use crate::number::{Count, Finite, Positive, plain};
use crate::scene::Object;
use crate::shape::ShapeSpec;
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
    /// The cameras.
    pub stereo: StereoSpec,
    /// The laser scanner, if there is one.
    pub laser: Option<LaserSpec>,
    /// The light.
    pub light: LightSpec,
    /// The materials by their names.
    pub material: BTreeMap<String, MaterialSpec>,
    /// The shapes.
    pub object: Vec<ObjectSpec>,
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

/// One shape, or a row of equal ones.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Its form and size.
    shape: ShapeSpec,
    /// Its centre in the world, metres.
    centre_m: [Finite; 3],
    /// Its turn about the vertical, anticlockwise from above.
    #[serde(default = "no_turn")]
    yaw_deg: Finite,
    /// Name of its material.
    material: Spanned<String>,
    /// Copies of it in a row.
    repeat: Option<RepeatSpec>,
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

fn no_turn() -> Finite {
    Finite(0.0)
}

/// No more objects than this, to bound the memory.
const MAX_OBJECTS: usize = 200_000;

impl WorldSpec {
    /// Reads a world; `text` is only needed for messages afterwards.
    ///
    /// # Errors
    /// If the text is no TOML, or has unknown, missing or impossible keys; the message names the line.
    pub fn parse(text: &str) -> Result<Self, SynthError> {
        toml::from_str(text).map_err(|e| SynthError::from_parser(text, &e))
    }

    /// All shapes in their places, repeated ones written out. A material index is the position of the name among
    /// the sorted names.
    ///
    /// # Errors
    /// If a material is unknown (with its line in `text`), or there are no objects or far too many.
    pub fn objects(&self, text: &str) -> Result<Vec<Object>, SynthError> {
        let counts = self.object.iter().map(|o| o.repeat.as_ref().map_or(1, |r| r.count.get()));
        let total: usize = counts.sum();
        if !(1..=MAX_OBJECTS).contains(&total) {
            return Err(SynthError::value("object", "1 to 200000 objects, repeated ones counted", total));
        }
        let mut objects = Vec::with_capacity(total);
        for spec in &self.object {
            let material = self.material_index(&spec.material, text)?;
            spec.place(material, self.seed, &mut objects);
        }
        Ok(objects)
    }

    fn material_index(&self, name: &Spanned<String>, text: &str) -> Result<usize, SynthError> {
        self.material.keys().position(|known| known == name.get_ref()).ok_or_else(|| {
            let known = self.material.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
            let reason = format!("unknown material, expected one of {known}");
            SynthError::at(text, name.span().start, &reason)
        })
    }
}

impl ObjectSpec {
    /// Adds the object and its copies; the texture seed comes from the world's seed and the object's number.
    fn place(&self, material: usize, seed: u32, objects: &mut Vec<Object>) {
        let shape = self.shape.build();
        let world_from_local = angle::yaw(self.yaw_deg.0).to_rotation_matrix().into_inner();
        let (count, step) = self.repeat.as_ref().map_or((1, [0.0; 3]), |r| (r.count.get(), plain(r.step_m)));
        for i in 0..count {
            let offset = Vector3::from(step) * i as f64;
            objects.push(Object {
                shape: shape.clone(),
                centre: Point3::from(plain(self.centre_m)) + offset,
                local_from_world: world_from_local.transpose(),
                material,
                seed: hash(objects.len() as u32, 1, seed),
            });
        }
    }
}
