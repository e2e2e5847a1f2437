//! The exact view of the left camera.

use evigrid_core::{CoreError, Disparity, StereoRig};
use rayon::prelude::*;

use crate::World;
use crate::camera::Camera;
use crate::ray::Ray;
use crate::render::FAR_M;
use crate::scene::{Hint, Scene};
use crate::tiles::Tiles;

/// The exact answer for every pixel centre of a left image, row by row.
#[derive(Debug, Clone)]
pub struct LeftViewTruth {
    width: usize,
    height: usize,
    pixels: Vec<PixelTruth>,
}

/// The exact answer for one pixel centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelTruth {
    /// Depth along the optical axis, metres; infinite for the sky.
    pub depth_m: f64,
    /// Disparity, pixels; 0 for the sky.
    pub disparity_px: f32,
    /// The surface: the number of the shape and of its side; `None` for the sky.
    pub surface: Option<(u32, u32)>,
    /// The number of the `[[object]]`, copies counted; `None` for the sky.
    pub thing: Option<u32>,
    /// Whether the right camera sees the same point: it is in its image and nothing stands before it.
    pub seen_by_right: bool,
}

const SKY: PixelTruth = PixelTruth {
    depth_m: f64::INFINITY,
    disparity_px: 0.0,
    surface: None,
    thing: None,
    seen_by_right: false,
};

/// How much nearer than the point an obstacle must be to hide it from the right camera, metres and relative
/// to the distance: far more than rounding, far less than any shape.
const CLEARANCE: f64 = 1e-7;

impl LeftViewTruth {
    /// The view of the left camera at a frame.
    pub fn new(world: &World, frame: usize) -> Self {
        let pose = world.true_world_from_left(frame);
        let (scene, left) = (world.scene(frame), Camera::left(world.rig, &pose));
        let view = Pair {
            rig: world.rig,
            left,
            right: Camera::right(world.rig, &pose),
            scene: &scene,
            tiles: Tiles::new(&scene, &left),
        };
        let (width, height) = (world.rig.width, world.rig.height);
        let mut pixels = vec![SKY; width * height];
        pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            let (mut seen, mut hiding) = (Hint::default(), Hint::default());
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = view.pixel(x, y, &mut seen, &mut hiding);
            }
        });
        Self { width, height, pixels }
    }

    /// Width of the image, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height of the image, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The answer for each pixel, row by row.
    pub fn pixels(&self) -> &[PixelTruth] {
        &self.pixels
    }

    /// The disparity image: 0 for the sky, no invalid pixels.
    ///
    /// # Errors
    /// Never for a world that was built.
    pub fn disparity(&self) -> Result<Disparity, CoreError> {
        Disparity::new(self.width, self.height, self.pixels.iter().map(|p| p.disparity_px).collect())
    }
}

struct Pair<'a> {
    rig: StereoRig,
    left: Camera,
    right: Camera,
    scene: &'a Scene,
    tiles: Tiles,
}

impl Pair<'_> {
    /// The answer for the pixel (x, y). `seen` is the hint of its ray, `hiding` that of
    /// the ray from the right camera.
    fn pixel(&self, x: usize, y: usize, seen: &mut Hint, hiding: &mut Hint) -> PixelTruth {
        let candidates = self.tiles.around(x, y);
        let (x, y) = (x as f64, y as f64);
        let (ray, _) = self.left.ray(x, y);
        let Some(hit) = self.scene.cast_among(&ray, candidates, FAR_M, seen) else { return SKY };
        let object = self.scene.object(hit.object);
        let depth_m = hit.range_m / self.rig.ray(x, y).norm();
        let disparity = self.rig.disparity_px(depth_m);
        PixelTruth {
            depth_m,
            disparity_px: disparity as f32,
            surface: Some((
                hit.object as u32,
                object.shape.surface_point(&hit.local_point, &hit.local_normal).side,
            )),
            thing: Some(object.thing as u32),
            seen_by_right: self.in_right_image(x - disparity) && self.is_clear(&ray, hit.range_m, hiding),
        }
    }

    /// Whether a column of the right image exists, its pixels' full width counted.
    fn in_right_image(&self, x: f64) -> bool {
        x >= -0.5 && x <= self.rig.width as f64 - 0.5
    }

    /// Whether nothing stands between the right camera and the point at this range on the left ray.
    fn is_clear(&self, left: &Ray, range_m: f64, hint: &mut Hint) -> bool {
        let origin = self.right.position();
        let to_point = left.at(range_m) - origin;
        let distance = to_point.norm();
        let ray = Ray { origin, direction: to_point / distance };
        !self.scene.blocks(&ray, distance - CLEARANCE * distance.max(1.0), hint)
    }
}

#[cfg(test)]
#[path = "view_truth_tests.rs"]
mod tests;
