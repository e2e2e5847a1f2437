use nalgebra::Vector3;
use serde::Deserialize;

use crate::angle;
use crate::number::{Finite, Grey, NonNegative};

/// The light as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightSpec {
    /// Share of full light that reaches every surface.
    ambient: NonNegative,
    /// Share that the sun adds to a surface that faces it.
    sun: NonNegative,
    /// Where the sun stands, anticlockwise from the world's x axis.
    sun_azimuth_deg: Finite,
    /// How high the sun stands above the horizon.
    sun_elevation_deg: Finite,
    /// Whether shapes cast shadows.
    shadows: bool,
    /// Grey of the sky just above the horizon.
    sky_horizon_grey: Grey,
    /// Grey of the sky overhead.
    sky_zenith_grey: Grey,
}

/// Ambient light, one sun (Lambert's law), and a plain sky.
#[derive(Debug, Clone)]
pub struct Light {
    ambient: f64,
    sun: f64,
    /// Unit vector towards the sun.
    pub to_sun: Vector3<f64>,
    /// Whether shapes cast shadows.
    pub shadows: bool,
    sky_horizon: f64,
    sky_zenith: f64,
}

impl Light {
    /// The light that `spec` describes.
    pub fn new(spec: &LightSpec) -> Self {
        Self {
            ambient: spec.ambient.0,
            sun: spec.sun.0,
            to_sun: angle::direction(spec.sun_azimuth_deg.0, spec.sun_elevation_deg.0),
            shadows: spec.shadows,
            sky_horizon: spec.sky_horizon_grey.0,
            sky_zenith: spec.sky_zenith_grey.0,
        }
    }

    /// Cosine of the angle at which sunlight meets a surface, 0 if the surface faces away.
    pub fn sun_cosine(&self, normal: &Vector3<f64>) -> f64 {
        if self.sun > 0.0 { normal.dot(&self.to_sun).max(0.0) } else { 0.0 }
    }

    /// Share of full light on a surface that sunlight meets at this cosine (0 in the shade).
    pub fn strength(&self, sun_cosine: f64) -> f64 {
        self.ambient + self.sun * sun_cosine
    }

    /// Grey of the sky in a unit direction.
    pub fn sky(&self, direction: &Vector3<f64>) -> f32 {
        let height = direction.z.max(0.0);
        (self.sky_horizon + height * (self.sky_zenith - self.sky_horizon)) as f32
    }
}
