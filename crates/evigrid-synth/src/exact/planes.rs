//! The planes of the ground.

use evigrid_core::Pose;
use nalgebra::{Point3, Vector3};

use super::placed::{objects, slope_rad};
use crate::World;
use crate::scene::Object;
use crate::shape::Shape;
use crate::thing::Thing;

/// A plane face that a robot can drive on.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundPlane {
    /// The number of the `[[object]]`, copies counted.
    pub thing: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Upward unit normal in the map frame.
    pub normal: Vector3<f64>,
    /// normal . point of all its points in the map frame, metres.
    pub offset_m: f64,
    /// Its slope, degrees.
    pub slope_deg: f64,
    /// The corners of the rectangle that it fills (a box) or touches (a cylinder), one after another, in the
    /// map frame, metres.
    pub corners_m: [Point3<f64>; 4],
}

/// The upper faces of all things that are declared as ground, in the map frame;
/// one for each of a thing's shapes.
///
/// The upper face is that whose normal is nearest to the vertical: of a box one of its faces (so a
/// ramp's slope), of a cylinder a cap, if its axis is within 45 degrees of the vertical. Spheres have
/// no plane faces. Meshes and height fields are skipped, since a plane fitted to them is no exact
/// truth; so are things that move.
pub fn ground_planes(world: &World, map_from_world: &Pose) -> Vec<GroundPlane> {
    let wanted = |thing: &Thing| thing.is_ground && !thing.moves();
    let objects = objects(world, map_from_world, 0.0, wanted);
    objects.iter().filter_map(|object| plane(world, object)).collect()
}

fn plane(world: &World, object: &Object) -> Option<GroundPlane> {
    let half = match object.shape {
        Shape::Box { half } => half,
        Shape::Cylinder { radius, half_height } => Vector3::new(radius, radius, half_height),
        Shape::Sphere { .. } | Shape::Mesh(_) => return None,
    };
    // The rows are the shape's axes in the map frame.
    let axes = [0, 1, 2].map(|a| object.local_from_world.row(a).transpose());
    let upward = match object.shape {
        Shape::Cylinder { .. } if axes[2].z.abs() < std::f64::consts::FRAC_1_SQRT_2 => return None,
        Shape::Cylinder { .. } => 2,
        _ => (0..3).max_by(|&a, &b| axes[a].z.abs().total_cmp(&axes[b].z.abs()))?,
    };
    let normal = axes[upward] * axes[upward].z.signum();
    let centre = object.centre + normal * half[upward];
    let [u, v] = [1, 2].map(|next| (upward + next) % 3).map(|a| axes[a] * half[a]);
    Some(GroundPlane {
        thing: object.thing,
        name: world.contents.things[object.thing].name.clone(),
        normal,
        offset_m: normal.dot(&centre.coords),
        slope_deg: slope_rad(&normal).to_degrees(),
        corners_m: [centre - u - v, centre + u - v, centre + u + v, centre - u + v],
    })
}

#[cfg(test)]
#[path = "planes_tests.rs"]
mod tests;
