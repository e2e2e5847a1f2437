//! Objects and models as a world describes them.

use serde::Deserialize;
use toml::Spanned;

use crate::name::Name;
use crate::number::{Count, Finite};
use crate::shape_spec::ShapeSpec;
use crate::thing::MotionSpec;

/// A thing of several parts.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSpec {
    pub part: Vec<PartSpec>,
}

/// A part of a model.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartSpec {
    pub shape: Spanned<ShapeSpec>,
    /// Its centre in the model's frame, metres.
    pub centre_m: [Finite; 3],
    #[serde(default)]
    pub yaw_deg: Finite,
    #[serde(default)]
    pub pitch_deg: Finite,
    #[serde(default)]
    pub roll_deg: Finite,
    pub material: Spanned<String>,
    #[serde(default)]
    pub repeat: RepeatSpec,
}

/// A shape or a model in the world, or a row of equal ones.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Name in tables; copies get numbers.
    pub name: Option<Name>,
    /// Its form and size, if it is one shape.
    pub shape: Option<Spanned<ShapeSpec>>,
    /// Name of its material, if it is one shape.
    pub material: Option<Spanned<String>>,
    /// Name of the model, if it is one.
    pub model: Option<Spanned<String>>,
    /// Its centre (a model's origin) in the world, metres; of a thing that moves
    /// along a path, in the path's frame.
    pub centre_m: [Finite; 3],
    /// Its turn about the vertical, anticlockwise from above.
    #[serde(default)]
    pub yaw_deg: Finite,
    /// How far its front (x) is up.
    #[serde(default)]
    pub pitch_deg: Finite,
    /// How far its left side (y) is up.
    #[serde(default)]
    pub roll_deg: Finite,
    /// Copies of it in a row.
    #[serde(default)]
    pub repeat: RepeatSpec,
    /// How it moves; not at all if it is not given.
    pub motion: Option<MotionSpec>,
    /// Its upper face is ground to drive on: it gets a plane in the tables.
    #[serde(default)]
    pub ground: bool,
    /// Its visible width is measured in every frame.
    #[serde(default)]
    pub board: bool,
}

/// A row of equal shapes, each with a texture of its own.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RepeatSpec {
    /// How many there are in all.
    pub count: Count,
    /// From one to the next, metres.
    pub step_m: [Finite; 3],
}

/// A single one.
impl Default for RepeatSpec {
    fn default() -> Self {
        Self { count: Count(1), step_m: [Finite(0.0); 3] }
    }
}
