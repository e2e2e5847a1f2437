use std::ops::Range;

use evigrid_core::{Pose, StereoRig};
use nalgebra::{Matrix3, Vector3};

use crate::{GridSpec, cell_index};

/// The viewing rays of one frame's left camera. Places are in units of cells from the grid's lower corner
/// ([`GridSpec::to_cells`]), depths in metres, directions in cells per metre of depth, image points in
/// pixels. The geometry is that of every paper here (Andert 2009, eqs 1 to 3).
#[derive(Debug, Clone, Copy)]
pub struct ViewRays<'a> {
    /// The grid.
    pub spec: &'a GridSpec,
    /// The rig that took the pair.
    pub rig: &'a StereoRig,
    /// Depth at which every ray ends, metres.
    pub max_depth_m: f64,
    /// The camera's centre.
    pub origin: [f64; 3],
    /// The indices of the camera's cell, which may lie outside the grid.
    pub origin_cell: [i64; 3],
    /// Change of a ray's direction per column of the image.
    pub per_column: [f64; 3],
    /// Change of a ray's direction per row.
    pub per_row: [f64; 3],
    /// Direction of the ray of pixel (0, 0).
    pub first: [f64; 3],
}

impl<'a> ViewRays<'a> {
    /// The rays of a checked rig whose left camera stands at `map_from_left`, up to a depth in metres.
    pub fn new(spec: &'a GridSpec, rig: &'a StereoRig, map_from_left: &Pose, max_depth_m: f64) -> Self {
        let to_cells = |v: Vector3<f64>| (map_from_left.rotation * v / spec.cell_size_m()).into();
        let origin = spec.to_cells(map_from_left.translation.vector.into());
        Self {
            spec,
            rig,
            max_depth_m,
            origin,
            origin_cell: origin.map(cell_index),
            per_column: to_cells(Vector3::x() / rig.focal_px),
            per_row: to_cells(Vector3::y() / rig.focal_px),
            first: to_cells(rig.ray(0.0, 0.0)),
        }
    }

    /// Direction of the ray through an image point.
    #[inline(always)]
    pub fn direction(&self, x: f64, y: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.first[a] + self.per_column[a] * x + self.per_row[a] * y)
    }

    /// The point of a ray at a depth.
    #[inline(always)]
    pub fn at_depth(&self, direction: &[f64; 3], depth_m: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.origin[a] + depth_m * direction[a])
    }

    /// How many faces a ray crosses from the camera's cell to another: none twice, and so as many as the
    /// indices of the two cells differ.
    #[inline]
    pub fn steps_to(&self, cell: &[i64; 3]) -> i32 {
        let steps: u64 = (0..3).map(|a| cell[a].abs_diff(self.origin_cell[a])).sum();
        steps.min(i32::MAX as u64) as i32
    }

    /// The matrix that takes a place relative to the camera to (x z, y z, z): image point (x, y), depth z in
    /// metres.
    pub fn projection(&self) -> Matrix3<f64> {
        let columns = [self.per_column, self.per_row, self.first].map(Vector3::from);
        // A place is z (first + x per_column + y per_row). The three are independent: focal length and cell
        // size are positive.
        Matrix3::from_columns(&columns).try_inverse().unwrap_or_else(Matrix3::zeros)
    }

    /// Indices from..to per axis of the aligned box around the camera and the four corner pixels at the
    /// greatest depth (Andert 2009, section V-B, step 1), which holds all rays; parts of it may lie outside
    /// the grid.
    pub fn sensor_box(&self) -> [Range<i64>; 3] {
        let (right, bottom) = ((self.rig.width - 1) as f64, (self.rig.height - 1) as f64);
        let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
        let ends = corners.map(|(x, y)| self.at_depth(&self.direction(x, y), self.max_depth_m));
        std::array::from_fn(|a| {
            let along = |pick: fn(f64, f64) -> f64| ends.iter().map(|p| p[a]).fold(self.origin[a], pick);
            cell_index(along(f64::min))..cell_index(along(f64::max)).saturating_add(1)
        })
    }

    /// The part of the sensor's box that lies in the grid.
    pub fn box_in_grid(&self) -> [Range<usize>; 3] {
        let (whole, shape) = (self.sensor_box(), self.spec.shape());
        std::array::from_fn(|a| {
            let within = |v: i64| v.clamp(0, shape[a] as i64) as usize;
            within(whole[a].start)..within(whole[a].end)
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::GridSettings;
    use nalgebra::{Point3, UnitQuaternion};
    use proptest::prelude::*;

    const RIG: StereoRig = StereoRig {
        width: 21,
        height: 15,
        focal_px: 18.0,
        centre_x_px: 10.3,
        centre_y_px: 6.8,
        baseline_m: 0.5,
    };

    proptest! {
        /// A point goes out along its pixel's ray and comes back by the projection; every ray stays in the
        /// box.
        #[test]
        fn rays_by_the_pose_alone(
            at in [-3.0..9.0_f64, -3.0..3.0, -2.0..2.0],
            turn in [-3.0..3.0_f64, -1.5..1.5, -3.0..3.0],
            (x, y, depth) in (0..21_usize, 0..15_usize, 0.1..8.0_f64),
        ) {
            let settings =
                GridSettings { x_m: [-1.0, 11.0], y_m: [-3.0, 3.0], z_m: [-2.0, 2.0], cell_size_m: 0.4 };
            let spec = GridSpec::new(&settings).unwrap();
            let turn = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
            let pose = Pose::from_parts(Vector3::from(at).into(), turn);
            let rays = ViewRays::new(&spec, &RIG, &pose, 8.0);
            let (x, y) = (x as f64, y as f64);
            let expected = spec.to_cells((pose * Point3::from(RIG.ray(x, y) * depth)).into());
            let found = rays.at_depth(&rays.direction(x, y), depth);
            let back = rays.projection() * (Vector3::from(found) - Vector3::from(rays.origin));
            prop_assert!((Vector3::from(found) - Vector3::from(expected)).norm() < 1e-9);
            prop_assert!((back - Vector3::new(x * depth, y * depth, depth)).norm() < 1e-9);
            let cell = found.map(cell_index);
            prop_assert!((0..3).all(|a| rays.sensor_box()[a].contains(&cell[a])));
            let inside = spec.flat(cell).is_some();
            prop_assert_eq!(inside, (0..3).all(|a| {
                usize::try_from(cell[a]).is_ok_and(|v| rays.box_in_grid()[a].contains(&v))
            }));
        }
    }
}
