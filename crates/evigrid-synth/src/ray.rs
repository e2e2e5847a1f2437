//! Rays in the world and in the frame of a shape, and where they meet one.

use nalgebra::{Point3, Vector3};

/// A ray in the world; `direction` has length 1.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    pub origin: Point3<f64>,
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at this distance from the origin, metres.
    pub fn at(&self, range_m: f64) -> Point3<f64> {
        self.origin + self.direction * range_m
    }
}

/// A ray in the local frame of a shape; `direction` has length 1.
#[derive(Debug, Clone, Copy)]
pub struct LocalRay {
    pub origin: Vector3<f64>,
    pub direction: Vector3<f64>,
}

/// The place where a ray meets a shape: the way in if it starts outside, else the way out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Distance along the ray, metres, above 0.
    pub range_m: f64,
    /// Outward unit normal in the local frame.
    pub normal: Vector3<f64>,
}
