//! The viewing rays of one frame, in units of cells.

use evigrid_core::{Pose, StereoRig};
use evigrid_grid::{GridSpec, cell_index};
use nalgebra::{Matrix3, Vector3};

/// What all viewing rays of one frame have in common. Places are in units of cells from the grid's lower corner
/// ([`GridSpec::to_cells`]), depths in metres.
#[derive(Debug, Clone)]
pub(crate) struct Rays<'a> {
    pub spec: &'a GridSpec,
    pub rig: &'a StereoRig,
    /// Depth at which every ray ends, metres.
    pub max_depth_m: f64,
    /// The camera.
    pub origin: [f64; 3],
    /// The indices of the camera's cell, which may lie outside the grid.
    pub origin_cell: [i64; 3],
    /// Change of the viewing ray (scaled to depth 1) per column and per row, and the ray of pixel (0, 0).
    pub per_column: [f64; 3],
    pub per_row: [f64; 3],
    pub first: [f64; 3],
}

impl<'a> Rays<'a> {
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

    /// The ray of a pixel, cells per metre of depth.
    #[inline]
    pub fn direction(&self, x: f64, y: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.first[a] + self.per_column[a] * x + self.per_row[a] * y)
    }

    /// The point of a ray at a depth.
    #[inline]
    pub fn at_depth(&self, direction: &[f64; 3], depth_m: f64) -> [f64; 3] {
        std::array::from_fn(|a| self.origin[a] + depth_m * direction[a])
    }

    /// How many faces a ray crosses from the camera's cell to another: none twice, and so as many as the indices of the
    /// two cells differ.
    #[inline]
    pub fn steps_to(&self, cell: &[i64; 3]) -> i32 {
        let steps: u64 = (0..3).map(|a| cell[a].abs_diff(self.origin_cell[a])).sum();
        steps.min(i32::MAX as u64) as i32
    }

    /// The matrix that takes a place relative to the camera to (u z, v z, z): pixel (u, v), depth z in metres.
    pub fn projection(&self) -> Matrix3<f64> {
        let columns = [self.per_column, self.per_row, self.first].map(Vector3::from);
        // A place is z (first + u per_column + v per_row). The three are independent: focal length and cell size
        // are positive.
        Matrix3::from_columns(&columns).try_inverse().unwrap_or_else(Matrix3::zeros)
    }

    /// The cells of the grid, from..to per axis, that hold all rays up to their greatest depth.
    pub fn bounds(&self) -> [std::ops::Range<usize>; 3] {
        let (right, bottom) = ((self.rig.width - 1) as f64, (self.rig.height - 1) as f64);
        let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
        let ends = corners.map(|(x, y)| self.at_depth(&self.direction(x, y), self.max_depth_m));
        std::array::from_fn(|a| {
            let along = |pick: fn(f64, f64) -> f64| ends.iter().map(|p| p[a]).fold(self.origin[a], pick);
            let (low, high) = (along(f64::min).floor().max(0.0), along(f64::max).floor() + 1.0);
            low as usize..(high.max(low) as usize).min(self.spec.shape()[a])
        })
    }
}
