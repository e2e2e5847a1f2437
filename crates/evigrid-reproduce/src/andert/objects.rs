//! The objects in the test picture, and whether a map has them.

use evigrid_grid::LogOddsGrid;
use evigrid_synth::{LeftViewTruth, Track, tracks};

use super::scene::{CAMERA_M, RANGE_M, Scene};
use crate::chart::Point;

/// Cells so near the ground do not count, metres: the meadow is there too.
const FOOT_M: f64 = 0.5;

/// The posts, boxes and walls that the camera sees, each with the box around it; three of
/// the posts are hidden by others.
pub fn objects(scene: &Scene) -> Vec<Track> {
    let view = LeftViewTruth::new(&scene.world, 0);
    let is_seen = |object: &Track| view.pixels().iter().any(|p| p.thing == Some(object.thing as u32));
    let all = tracks(&scene.world, &scene.map_from_world, 0);
    all.into_iter().filter(|object| object.centre_m.x < RANGE_M && is_seen(object)).collect()
}

/// Whether a cell with log-odds above a limit lies within one cell of an object.
pub fn is_found(object: &Track, map: &LogOddsGrid, limit: f32) -> bool {
    let c = map.spec().cell_size_m();
    map.touched().filter(|(_, l)| *l > limit).any(|(flat, _)| {
        let [x, y, z] = map.spec().centre_m(flat);
        let (dx, dy) = (x - object.centre_m.x, y - object.centre_m.y);
        let (sin, cos) = object.yaw_rad.sin_cos();
        let along = [cos * dx + sin * dy, cos * dy - sin * dx, z - object.centre_m.z];
        let inside = |a: usize| along[a].abs() <= 0.5 * object.lengths_m[a] + c;
        z > FOOT_M - CAMERA_M && (0..3).all(inside)
    })
}

/// The corners of an object from above.
pub fn outline(object: &Track) -> Vec<Point> {
    let (sin, cos) = object.yaw_rad.sin_cos();
    let half = object.lengths_m * 0.5;
    let corner = |u: f64, v: f64| {
        let (u, v) = (u * half.x, v * half.y);
        (object.centre_m.x + cos * u - sin * v, object.centre_m.y + sin * u + cos * v)
    };
    vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
}
