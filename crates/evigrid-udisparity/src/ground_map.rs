//! From the u-disparity grid to cells on the ground (Perrollaz et al. 2012, 5.1).

use evigrid_core::{Pose, StereoRig};
use evigrid_grid::PlanSpec;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Where the left camera stands over a plan, and what it sees of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundView {
    /// Place of the left camera (x_ref of the paper's eq. 3 is the left camera's), metres.
    pub camera_m: [f64; 2],
    /// Unit vector of its view.
    pub ahead: [f64; 2],
    /// Focal length, pixels.
    pub focal_px: f64,
    /// Column of the principal point.
    pub centre_x_px: f64,
    /// Distance of the cameras, metres.
    pub baseline_m: f64,
}

/// What is less than this into a pixel only touches it, pixels.
const TOUCH_PX: f64 = 1e-9;
/// Rows of plan cells per task.
const ROWS_PER_TASK: usize = 16;

impl GroundView {
    /// The view of a camera at this pose of the map; `None` if it looks straight up or down.
    pub fn of(rig: &StereoRig, map_from_left: &Pose) -> Option<Self> {
        let axis = map_from_left.rotation * Vector3::z();
        let level = axis.x.hypot(axis.y);
        let camera = map_from_left.translation.vector;
        (level > 1e-9).then(|| Self {
            camera_m: [camera.x, camera.y],
            ahead: [axis.x / level, axis.y / level],
            focal_px: rig.focal_px,
            centre_x_px: rig.centre_x_px,
            baseline_m: rig.baseline_m,
        })
    }

    /// Column and disparity of a place of the plan, pixels; `None` beside or behind the camera (eqs 1 to 3).
    #[inline(always)]
    pub fn image_of(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let [dx, dy] = [x - self.camera_m[0], y - self.camera_m[1]];
        let [c, s] = self.ahead;
        let (ahead_m, right_m) = (c * dx + s * dy, s * dx - c * dy);
        (ahead_m > 0.0).then(|| {
            let scale = self.focal_px / ahead_m;
            [self.centre_x_px + scale * right_m, scale * self.baseline_m]
        })
    }
}

/// For every cell of a plan the largest value of the pixels whose area, one column wide and one disparity high, meets
/// the cell's (eq. 16); touching is not meeting. NaN for a cell that no pixel meets, and for one that reaches beside
/// or behind the camera.
///
/// `grid` holds rows of `columns` pixels, for the disparities from 1 on. A cell is a square on the ground and so a
/// convex quadrilateral among columns and disparities: straight lines stay straight.
pub fn map_to_ground(grid: &[f32], columns: usize, view: &GroundView, plan: &PlanSpec, out: &mut [f32]) {
    let [_, ny] = plan.shape();
    let (origin, c) = (plan.origin_m(), plan.cell_size_m());
    let corner = |i: usize, j: usize| view.image_of([origin[0] + i as f64 * c, origin[1] + j as f64 * c]);
    let pixels = Pixels { grid, columns, disparities: grid.len() / columns };
    out.par_chunks_mut(ROWS_PER_TASK * ny).enumerate().for_each(|(task, out)| {
        let first = task * ROWS_PER_TASK;
        let (mut near, mut far) = (vec![None; ny + 1], vec![None; ny + 1]);
        let fill = |i: usize, row: &mut [Option<[f64; 2]>]| {
            row.iter_mut().enumerate().for_each(|(j, to)| *to = corner(i, j));
        };
        fill(first, &mut near);
        for (n, cells) in out.chunks_exact_mut(ny).enumerate() {
            fill(first + n + 1, &mut far);
            for (j, cell) in cells.iter_mut().enumerate() {
                *cell = match [near[j], far[j], far[j + 1], near[j + 1]] {
                    [Some(a), Some(b), Some(c), Some(d)] => pixels.largest(&[a, b, c, d]),
                    _ => f32::NAN,
                };
            }
            std::mem::swap(&mut near, &mut far);
        }
    });
}

struct Pixels<'a> {
    grid: &'a [f32],
    columns: usize,
    disparities: usize,
}

impl Pixels<'_> {
    /// The largest value of the pixels that meet a quadrilateral.
    #[inline(always)]
    fn largest(&self, corners: &[[f64; 2]; 4]) -> f32 {
        let [left, right] = extent(corners.iter().map(|corner| corner[0]));
        if right <= -0.5 || left >= self.columns as f64 - 0.5 {
            return f32::NAN;
        }
        let [lowest, highest] = extent(corners.iter().map(|corner| corner[1]));
        let rows = met(lowest, highest, 1, self.disparities);
        let mut largest = f32::NEG_INFINITY;
        for d in rows {
            let strip = [d as f64 - 0.5, d as f64 + 0.5];
            let columns = if strip[0] <= lowest && highest <= strip[1] {
                [left, right]
            } else {
                extent_within(corners, strip)
            };
            let columns = met(columns[0], columns[1], 0, self.columns - 1);
            let start = (d - 1) * self.columns;
            largest = larger(largest, run_largest(&self.grid[start + columns.start..start + columns.end]));
        }
        if largest == f32::NEG_INFINITY { f32::NAN } else { largest }
    }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The largest of some neighbours, eight side by side.
