//! The shapes that each part of an image can see, nearest first.
//!
//! Neighbouring pixels of a camera see nearly the same few shapes, so that looking them up once per
//! tile is faster than asking a tree for every ray, which took about half of the time of an image.
//! Rays of lasers and of shadows, and those of the right camera to points that the left one sees,
//! share no such tile and use the tree.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::scene::{Candidate, Object, Scene};

/// Edge of a tile, pixels.
const TILE: usize = 16;

/// Rays may leave a tile by this much, pixels.
const REACH_PX: f64 = 0.5;

/// The candidates of every tile of an image.
pub struct Tiles {
    columns: usize,
    lists: Vec<Vec<Candidate>>,
}

/// The bounds of an object in camera axes: a box of any orientation.
struct Bounds {
    candidate: Candidate,
    centre: Vector3<f64>,
    half_axes: [Vector3<f64>; 3],
}

impl Bounds {
    /// The largest value of `normal` . p over the box.
    fn highest(&self, normal: &Vector3<f64>) -> f64 {
        normal.dot(&self.centre) + self.half_axes.iter().map(|axis| normal.dot(axis).abs()).sum::<f64>()
    }
}

impl Tiles {
    /// The tiles of what this camera sees of the scene.
    pub fn new(scene: &Scene, camera: &Camera) -> Self {
        let (width, height) = camera.size();
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let all = bounds(scene, camera);
        let lists = (0..rows).into_par_iter().flat_map_iter(|row| {
            let band = planes(camera, 1, row * TILE, ((row + 1) * TILE).min(height));
            let in_band: Vec<&Bounds> = all.iter().filter(|b| reaches(b, &band)).collect();
            (0..columns).map(move |column| {
                let sides = planes(camera, 0, column * TILE, ((column + 1) * TILE).min(width));
                let mut list: Vec<Candidate> =
                    in_band.iter().filter(|b| reaches(b, &sides)).map(|b| b.candidate).collect();
                list.sort_unstable_by(|a, b| {
                    a.nearest_m.total_cmp(&b.nearest_m).then(a.object.cmp(&b.object))
                });
                list
            })
        });
        Self { columns, lists: lists.collect() }
    }

    /// The shapes that rays within half a pixel of the pixel (x, y) can meet, nearest first.
    pub fn around(&self, x: usize, y: usize) -> &[Candidate] {
        &self.lists[y / TILE * self.columns + x / TILE]
    }
}

/// The objects that are not wholly behind the camera.
fn bounds(scene: &Scene, camera: &Camera) -> Vec<Bounds> {
    let camera_from_world = camera.world_from_camera().inverse();
    let rotation = camera_from_world.rotation.to_rotation_matrix();
    let of_object = |(index, object): (usize, &Object)| {
        let [low, high] = object.shape.bounds();
        let axes = rotation.matrix() * object.local_from_world.transpose();
        let half = (high - low) * 0.5;
        let half_axes = [0, 1, 2].map(|a| axes.column(a) * half[a]);
        let centre = camera_from_world * (object.centre + object.in_world(&((low + high) * 0.5)));
        let mut bounds = Bounds {
            candidate: Candidate { object: index as u32, nearest_m: 0.0 },
            centre: centre.coords,
            half_axes,
        };
        let nearest = -bounds.highest(&-Vector3::z());
        // Wider by more than rounding.
        bounds.candidate.nearest_m = (nearest - 1e-9 * centre.coords.amax().max(1.0)).max(0.0);
        (bounds.highest(&Vector3::z()) > 0.0).then_some(bounds)
    };
    scene.objects().iter().enumerate().filter_map(of_object).collect()
}

/// The two planes through the camera that bound the pixels `from..to` of a tile along image axis 0 (x) or 1
/// (y): inward normals in camera axes.
fn planes(camera: &Camera, axis: usize, from: usize, to: usize) -> [Vector3<f64>; 2] {
    let slope = |pixel: f64| camera.rig_ray(pixel)[axis];
    let (low, high) = (slope(from as f64 - REACH_PX), slope(to as f64 - 1.0 + REACH_PX));
    let mut normals = [Vector3::new(0.0, 0.0, -low), Vector3::new(0.0, 0.0, high)];
    normals[0][axis] = 1.0;
    normals[1][axis] = -1.0;
    normals
}

fn reaches(bounds: &Bounds, planes: &[Vector3<f64>; 2]) -> bool {
    let rounding = 1e-9 * bounds.centre.amax().max(1.0);
    planes.iter().all(|normal| bounds.highest(normal) > -rounding)
}
