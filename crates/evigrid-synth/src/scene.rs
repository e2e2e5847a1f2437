//! All shapes of a world in their places at one instant, ready for casting rays.

use evigrid_core::Pose;
use nalgebra::{Matrix3, Point3, Vector3};

use crate::ray::{Contact, LocalRay, Ray};
use crate::shape::Shape;
use crate::tree::Tree;

/// A shape in its place.
#[derive(Debug, Clone)]
pub struct Object {
    pub shape: Shape,
    /// Origin of the shape's frame, metres.
    pub centre: Point3<f64>,
    pub local_from_world: Matrix3<f64>,
    /// Index of its material.
    pub material: usize,
    /// Seed of its textures.
    pub seed: u32,
    /// Index of the thing of the world that it is part of.
    pub thing: usize,
}

impl Object {
    /// Puts the shape at another pose.
    pub fn place(&mut self, world_from_local: &Pose) {
        self.centre = world_from_local.translation.vector.into();
        self.local_from_world = world_from_local.rotation.to_rotation_matrix().into_inner().transpose();
    }

    /// A world point in the shape's frame.
    pub fn local_point(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.local_from_world * (point - self.centre)
    }

    /// A vector of the shape's frame in the world.
    pub fn in_world(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.local_from_world.tr_mul(local)
    }

    /// Whether the world point is inside.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.shape.contains(&self.local_point(point))
    }

    /// Lowest and highest coordinates in the world, metres.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let [low, high] = self.shape.bounds();
        let centre = self.centre.coords + self.in_world(&((low + high) * 0.5));
        let half = (high - low) * 0.5;
        let extent = self.local_from_world.transpose().abs() * half;
        [centre - extent, centre + extent]
    }

    fn local_ray(&self, ray: &Ray) -> LocalRay {
        LocalRay { origin: self.local_point(&ray.origin), direction: self.local_from_world * ray.direction }
    }

    fn meets(&self, ray: &Ray, max_m: f64) -> Option<f64> {
        self.shape.cast(&self.local_ray(ray), max_m).map(|contact| contact.range_m)
    }
}

/// Where a ray meets the scene.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Distance along the ray, metres.
    pub range_m: f64,
    /// Index of the object.
    pub object: usize,
    /// The point in the object's local frame, metres.
    pub local_point: Vector3<f64>,
    /// Outward unit normal in the object's local frame.
    pub local_normal: Vector3<f64>,
}

/// A shape that a bundle of rays may meet.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// Index of the object.
    pub object: u32,
    /// No ray of the bundle meets it nearer than this, metres.
    pub nearest_m: f64,
}

/// The objects that the last ray met. Neighbouring rays mostly meet the same ones, which shortens the search
/// for them; the answers do not depend on it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hint {
    seen: Option<u32>,
    blocker: Option<u32>,
}

/// All shapes of a world at one instant.
#[derive(Clone)]
pub struct Scene {
    objects: Vec<Object>,
    tree: Tree,
}

impl Scene {
    /// The scene of these objects.
    pub fn new(objects: Vec<Object>) -> Self {
        let tree = Tree::new(objects.iter().map(Object::bounds));
        Self { objects, tree }
    }

    /// An object by its index.
    pub fn object(&self, index: usize) -> &Object {
        &self.objects[index]
    }

    /// All objects.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The first surface on the ray within `max_range_m`; of several at the same place the one of the object
    /// with the lowest index.
    pub fn cast(&self, ray: &Ray, max_range_m: f64, hint: &mut Hint) -> Option<Hit> {
        let meet = |index: u32, limit_m| self.objects[index as usize].meets(ray, limit_m);
        let found = self.tree.first(&in_tree(ray), max_range_m, hint.seen, meet);
        hint.seen = found.map(|(index, _)| index);
        let (index, _) = found?;
        let object = &self.objects[index as usize];
        let contact = object.shape.cast(&object.local_ray(ray), f64::INFINITY)?;
        Some(self.hit(ray, index, &contact))
    }

    /// As [`Self::cast`], where the ray can meet these candidates alone, in order of their `nearest_m`.
    pub fn cast_among(
        &self,
        ray: &Ray,
        candidates: &[Candidate],
        max_range_m: f64,
        hint: &mut Hint,
    ) -> Option<Hit> {
        let mut best: Option<(u32, Contact)> = None;
        let mut test = |index: u32| {
            let object = &self.objects[index as usize];
            // Slightly farther than the best, so that a shape at the same place is looked at too.
            let limit_m = best.map_or(max_range_m, |(_, b)| b.range_m * (1.0 + f64::EPSILON));
            if let Some(contact) = object.shape.cast(&object.local_ray(ray), limit_m) {
                let r = contact.range_m;
                if best.is_none_or(|(i, b)| r < b.range_m || (r == b.range_m && index < i)) {
                    best = Some((index, contact));
                }
            }
            best.map_or(max_range_m, |(_, b)| b.range_m)
        };
        let mut reach_m = hint.seen.map_or(max_range_m, &mut test);
        for candidate in candidates {
            if candidate.nearest_m > reach_m {
                break;
            }
            if hint.seen != Some(candidate.object) {
                reach_m = test(candidate.object);
            }
        }
        hint.seen = best.map(|(index, _)| index);
        best.map(|(index, contact)| self.hit(ray, index, &contact))
    }

    fn hit(&self, ray: &Ray, index: u32, contact: &Contact) -> Hit {
        Hit {
            range_m: contact.range_m,
            object: index as usize,
            local_point: self.objects[index as usize].local_point(&ray.at(contact.range_m)),
            local_normal: contact.normal,
        }
    }

    /// Whether anything stands on the ray within `max_range_m`.
    pub fn blocks(&self, ray: &Ray, max_range_m: f64, hint: &mut Hint) -> bool {
        let blocks = |index: u32| self.objects[index as usize].meets(ray, max_range_m).is_some();
        let blocker = self.tree.any(&in_tree(ray), max_range_m, hint.blocker, blocks);
        if blocker.is_some() {
            hint.blocker = blocker;
        }
        blocker.is_some()
    }

    /// The objects whose bounds touch the box from `low` to `high`, in order of their indices.
    pub fn near(&self, low: &Vector3<f64>, high: &Vector3<f64>, found: &mut Vec<usize>) {
        found.clear();
        found.extend(self.tree.near(low, high).map(|index| index as usize));
        found.sort_unstable();
    }

    /// An object that contains the point, if there is one.
    pub fn object_around(&self, point: &Point3<f64>) -> Option<usize> {
        let candidates = self.tree.near(&point.coords, &point.coords);
        candidates.map(|index| index as usize).filter(|&index| self.objects[index].contains(point)).min()
    }
}

fn in_tree(ray: &Ray) -> LocalRay {
    LocalRay { origin: ray.origin.coords, direction: ray.direction }
}

#[cfg(test)]
#[path = "scene_tests.rs"]
mod tests;
