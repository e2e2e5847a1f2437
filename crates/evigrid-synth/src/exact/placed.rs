//! The shapes of a world in the map frame.

use evigrid_core::Pose;
use nalgebra::Vector3;

use crate::World;
use crate::scene::Object;
use crate::thing::Thing;

/// The shapes of all things that `wanted` picks, in the map frame, as they stand at this time.
pub fn objects(
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
pub fn slope_rad(normal: &Vector3<f64>) -> f64 {
    libm::atan2(libm::hypot(normal.x, normal.y), normal.z)
}
