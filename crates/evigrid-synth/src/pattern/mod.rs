//! Regular patterns over surface coordinates, filtered with the pixel's footprint.

use serde::Deserialize;

use crate::noise::Footprint;
use crate::number::{Grey, Positive};
use area::mix;
use brick::Brick;
use grass::{Grass, GrassSpec};
use interval::Interval;
use road::{Road, RoadSpec};

mod area;
mod brick;
mod grass;
mod interval;
mod road;

/// A surface coordinate. On upright faces u runs level and v up; on level faces
/// u is the shape's x and v its y.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Level.
    U,
    /// Upright, or the shape's y on level faces.
    V,
}

/// A pattern on top of a material's noise.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum PatternSpec {
    /// Stripes across one coordinate.
    Stripes(Stripes),
    /// Squares of two greys by turns.
    Checks(Checks),
    /// Bricks or slabs with joints.
    Brick(Brick),
    /// Blades and tufts of grass.
    Grass(GrassSpec),
    /// The markings of a road.
    Road(RoadSpec),
}

/// Stripes across one coordinate.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stripes {
    /// The coordinate along which the stripes follow each other, "u" or "v".
    along: Axis,
    /// From one stripe to the next, metres. One stripe begins at 0.
    period_m: Positive,
    /// Width of a stripe, metres.
    width_m: Positive,
    /// Grey of the stripes, 0 to 255 in full light.
    grey: Grey,
}

/// Squares of two greys by turns.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checks {
    /// Side of a square, metres. A corner is at (0, 0).
    size_m: Positive,
    /// Grey of every second square, 0 to 255 in full light; the others have the material's own.
    grey: Grey,
}

/// A pattern that is ready to be seen.
#[derive(Debug, Clone)]
pub enum Pattern {
    /// Stripes across one coordinate.
    Stripes(Stripes),
    /// Squares of two greys by turns.
    Checks(Checks),
    /// Bricks or slabs with joints.
    Brick(Brick),
    /// Blades and tufts of grass.
    Grass(Grass),
    /// The markings of a road.
    Road(Road),
}

impl Pattern {
    /// The pattern that `spec` describes.
    pub fn new(spec: PatternSpec) -> Self {
        match spec {
            PatternSpec::Stripes(stripes) => Self::Stripes(stripes),
            PatternSpec::Checks(checks) => Self::Checks(checks),
            PatternSpec::Brick(brick) => Self::Brick(brick),
            PatternSpec::Grass(spec) => Self::Grass(Grass::new(spec)),
            PatternSpec::Road(spec) => Self::Road(Road::new(&spec)),
        }
    }

    /// The grey at (u, v) of a surface that would have grey `base` without the pattern; `texture` is the part
    /// of `base` that varies over the surface.
    pub fn apply(&self, base: f32, texture: f32, point: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        match self {
            Self::Stripes(stripes) => stripes.apply(base, footprint.area(point)),
            Self::Checks(checks) => checks.apply(base, footprint.area(point)),
            Self::Brick(brick) => brick.apply(base, footprint.area(point), seed),
            Self::Grass(grass) => base + grass.sample(point, footprint, seed),
            Self::Road(road) => road.apply(base, texture, point, footprint, seed),
        }
    }
}

impl Stripes {
    fn apply(&self, base: f32, [u, v]: [Interval; 2]) -> f32 {
        let x = if self.along == Axis::U { u } else { v }.at_most(self.period_m.0);
        mix(base, self.grey, x.covered(0.0, self.period_m.0, self.width_m.0) / x.length())
    }
}

impl Checks {
    fn apply(&self, base: f32, area: [Interval; 2]) -> f32 {
        let size = self.size_m.0;
        let sign = |x: Interval| 2.0 * x.covered(0.0, 2.0 * size, size) / x.length() - 1.0;
        let [u, v] = area.map(|x| sign(x.at_most(2.0 * size)));
        mix(base, self.grey, 0.5 + 0.5 * u * v)
    }
}

#[cfg(test)]
mod tests;
