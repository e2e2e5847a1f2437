//! Images of a scene: one ray through every pixel centre, and two more where neighbouring pixels see
//! different surfaces.
//!
//! Grey levels are functions of surface coordinates, filtered with the footprint of the pixel, so that both
//! cameras see the same grey at a point. The primary rays of a camera look among the shapes of their tile
//! (`tiles.rs`). Rays towards the sun use the tree of the scene (`tree.rs`), with the shape that shaded the
//! ray before as a first guess; a grid of shadow casters across the sunlight was no faster.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::camera::Camera;
use crate::light::Light;
use crate::material::Material;
use crate::noise::{Footprint, hash};
use crate::ray::Ray;
use crate::scene::{Candidate, Hint, Hit, Scene};
use crate::shape::SurfacePoint;
use crate::tiles::Tiles;

/// Beyond this the renderer sees sky, metres.
pub const FAR_M: f64 = 1e5;

/// How far off a surface its shadow ray starts, metres.
const SHADOW_OFFSET_M: f64 = 1e-3;

/// The key of the sky, which no surface has.
const SKY: u32 = u32::MAX;

/// Sub-pixel positions of the rays that a pixel at an edge gets beside the one through its centre. Together
/// they cut the pixel in thirds both across and along.
const EDGE_RAYS: [f64; 2] = [-1.0 / 3.0, 1.0 / 3.0];

/// Edges between surfaces whose grey differs by less than this need no more rays, grey levels.
const EDGE_CONTRAST: f32 = 10.0;

/// The light along one ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Grey level, not bounded.
    pub grey: f32,
    /// Equal for two rays exactly if they see the same side of the same object in the same light.
    key: u32,
}

/// A scene, its materials and its light, ready to be seen.
pub struct Renderer<'a> {
    scene: &'a Scene,
    materials: &'a [Material],
    light: &'a Light,
}

impl<'a> Renderer<'a> {
    /// A renderer of this scene.
    pub fn new(scene: &'a Scene, materials: &'a [Material], light: &'a Light) -> Self {
        Self { scene, materials, light }
    }

    /// The noise-free image of a camera: grey levels, row by row, not bounded.
    pub fn image(&self, camera: &Camera) -> Vec<f32> {
        let (width, _) = camera.size();
        let tiles = Tiles::new(self.scene, camera);
        let samples = self.centres(camera, &tiles);
        let mut image = vec![0.0; samples.len()];
        image.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            let mut hint = Hint::default();
            for (x, grey) in row.iter_mut().enumerate() {
                *grey = samples[y * width + x].grey;
                if is_edge(&samples, width, x, y) {
                    let candidates = tiles.around(x, y);
                    *grey = self.mean_with_edge_rays(camera, x, y, *grey, candidates, &mut hint);
                }
            }
        });
        image
    }

    /// Samples at the pixel centres, row by row.
    fn centres(&self, camera: &Camera, tiles: &Tiles) -> Vec<Sample> {
        let (width, height) = camera.size();
        let mut samples = vec![Sample { grey: 0.0, key: SKY }; width * height];
        samples.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            let mut hint = Hint::default();
            for (x, sample) in row.iter_mut().enumerate() {
                *sample = self.sample(camera, x as f64, y as f64, tiles.around(x, y), &mut hint);
            }
        });
        samples
    }

    /// Mean grey of a pixel at an edge, given that of its centre.
    fn mean_with_edge_rays(
        &self,
        camera: &Camera,
        x: usize,
        y: usize,
        centre: f32,
        candidates: &[Candidate],
        hint: &mut Hint,
    ) -> f32 {
        // Each part is as bright as a camera can show, so that the sky does not shine through a pole.
        let bounded = |grey: f32| grey.clamp(0.0, 255.0);
        let off_centre =
            |d: f64| bounded(self.sample(camera, x as f64 + d, y as f64 + d, candidates, hint).grey);
        let sum: f32 = EDGE_RAYS.into_iter().map(off_centre).sum();
        (bounded(centre) + sum) / 3.0
    }

    /// The sample at the image point (x, y) of a camera, pixels, which sees none but the candidates.
    pub fn sample(
        &self,
        camera: &Camera,
        x: f64,
        y: f64,
        candidates: &[Candidate],
        hint: &mut Hint,
    ) -> Sample {
        let (ray, width_per_metre) = camera.ray(x, y);
        match self.scene.cast_among(&ray, candidates, FAR_M, hint) {
            None => Sample { grey: self.light.sky(&ray.direction), key: SKY },
            Some(hit) => self.shade(&ray, &hit, width_per_metre, hint),
        }
    }

    fn shade(&self, ray: &Ray, hit: &Hit, width_per_metre: f64, hint: &mut Hint) -> Sample {
        let object = self.scene.object(hit.object);
        let surface = object.shape.surface_point(&hit.local_point, &hit.local_normal);
        let local_direction = object.local_from_world * ray.direction;
        let footprint = footprint(&surface, hit, &local_direction, hit.range_m * width_per_metre);
        let seed = hash(surface.side, 0, object.seed);
        let full = self.materials[object.material].grey(surface.uv, &footprint, seed);
        let cosine = self.sunlight(&ray.at(hit.range_m), &object.in_world(&hit.local_normal), hint);
        let key = (hit.object as u32) << 4 | surface.side << 1 | u32::from(cosine > 0.0);
        Sample { grey: full * self.light.strength(cosine) as f32, key }
    }

    /// Cosine at which sunlight meets a surface point; 0 in the shade.
    fn sunlight(&self, point: &Point3<f64>, normal: &Vector3<f64>, hint: &mut Hint) -> f64 {
        let cosine = self.light.sun_cosine(normal);
        if cosine == 0.0 || !self.light.shadows {
            return cosine;
        }
        let ray = Ray { origin: point + normal * SHADOW_OFFSET_M, direction: self.light.to_sun };
        if self.scene.blocks(&ray, FAR_M, hint) { 0.0 } else { cosine }
    }
}

/// Whether a pixel sees another surface, of clearly another grey, than one of its four neighbours.
fn is_edge(samples: &[Sample], width: usize, x: usize, y: usize) -> bool {
    let at = y * width + x;
    let Sample { grey, key } = samples[at];
    let differs = |other: usize| {
        samples.get(other).is_some_and(|s| s.key != key && (s.grey - grey).abs() > EDGE_CONTRAST)
    };
    (x > 0 && differs(at - 1))
        || (x + 1 < width && differs(at + 1))
        || (y > 0 && differs(at - width))
        || differs(at + width)
}

/// Footprint of a pixel `width_m` wide on a surface. Along the slant its length is width / cos(angle of
/// view); the part beyond the width is width * tan, hence the span below.
fn footprint(surface: &SurfacePoint, hit: &Hit, local_direction: &Vector3<f64>, width_m: f64) -> Footprint {
    let along_normal = local_direction.dot(&hit.local_normal);
    let tangential = local_direction - hit.local_normal * along_normal;
    let span = tangential * (width_m / along_normal.abs().max(1e-4));
    Footprint { width_m, span_m: surface.tangents.map(|tangent| span.dot(&tangent)) }
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
