use parry3d::math::Vector;
use parry3d::shape::SharedShape;
use serde::Deserialize;

use crate::number::Positive;

/// A shape as a world describes it. More kinds need only another variant here: the rest works on any parry shape.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeSpec {
    /// A box with its faces across the local axes; `size_m` are its full lengths along x, y and z.
    Box { size_m: [Positive; 3] },
}

impl ShapeSpec {
    /// The shape, centred at the origin of its local frame.
    pub fn build(&self) -> SharedShape {
        match self {
            Self::Box { size_m } => {
                let [x, y, z] = size_m.map(|s| 0.5 * s.0 as f32);
                SharedShape::new(parry3d::shape::Cuboid::new(Vector::new(x, y, z)))
            }
        }
    }
}
