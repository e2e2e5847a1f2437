//! Where a frame's camera stands in the grid.

use std::ops::Range;

use evigrid_core::{Pose, StereoRig};
use evigrid_grid::{GridSpec, cell_index};
use nalgebra::{Matrix3, Vector3};

/// What all rays of one frame have in common. Places are in units of cells from the grid's lower corner
/// ([`GridSpec::to_cells`]), depths in metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Camera<'a> {
    pub spec: &'a GridSpec,
    pub rig: &'a StereoRig,
    /// Depth at which the sensor's range ends, metres.
    pub max_depth_m: f64,
    /// The camera's centre, t of eq. 3.
    pub origin: [f64; 3],
    /// The indices of its cell, which may lie outside the grid.
    pub origin_cell: [i64; 3],
    /// Change of the ray (scaled to depth 1) per column and per row, and the ray of pixel (0, 0): eqs 2 and 3.
    per_column: [f64; 3],
    per_row: [f64; 3],
    first: [f64; 3],
}

impl<'a> Camera<'a> {
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

    /// The ray through an image point, cells per metre of depth.
    #[inline(always)]
    pub fn direction(&self, x: f64, y: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.first[a] + self.per_column[a] * x + self.per_row[a] * y)
    }

    /// The point of a ray at a depth: p_g of eq. 3.
    #[inline(always)]
    pub fn at_depth(&self, direction: &[f64; 3], depth_m: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.origin[a] + depth_m * direction[a])
    }

    /// The matrix that takes a place relative to the camera to (x z, y z, z): image point (x, y), depth z in metres.
    pub fn projection(&self) -> Matrix3<f64> {
        let columns = [self.per_column, self.per_row, self.first].map(Vector3::from);
        // The three are independent: focal length and cell size are positive.
        Matrix3::from_columns(&columns).try_inverse().unwrap_or_else(Matrix3::zeros)
    }

    /// Indices from..to per axis of the aligned box around the camera and the four corner pixels at the range limit
    /// (section V-B, step 1); parts of it may lie outside the grid.
    pub fn sensor_box(&self) -> [Range<i64>; 3] {
        let (right, bottom) = ((self.rig.width - 1) as f64, (self.rig.height - 1) as f64);
        let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
        let ends = corners.map(|(x, y)| self.at_depth(&self.direction(x, y), self.max_depth_m));
        std::array::from_fn(|a| {
            let along = |pick: fn(f64, f64) -> f64| ends.iter().map(|p| p[a]).fold(self.origin[a], pick);
            cell_index(along(f64::min))..cell_index(along(f64::max)) + 1
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