#[inline(always)]
fn run_largest(values: &[f32]) -> f32 {
    let mut lanes = [f32::NEG_INFINITY; 8];
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        lanes.iter_mut().zip(eight).for_each(|(lane, value)| *lane = larger(*lane, *value));
    }
    rest.iter().chain(&lanes).fold(f32::NEG_INFINITY, |a, b| larger(a, *b))
}

/// The whole numbers from `first` to `last` whose unit interval overlaps `low..high`.
#[inline(always)]
fn met(low: f64, high: f64, first: usize, last: usize) -> std::ops::Range<usize> {
    let start = ((low - 0.5 + TOUCH_PX).floor() + 1.0).max(first as f64);
    let end = (high + 0.5 - TOUCH_PX).ceil().min(last as f64 + 1.0);
    if start < end { start as usize..end as usize } else { 0..0 }
}

#[inline(always)]
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// The columns between which a convex quadrilateral lies within a strip of disparities.
#[inline(always)]
fn extent_within(corners: &[[f64; 2]; 4], strip: [f64; 2]) -> [f64; 2] {
    let mut found = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |u: f64| found = [found[0].min(u), found[1].max(u)];
    for n in 0..4 {
        let ([u, d], [next_u, next_d]) = (corners[n], corners[(n + 1) % 4]);
        if (strip[0]..=strip[1]).contains(&d) {
            add(u);
        }
        for level in strip {
            if (d < level) != (next_d < level) {
                add(u + (next_u - u) * (level - d) / (next_d - d));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: GroundView = GroundView {
        camera_m: [0.3, -0.2],
        ahead: [1.0, 0.0],
        focal_px: 60.0,
        centre_x_px: 20.0,
        baseline_m: 0.4,
    };

    /// Cells sampled densely: every sample lies in one pixel.
    #[test]
    fn cells_take_the_largest_of_the_pixels_that_meet_them() {
        let (columns, disparities) = (41, 14);
        let grid: Vec<f32> =
            (0..columns * disparities).map(|n| ((n * 7919) % 1009) as f32 / 1009.0).collect();
        let plan = PlanSpec::of_area([0.0, 12.0], [-4.0, 4.0], 0.5).unwrap();
        for angle in [0.0_f64, 0.3, -0.7, 2.0] {
            let view = GroundView { ahead: [angle.cos(), angle.sin()], ..VIEW };
            let mut found = vec![0.0; plan.cell_count()];
            map_to_ground(&grid, columns, &view, &plan, &mut found);
            for (flat, &found) in found.iter().enumerate() {
                let [x, y] = plan.centre_m(flat);
                let mut sampled = f32::NAN;
                let (mut is_beside, steps) = (false, 120);
                for n in 0..steps * steps {
                    let at = |k: usize| ((k as f64 + 0.5) / steps as f64 - 0.5) * 0.5;
                    let Some([u, d]) = view.image_of([x + at(n % steps), y + at(n / steps)]) else {
                        is_beside = true;
                        continue;
                    };
                    let (u, d) = ((u + 0.5).floor(), (d + 0.5).floor());
                    if (0.0..columns as f64).contains(&u) && (1.0..=disparities as f64).contains(&d) {
                        sampled = sampled.max(grid[(d as usize - 1) * columns + u as usize]);
                    }
                }
                if is_beside {
                    assert!(found.is_nan());
                } else {
                    // Samples can miss a sliver, so that the cell may be larger, but never smaller.
                    assert!(found >= sampled || sampled.is_nan(), "{angle} {flat}: {found} {sampled}");
                }
            }
        }
    }

    /// Straight ahead, cells are trapezoids: their columns at a disparity d lie at u0 - d y / b (digest of the paper).
    #[test]
    fn cells_straight_ahead_are_trapezoids() {
        let (columns, disparities) = (41, 14);
        let plan = PlanSpec::of_area([0.3, 12.3], [-4.2, 3.8], 0.25).unwrap();
        // Each pixel in turn is the only one that is 1.
        let met_by = |flat: usize| {
            let (n, [_, ny]) = (flat, plan.shape());
            let [x0, y0] = [(n / ny) as f64 * 0.25, (n % ny) as f64 * 0.25 - 4.0];
            let (near, far) = (60.0 * 0.4 / x0.max(1e-12), 60.0 * 0.4 / (x0 + 0.25));
            move |u: usize, d: usize| {
                let (u, d) = (u as f64, d as f64);
                let [low, high] = [far.max(d - 0.5), near.min(d + 0.5)];
                // Left is towards larger y and smaller columns.
                let column = |y: f64, d: f64| 20.0 - d * y / 0.4;
                let right = column(y0, low).max(column(y0, high));
                let left = column(y0 + 0.25, low).min(column(y0 + 0.25, high));
                low < high - 1e-9 && right > u - 0.5 + 1e-9 && left < u + 0.5 - 1e-9
            }
        };
        for pixel in (0..columns * disparities).step_by(3) {
            let mut grid = vec![0.0; columns * disparities];
            grid[pixel] = 1.0;
            let mut found = vec![0.0; plan.cell_count()];
            map_to_ground(&grid, columns, &VIEW, &plan, &mut found);
            for (flat, &found) in found.iter().enumerate().skip(plan.shape()[1]) {
                assert_eq!(
                    found == 1.0,
                    met_by(flat)(pixel % columns, pixel / columns + 1),
                    "{pixel} {flat}"
                );
            }
        }
    }
}
