//! parry3d's bounding volume tree around leaves that are cast in double precision.
//!
//! Shapes meet rays by closed forms in double precision (`shape.rs`); triangle meshes have a tree of their
//! own (`mesh.rs`). The tree, in single precision, only decides which leaves are looked at. Its boxes are
//! wider than the leaves by more than its rounding, and of several leaves at the same place the one with the
//! lowest number counts; so neither the tree nor a guess nor the number of threads can change a pixel.

use std::cell::Cell;

use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::Ray;

use crate::ray::LocalRay;

/// A tree over numbered leaves. parry3d works in single precision, so the bounds are wider than the leaves by
/// more than its rounding; which leaf is met, and where, is decided in double precision alone.
#[derive(Clone)]
pub struct Tree {
    bvh: Bvh,
}

/// Margin of the bounds, metres, and relative to the largest coordinate.
const MARGIN: f64 = 1e-4;
const RELATIVE_MARGIN: f64 = 2e-6;

impl Tree {
    /// The tree over leaves with these lowest and highest coordinates, numbered from 0.
    pub fn new(bounds: impl Iterator<Item = [Vector3<f64>; 2]>) -> Self {
        let bounds: Vec<_> = bounds.collect();
        let extent = bounds.iter().flatten().fold(0.0_f64, |m, v| m.max(v.amax()));
        let margin = Vector3::repeat(MARGIN + RELATIVE_MARGIN * extent);
        let boxes: Vec<Aabb> =
            bounds.iter().map(|[low, high]| aabb(&(low - margin), &(high + margin))).collect();
        // A street's rays take a quarter less time with this strategy than with the default one.
        Self { bvh: Bvh::from_leaves(BvhBuildStrategy::Ploc, &boxes) }
    }

    /// The leaves whose bounds touch the box from `low` to `high`, in no particular order.
    pub fn near(&self, low: &Vector3<f64>, high: &Vector3<f64>) -> impl Iterator<Item = u32> {
        let query = aabb(low, high);
        self.bvh.leaves(move |node| node.aabb().intersects(&query))
    }

    /// The leaf that the ray meets first, and where, nearer than `max_m`; of leaves met at the same place the
    /// one of the lowest number. `meet` gives the distance to a leaf, or nothing if there is none below its
    /// second argument. A good `guess` shortens the search and changes nothing else.
    pub fn first(
        &self,
        ray: &LocalRay,
        max_m: f64,
        guess: Option<u32>,
        meet: impl Fn(u32, f64) -> Option<f64>,
    ) -> Option<(u32, f64)> {
        let best: Cell<Option<(u32, f64)>> = Cell::new(None);
        // Slightly farther than the best, so that a leaf at the same place is looked at too.
        let limit = || best.get().map_or(max_m, |(_, range_m)| range_m * (1.0 + f64::EPSILON));
        let test = |index: u32| {
            let range_m = meet(index, limit()).filter(|&r| r < max_m);
            let is_better = |r: f64| best.get().is_none_or(|(i, b)| r < b || (r == b && index < i));
            if let Some(range_m) = range_m.filter(|&r| is_better(r)) {
                best.set(Some((index, range_m)));
            }
        };
        guess.into_iter().for_each(test);
        let up = |range_m: f64| (range_m as f32).next_up();
        let leaf = |index: u32, _: f32| {
            if guess != Some(index) {
                test(index);
            }
            best.get().map(|(_, range_m)| up(range_m))
        };
        self.bvh.cast_ray(&in_parry(ray), up(limit().min(1e30)), leaf);
        best.get()
    }

    /// A leaf that `blocks` the ray, if there is one; the search ends at the
    /// first. `guess` is asked before all.
    pub fn any(
        &self,
        ray: &LocalRay,
        max_m: f64,
        guess: Option<u32>,
        blocks: impl Fn(u32) -> bool,
    ) -> Option<u32> {
        if let Some(index) = guess.filter(|&index| blocks(index)) {
            return Some(index);
        }
        // The lowest possible cost ends the search.
        let leaf = |index: u32, _: f32| blocks(index).then_some(f32::MIN);
        self.bvh.cast_ray(&in_parry(ray), max_m.min(1e30) as f32, leaf).map(|(index, _)| index)
    }
}

fn aabb(low: &Vector3<f64>, high: &Vector3<f64>) -> Aabb {
    Aabb::new(to_parry(low), to_parry(high))
}

fn in_parry(ray: &LocalRay) -> Ray {
    Ray::new(to_parry(&ray.origin), to_parry(&ray.direction))
}

/// A vector in single precision.
pub fn to_parry(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}
