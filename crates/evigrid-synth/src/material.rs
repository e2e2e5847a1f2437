use serde::Deserialize;

use crate::noise::{Footprint, FractalNoise};
use crate::number::{Grey, NonNegative, Octaves, Positive};
use crate::pattern::{Pattern, PatternSpec};

/// A material as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Mean grey in full light, 0 to 255.
    grey: Grey,
    /// Standard deviation of the noise over all octaves, grey levels; 0 for a perfectly plain surface.
    contrast: NonNegative,
    /// Cell size of the coarsest octave, metres.
    scale_m: Positive,
    /// Number of octaves, 1 to 16, each half as coarse as the one before.
    octaves: Octaves,
    /// Strength of an octave relative to the one before, without unit.
    #[serde(default = "default_roughness")]
    roughness: Positive,
    /// A pattern on top.
    pattern: Option<PatternSpec>,
}

fn default_roughness() -> Positive {
    Positive(0.7)
}

/// The look of a surface: its grey in full light as a function of surface coordinates.
#[derive(Debug, Clone)]
pub struct Material {
    grey: f32,
    contrast: f32,
    noise: FractalNoise,
    pattern: Option<Pattern>,
}

impl Material {
    /// The material that `spec` describes.
    pub fn new(spec: MaterialSpec) -> Self {
        Self {
            grey: spec.grey.0 as f32,
            contrast: spec.contrast.0 as f32,
            noise: FractalNoise::new(spec.scale_m.0, spec.octaves.0, spec.roughness.0),
            pattern: spec.pattern.map(Pattern::new),
        }
    }

    /// Mean grey of what a pixel with this footprint sees at the surface point (u,
    /// v), in full light; not bounded.
    pub fn grey(&self, point: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let texture = if self.contrast == 0.0 {
            0.0
        } else {
            self.contrast * self.noise.sample(point, footprint, seed)
        };
        let base = self.grey + texture;
        match &self.pattern {
            None => base,
            Some(pattern) => pattern.apply(base, texture, point, footprint, seed),
        }
    }
}

#[cfg(test)]
#[path = "material_tests.rs"]
mod tests;
