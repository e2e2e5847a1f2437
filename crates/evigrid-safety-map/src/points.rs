//! Selection of points: the first of a frame in every voxel, row by row from the top (section IV).

use evigrid_grid::{GridSpec, ViewRays, cell_index};
use multiversion::multiversion;

/// A point of a frame that was selected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RangePoint {
    /// Its place, in units of voxels from the grid's lower corner.
    pub at: [f64; 3],
    /// Flat index of its voxel.
    pub voxel: u32,
    /// How far the camera was away when it was seen, metres.
    pub distance_m: f32,
}

/// Selects the points of frames. The buffers are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct PointSelection {
    /// Number of the last frame that had a point in each voxel.
    last_frame: Vec<u32>,
    frame: u32,
    voxels: Vec<i32>,
    points: Vec<RangePoint>,
}

/// Stands for a pixel without a point in the grid.
const NONE: i32 = -1;

impl PointSelection {
    /// A selection for a grid of so many voxels.
    pub fn new(voxels: usize) -> Self {
        Self { last_frame: vec![0; voxels], frame: 0, voxels: Vec::new(), points: Vec::new() }
    }

    /// The points of a frame: those of disparities of at least `min_disparity_px` that lie in the grid, and of
    /// them the first in each voxel, row by row from the top, from left to right.
    pub fn select(
        &mut self,
        rays: &ViewRays<'_>,
        disparities: &[f32],
        min_disparity_px: f64,
    ) -> &[RangePoint] {
        self.begin();
        let width = rays.rig.width;
        self.voxels.resize(width, NONE);
        for (y, disparities) in disparities.chunks_exact(width).enumerate() {
            let row = RowOfPoints::new(rays, y, min_disparity_px);
            voxels_of_row(&row, disparities, &mut self.voxels);
            self.keep_first(&row, disparities);
        }
        &self.points
    }

    fn begin(&mut self) {
        self.points.clear();
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            self.last_frame.fill(0);
            self.frame = 1;
        }
    }

    /// Keeps the points of a row whose voxels had none yet in this frame.
    fn keep_first(&mut self, row: &RowOfPoints<'_>, disparities: &[f32]) {
        for (x, &voxel) in self.voxels.iter().enumerate() {
            if voxel == NONE || self.last_frame[voxel as usize] == self.frame {
                continue;
            }
            self.last_frame[voxel as usize] = self.frame;
            let at = row.point(x, disparities[x]);
            let away = [0, 1, 2].map(|a| at[a] - row.rays.origin[a]);
            let distance = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt();
            let distance_m = (distance * row.rays.spec.cell_size_m()) as f32;
            self.points.push(RangePoint { at, voxel: voxel as u32, distance_m });
        }
    }
}

/// The rays of one row of the image.
struct RowOfPoints<'a> {
    rays: &'a ViewRays<'a>,
    /// Direction of the ray in column 0, voxels per metre of depth.
    first: [f64; 3],
    /// Depth times disparity, b f.
    depth_disparity: f64,
    min_disparity_px: f64,
    shape: [f64; 3],
}

impl<'a> RowOfPoints<'a> {
    fn new(rays: &'a ViewRays<'a>, y: usize, min_disparity_px: f64) -> Self {
        Self {
            rays,
            first: rays.direction(0.0, y as f64),
            depth_disparity: rays.rig.depth_m(1.0),
            min_disparity_px,
            shape: rays.spec.shape().map(|n| n as f64),
        }
    }

    /// The point of a pixel, in units of voxels.
    #[inline(always)]
    fn point(&self, x: usize, disparity: f32) -> [f64; 3] {
        let depth_m = self.depth_disparity / f64::from(disparity);
        [0, 1, 2].map(|a| {
            let direction = self.first[a] + self.rays.per_column[a] * x as i32 as f64;
            self.rays.origin[a] + depth_m * direction
        })
    }
}

/// Flat index of the voxel of each pixel's point, or [`NONE`]. Vector code turns f64 into integers one by one, so
/// all is done in f64, which holds every index exactly.
#[multiversion(targets("x86_64+avx2"))]
fn voxels_of_row(row: &RowOfPoints<'_>, disparities: &[f32], voxels: &mut [i32]) {
    let [nx, ny, nz] = row.shape;
    for (x, (voxel, &disparity)) in voxels.iter_mut().zip(disparities).enumerate() {
        let near = f64::from(disparity) >= row.min_disparity_px;
        let [u, v, w] = row.point(x, if near { disparity } else { 1.0 });
        let inside = near & (u >= 0.0) & (u < nx) & (v >= 0.0) & (v < ny) & (w >= 0.0) & (w < nz);
        let flat = (u.floor() * ny + v.floor()) * nz + w.floor();
        *voxel = whole(if inside { flat } else { f64::from(NONE) });
    }
}

/// A whole number within the range of i32 as an integer: added to this constant, it is in the last bits of the sum.
#[inline(always)]
fn whole(number: f64) -> i32 {
    const LAST_BITS: f64 = 1.5 * (1_u64 << 52) as f64;
    (number + LAST_BITS).to_bits() as i32
}

/// Flat index of the voxel that a ray comes to behind a point; `None` outside of the grid.
pub(crate) fn voxel_behind(spec: &GridSpec, origin: [f64; 3], at: [f64; 3]) -> Option<usize> {
    let cell = at.map(cell_index);
    let mut nearest = (f64::INFINITY, 0);
    for a in 0..3 {
        let direction = at[a] - origin[a];
        if direction != 0.0 {
            let face = (cell[a] + i64::from(direction > 0.0)) as f64;
            let after = (face - at[a]) / direction;
            if after < nearest.0 {
                nearest = (after, a);
            }
        }
    }
    let (after, axis) = nearest;
    let mut behind = cell;
    behind[axis] += if at[axis] > origin[axis] { 1 } else { -1 };
    if after.is_finite() { spec.flat(behind) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_of_the_range_of_indices() {
        for n in [-1, 0, 1, 2, 299_999, (1 << 29) - 1, i32::MAX, i32::MIN] {
            assert_eq!(whole(f64::from(n)), n);
        }
    }
}
