use nalgebra::{Matrix3, Point3, Vector3};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::Ray as LocalRay;
use parry3d::shape::SharedShape;

use crate::material::Material;
use crate::noise::unit;

/// A half line in the world; `direction` has length 1.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: Point3<f64>,
    /// Where it goes.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at distance `range_m`.
    pub fn at(&self, range_m: f64) -> Point3<f64> {
        self.origin + self.direction * range_m
    }

    fn in_parry(&self) -> LocalRay {
        LocalRay::new(to_parry(&self.origin.coords), to_parry(&self.direction))
    }
}

/// A placed shape.
#[derive(Clone)]
pub struct Object {
    /// The shape in its local frame.
    pub shape: SharedShape,
    /// Where the local origin is, metres.
    pub centre: Point3<f64>,
    /// Takes world directions to local ones.
    pub local_from_world: Matrix3<f64>,
    /// Index into the scene's materials.
    pub material: usize,
    /// Seed of its texture.
    pub seed: u32,
}

impl Object {
    fn local_point(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.local_from_world * (point - self.centre)
    }

    /// The ray from its point at `start_m` on, in the local frame.
    fn local_ray(&self, ray: &Ray, start_m: f64) -> LocalRay {
        let origin = self.local_point(&ray.at(start_m));
        LocalRay::new(to_parry(&origin), to_parry(&(self.local_from_world * ray.direction)))
    }

    /// Distance at which the ray meets the object, to single precision.
    fn meets(&self, ray: &Ray, max: f32) -> Option<f32> {
        self.shape.cast_local_ray(&self.local_ray(ray, 0.0), max, false)
    }

    /// The box around the object in the world, 1 to 3 mm too large, so that rounding never cuts anything off. No two
    /// boxes are alike: building the tree from many equal ones, or equally spaced ones, would take quadratic time.
    fn bounds(&self) -> Aabb {
        let local = self.shape.compute_local_aabb();
        let half = from_parry(local.half_extents());
        let centre = self.centre + self.local_from_world.transpose() * from_parry(local.center());
        let margin = 1e-3 * (2.0 + f64::from(unit(self.seed)));
        let extent = self.local_from_world.transpose().abs() * half + Vector3::repeat(margin);
        Aabb::new(to_parry(&(centre.coords - extent)), to_parry(&(centre.coords + extent)))
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

/// All shapes of a world, ready for casting rays.
#[derive(Clone)]
pub struct Scene {
    objects: Vec<Object>,
    materials: Vec<Material>,
    tree: Bvh,
}

/// How far before the coarse hit the second cast starts, metres.
const RESTART_M: f64 = 0.05;

impl Scene {
    /// The scene of these objects, whose material indices point into `materials`.
    pub fn new(objects: Vec<Object>, materials: Vec<Material>) -> Self {
        let bounds: Vec<Aabb> = objects.iter().map(Object::bounds).collect();
        // A street's rays take a quarter less time with this strategy than with the default one.
        let tree = Bvh::from_leaves(BvhBuildStrategy::Ploc, &bounds);
        Self { objects, materials, tree }
    }

    /// An object by its index.
    pub fn object(&self, index: usize) -> &Object {
        &self.objects[index]
    }

    /// The material of an object.
    pub fn material(&self, object: &Object) -> &Material {
        &self.materials[object.material]
    }

    /// The first surface on the ray within `max_range_m`. Ranges are good to about a micrometre: parry finds the
    /// object in single precision, then the ray is cast once more from just before the surface.
    pub fn cast(&self, ray: &Ray, max_range_m: f64) -> Option<Hit> {
        let meet = |index: u32, limit: f32| self.objects[index as usize].meets(ray, limit);
        let (index, coarse_m) = self.tree.cast_ray(&ray.in_parry(), max_range_m as f32, meet)?;
        let (object, coarse_m) = (&self.objects[index as usize], f64::from(coarse_m));
        let start_m = (coarse_m - RESTART_M).max(0.0);
        let near = object.local_ray(ray, start_m);
        let again = object.shape.cast_local_ray_and_get_normal(&near, 2.0 * RESTART_M as f32, false);
        let (range_m, local_normal) = match again {
            Some(hit) => (start_m + f64::from(hit.time_of_impact), from_parry(hit.normal)),
            // The ray only just grazes the object.
            None => (coarse_m, -(object.local_from_world * ray.direction)),
        };
        let local_point = object.local_point(&ray.at(range_m));
        Some(Hit { range_m, object: index as usize, local_point, local_normal })
    }

    /// Whether anything stands on the ray within `max_range_m`.
    pub fn blocks(&self, ray: &Ray, max_range_m: f64) -> bool {
        let max = max_range_m as f32;
        // The lowest possible cost ends the search at the first object met.
        let any = |index: u32, _| self.objects[index as usize].meets(ray, max).map(|_| f32::MIN);
        self.tree.cast_ray(&ray.in_parry(), max, any).is_some()
    }

    /// An object that contains the point, if there is one.
    pub fn object_around(&self, point: &Point3<f64>) -> Option<usize> {
        let at = to_parry(&point.coords);
        let inside = |&index: &usize| {
            let object = &self.objects[index];
            object.shape.contains_local_point(to_parry(&object.local_point(point)))
        };
        self.tree.intersect_aabb(&Aabb::new(at, at)).map(|index| index as usize).find(inside)
    }
}

fn to_parry(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

fn from_parry(v: Vector) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{World, angle};

    /// Distance to a box by the slab method in double precision.
    fn range_to_box(object: &Object, ray: &Ray) -> Option<f64> {
        let half = from_parry(object.shape.as_cuboid()?.half_extents);
        let origin = object.local_point(&ray.origin);
        let direction = object.local_from_world * ray.direction;
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for a in 0..3 {
            let (p, q) = ((-half[a] - origin[a]) / direction[a], (half[a] - origin[a]) / direction[a]);
            (enter, leave) = (enter.max(p.min(q)), leave.min(p.max(q)));
        }
        (enter <= leave && enter > 0.0).then_some(enter)
    }

    #[test]
    fn the_tree_finds_what_a_loop_over_all_boxes_finds() {
        let scene = World::builtin("street").unwrap().scene;
        let mut met = 0;
        for i in 0..20_000 {
            // Directions all around, from one place on the road.
            let direction = angle::direction(f64::from(i) * 137.507, f64::from(i % 1000) * 0.06 - 30.0);
            let ray = Ray { origin: Point3::new(9.3, 0.2, 1.6137), direction };
            let slow = scene.objects.iter().filter_map(|o| range_to_box(o, &ray)).min_by(f64::total_cmp);
            let fast = scene.cast(&ray, 1e5).map(|hit| hit.range_m);
            let close = match (slow, fast) {
                (Some(slow), Some(fast)) => (slow - fast).abs() < 2e-6 * slow.max(1.0),
                (slow, fast) => slow.is_none() && fast.is_none(),
            };
            assert!(close, "ray {i}: {slow:?} {fast:?}");
            assert_eq!(scene.blocks(&ray, 1e5), slow.is_some(), "ray {i}");
            met += usize::from(slow.is_some());
        }
        assert!(met > 15_000, "{met}");
    }
}
