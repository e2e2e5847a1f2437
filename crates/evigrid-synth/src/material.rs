use serde::Deserialize;

use crate::noise::{Footprint, FractalNoise};
use crate::number::{Grey, NonNegative, Octaves, Positive};
use crate::pattern::Pattern;

/// A material as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Mean grey in full light.
    grey: Grey,
    /// Standard deviation of the noise over all octaves, grey levels.
    contrast: NonNegative,
    /// Cell size of the coarsest octave, metres.
    scale_m: Positive,
    /// Number of octaves, each half as coarse as the one before.
    octaves: Octaves,
    /// Strength of an octave relative to the one before.
    #[serde(default = "default_roughness")]
    roughness: Positive,
    /// A regular pattern on top.
    pattern: Option<Pattern>,
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
            pattern: spec.pattern,
        }
    }

    /// Mean grey of what a pixel with this footprint sees at the surface point (u, v), in full light; not bounded.
    pub fn grey(&self, point: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let base = self.grey + self.contrast * self.noise.sample(point, footprint, seed);
        match &self.pattern {
            None => base,
            Some(pattern) => pattern.apply(base, point, footprint, seed),
        }
    }
}
