//! Exact truth from the geometry of a world, not from its sensors.
//!
//! Everything is in the map frame (x forward, y left, z up, metres) that the given `map_from_world` leads to; see
//! `evigrid_replay::map_from_world`. Only `map_from_world`s that keep z up make sense of heights and slopes.

mod air;
mod boards;
mod cylinder;
mod ground;
mod planes;
mod safety;
mod segments;
mod touch;
mod tracks;
mod voxels;

use evigrid_core::Pose;
use nalgebra::Vector3;

use crate::World;
use crate::scene::Object;
use crate::thing::Thing;

pub use boards::{BoardView, boards};
pub use ground::{GroundColumn, GroundSurface, GroundTruth};
pub use planes::{GroundPlane, ground_planes};
pub use safety::{SafetyLabel, SafetySettings, SafetyTruth};
pub use tracks::{Track, tracks};
pub use voxels::{VoxelState, VoxelTruth};

/// The shapes of all things that `wanted` picks, in the map frame, as they stand at this time.
fn objects(
    world: &World,
    map_from_world: &Pose,
    time_s: f64,
    wanted: impl Fn(&Thing) -> bool,
) -> Vec<Object> {
    let contents = &world.contents;
    let placed = |thing: &Thing| {
        let map_from_thing = map_from_world * thing.world_from_thing(time_s);
        contents.parts[thing.parts.clone()].iter().map(move |part| part.object(&map_from_thing))
    };
    contents.things.iter().filter(|thing| wanted(thing)).flat_map(placed).collect()
}

/// The angle between a normal and the vertical, radians.
fn slope_rad(normal: &Vector3<f64>) -> f64 {
    libm::atan2(libm::hypot(normal.x, normal.y), normal.z)
}

#[cfg(test)]
mod fixtures;
