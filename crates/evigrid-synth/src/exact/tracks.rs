//! Where named things are.

use evigrid_core::Pose;
use nalgebra::{Point3, Vector3};

use crate::World;
use crate::thing::Thing;

/// The box around a named thing at a frame, in the map frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The number of the `[[object]]`, copies counted.
    pub thing: usize,
    /// Its name.
    pub name: String,
    /// The centre of the box, metres.
    pub centre_m: Point3<f64>,
    /// The turn of the box about the vertical, anticlockwise from the map's x axis, radians.
    pub yaw_rad: f64,
    /// Its lengths along the thing's own x, y and z axes, metres.
    pub lengths_m: Vector3<f64>,
    /// The velocity of the thing's origin, metres per second.
    pub velocity_mps: Vector3<f64>,
    /// Whether it moves at this frame.
    pub is_moving: bool,
    /// Whether it moves at any time.
    pub moves: bool,
}

/// All named things at a frame.
pub fn tracks(world: &World, map_from_world: &Pose, frame: usize) -> Vec<Track> {
    let time_s = world.time_s(frame);
    let things = world.contents.things.iter().enumerate();
    let named = things.filter_map(|(index, thing)| Some((index, thing, thing.name.clone()?)));
    let track = |(index, thing, name): (usize, &Thing, String)| {
        let map_from_thing = map_from_world * thing.world_from_thing(time_s);
        let [low, high] = thing.bounds;
        let front = map_from_thing.rotation * Vector3::x();
        let velocity_mps = map_from_world.rotation * thing.velocity_mps(time_s);
        Track {
            thing: index,
            name,
            centre_m: map_from_thing * Point3::from((low + high) * 0.5),
            yaw_rad: libm::atan2(front.y, front.x),
            lengths_m: high - low,
            velocity_mps,
            is_moving: velocity_mps != Vector3::zeros(),
            moves: thing.moves(),
        }
    };
    named.map(track).collect()
}

#[cfg(test)]
#[path = "tracks_tests.rs"]
mod tests;
