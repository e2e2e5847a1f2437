//! Drawing profiles along disparity hypotheses into the cells of each pixel's ray.

use evigrid_grid::{FrameEvidence, RayBatch, RayWalk, cell_index};
use multiversion::multiversion;

use super::curve_block::{CurveBlock, LANES};
use super::frame_curves::FrameCurves;
use crate::free_space::NO_REACH;

/// Rays that are walked side by side.
const RAYS: usize = 16;

/// Offers the profiles of the pixels of row `y` to the cells of their rays, and sets how far the rays are
/// simply free.
pub(crate) fn draw_row(
    curves: &FrameCurves<'_>,
    y: usize,
    reach: &mut [i32],
    block: &mut CurveBlock,
    evidence: &FrameEvidence,
) {
    fill_least(curves, y, block);
    for (n, reach) in reach.chunks_mut(LANES).enumerate() {
        // Eqs 7 and 9 (or 6), then 5 and 4.
        fill_block(curves, y, n * LANES, block);
        for (m, reach) in reach.chunks_mut(RAYS).enumerate() {
            draw_rays(curves, y, n * LANES, m * RAYS, reach, block, evidence);
        }
    }
}

/// Sets the smallest costs of row `y`. No result depends on the choice of the processor's instructions.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn fill_least(curves: &FrameCurves<'_>, y: usize, block: &mut CurveBlock) {
    block.fill_least(curves.volume, y);
}

/// Sets the keys of the block of row `y` that begins at `x0`. No result depends on the choice of the
/// processor's instructions.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn fill_block(curves: &FrameCurves<'_>, y: usize, x0: usize, block: &mut CurveBlock) {
    block.fill_p(&curves.model, curves.volume, y, x0);
    block.fill_keys(&curves.model);
    block.fill_largest_of_4();
}

/// Draws some neighbouring rays, the first of which is lane `first_lane` of the block that begins at `x0`. No
/// result depends on the choice of the processor's instructions.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn draw_rays(
    curves: &FrameCurves<'_>,
    y: usize,
    x0: usize,
    first_lane: usize,
    reach: &mut [i32],
    block: &CurveBlock,
    evidence: &FrameEvidence,
) {
    let mut rays = NeighbouringRays::default();
    for (l, reach) in reach.iter_mut().enumerate() {
        let lane = first_lane + l;
        let x = x0 + lane;
        *reach = if block.measured[lane] && curves.accepts(x, y) {
            let direction = curves.rays.direction(x as f64, y as f64);
            rays.set(curves, l, direction, block.free[lane] as usize)
        } else {
            NO_REACH
        };
    }
    rays.draw(curves, first_lane, block, evidence);
}

/// Neighbouring rays, each from where it is no longer simply free up to the greatest depth.
#[derive(Default)]
struct NeighbouringRays {
    batch: RayBatch<RAYS>,
    /// Depth at which each begins, metres.
    start_m: [f64; RAYS],
    /// Depth from there to its end, metres.
    length_m: [f64; RAYS],
    /// Hypothesis at which each ray enters its next cell.
    enter: [i32; RAYS],
}

impl NeighbouringRays {
    /// Puts a ray into a place; its first `free` hypotheses are simply free. Returns its reach up to there,
    /// in steps from the camera.
    #[inline(always)]
    fn set(&mut self, curves: &FrameCurves<'_>, l: usize, direction: [f64; 3], free: usize) -> i32 {
        let rays = &curves.rays;
        let start_m = curves.hypotheses.near_m(free);
        let end = rays.at_depth(&direction, rays.max_depth_m);
        if start_m >= rays.max_depth_m {
            return rays.steps_to(&end.map(cell_index));
        }
        let start = rays.at_depth(&direction, start_m);
        let walk = RayWalk::in_cells(rays.spec, start, end);
        self.batch.set(l, &walk);
        self.start_m[l] = start_m;
        self.length_m[l] = rays.max_depth_m - start_m;
        // At the start itself rounding must not decide.
        let enter = curves.hypotheses.at(start_m + walk.enter() * self.length_m[l]);
        self.enter[l] = enter.max(free as i32);
        rays.steps_to(&start.map(cell_index)) - 1
    }

    /// Offers each cell of each ray the largest P of all hypotheses in it.
    #[inline(always)]
    fn draw(
        &mut self,
        curves: &FrameCurves<'_>,
        first_lane: usize,
        block: &CurveBlock,
        evidence: &FrameEvidence,
    ) {
        let cells = *self.batch.cells();
        let steps = cells.iter().fold(0, |most, &n| most.max(n));
        for step in 0..steps {
            let (flat, leave) = self.batch.step();
            let mut hypothesis = [0; RAYS];
            for l in 0..RAYS {
                let at = curves.hypotheses.at(self.start_m[l] + leave[l] * self.length_m[l]);
                hypothesis[l] = if at > self.enter[l] { at } else { self.enter[l] };
            }
            for l in 0..RAYS {
                if step < cells[l] {
                    let key =
                        block.largest_key(first_lane + l, self.enter[l] as usize, hypothesis[l] as usize);
                    evidence.offer(flat[l] as usize, key);
                }
            }
            self.enter = hypothesis;
        }
    }
}
