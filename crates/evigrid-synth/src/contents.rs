//! Things and shapes from their descriptions.

use std::path::Path;

use evigrid_core::{Pose, name_hint};
use nalgebra::{Isometry3, Translation3};
use toml::Spanned;

use crate::description::WorldSpec;
use crate::name::Name;
use crate::noise::hash;
use crate::number::vector;
use crate::object_spec::{ModelSpec, ObjectSpec, PartSpec};
use crate::shape_spec::{MAX_TRIANGLES, ShapeSpec};
use crate::thing::{Part, Thing};
use crate::{SynthError, angle};

/// No more shapes than this, to bound the memory.
const MAX_SHAPES: usize = 200_000;

/// All that stands in a world.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// The shapes.
    pub parts: Vec<Part>,
    /// The things that the shapes are parts of.
    pub things: Vec<Thing>,
}

impl Contents {
    /// All things and their shapes, repeated ones written out. A material index is the position of the name
    /// among the sorted names. Mesh files are looked for in `folder`.
    ///
    /// # Errors
    /// If a material, model or file is unknown or unsound (with its line in `text`), or there
    /// are no objects or far too many.
    pub fn new(spec: &WorldSpec, text: &str, folder: Option<&Path>) -> Result<Self, SynthError> {
        let mut builder = Builder { spec, text, folder, contents: Self::default() };
        let Sizes { shapes, triangles } = builder.sizes()?;
        if !(1..=MAX_SHAPES).contains(&shapes) {
            return Err(SynthError::value("object", "1 to 200000 shapes, repeated ones counted", shapes));
        }
        if triangles > MAX_TRIANGLES {
            let expected = format!("at most {MAX_TRIANGLES} triangles, repeated ones counted");
            return Err(SynthError::value("object", expected, triangles));
        }
        for object in &spec.object {
            builder.add(object)?;
        }
        Ok(builder.contents)
    }
}

/// How much there will be, repeated things counted.
struct Sizes {
    shapes: usize,
    triangles: usize,
}

/// Reads objects one after another.
struct Builder<'a> {
    spec: &'a WorldSpec,
    text: &'a str,
    folder: Option<&'a Path>,
    contents: Contents,
}

impl<'a> Builder<'a> {
    /// How many shapes and triangles there will be.
    fn sizes(&self) -> Result<Sizes, SynthError> {
        let mut sizes = Sizes { shapes: 0, triangles: 0 };
        let mut add = |copies: usize, shape: &ShapeSpec| {
            sizes.shapes = sizes.shapes.saturating_add(copies);
            sizes.triangles = sizes.triangles.saturating_add(copies.saturating_mul(shape.triangles()));
        };
        for object in self.spec.object.iter().map(Spanned::get_ref) {
            let copies = object.repeat.count.get();
            if let Some(shape) = &object.shape {
                add(copies, shape.get_ref());
            }
            if let Some(model) = &object.model {
                for part in &self.model(model)?.part {
                    add(copies.saturating_mul(part.repeat.count.get()), part.shape.get_ref());
                }
            }
        }
        Ok(sizes)
    }

    fn add(&mut self, object: &Spanned<ObjectSpec>) -> Result<(), SynthError> {
        let (line, object) = (object.span().start, object.get_ref());
        let (count, step) = (object.repeat.count.get(), vector(object.repeat.step_m));
        let rotation = angle::attitude(object.yaw_deg.0, object.pitch_deg.0, object.roll_deg.0);
        for i in 0..count {
            let offset = vector(object.centre_m) + step * i as f64;
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
        let (count, step) = (part.repeat.count.get(), vector(part.repeat.step_m));
        let rotation = angle::attitude(part.yaw_deg.0, part.pitch_deg.0, part.roll_deg.0);
        for i in 0..count {
            let centre = vector(part.centre_m) + step * i as f64;
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
