//! Drawing curves whose probabilities are first spread over the cells of each pixel's ray.

use evigrid_grid::{FrameEvidence, ViewRays, cell_index};
use multiversion::multiversion;

use super::curve_block::{CurveBlock, LANES, see};
use super::frame_curves::FrameCurves;
use crate::depth_walk::DepthWalk;

/// Offers the profiles of the pixels of row `y` to all cells of their rays.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn draw_row(curves: &FrameCurves<'_>, y: usize, block: &mut CurveBlock, evidence: &FrameEvidence) {
    block.fill_least(curves.volume, y);
    for x0 in (0..curves.rays.rig.width).step_by(LANES) {
        block.fill_p(&curves.model, curves.volume, y, x0);
        for lane in 0..LANES.min(curves.rays.rig.width - x0) {
            if block.measured[lane] && curves.accepts(x0 + lane, y) {
                let direction = curves.rays.direction((x0 + lane) as f64, y as f64);
                spread(curves, direction, block, lane);
                draw_ray(curves, direction, block, lane, evidence);
            }
        }
    }
}

/// Replaces the weights of a pixel: each hypothesis' p, over the number of cells that its depths take up on
/// the ray.
fn spread(curves: &FrameCurves<'_>, direction: [f64; 3], block: &mut CurveBlock, lane: usize) {
    let mut near = cell_at(&curves.rays, &direction, curves.hypotheses.near_m(0));
    for (i, &far_m) in curves.hypotheses.far_m().iter().enumerate() {
        let far = cell_at(&curves.rays, &direction, far_m);
        let cells = 1 + (0..3).map(|a| near[a].abs_diff(far[a])).sum::<u64>();
        // A hypothesis that reaches to infinity has no share anywhere.
        let share = if far_m.is_finite() { block.p(i, lane) / cells as f32 } else { 0.0 };
        block.weights[i][lane] = share;
        near = far;
    }
}

/// Indices of the cell in which a ray is at a depth.
fn cell_at(rays: &ViewRays<'_>, direction: &[f64; 3], depth_m: f64) -> [i64; 3] {
    rays.at_depth(direction, depth_m).map(cell_index)
}

/// Offers a ray's cells the P of eqs 5 and 4, which run along all cells from the camera on, in the grid or
/// not.
fn draw_ray(
    curves: &FrameCurves<'_>,
    direction: [f64; 3],
    block: &CurveBlock,
    lane: usize,
    evidence: &FrameEvidence,
) {
    let far_m = curves.hypotheses.far_m();
    let mut hidden = 0.0;
    // Hypothesis 0 has not begun before `near_m(0)`.
    let (mut i, mut begun) = (0, false);
    let mut walk = DepthWalk::new(&curves.rays, direction);
    while walk.enter_m < curves.rays.max_depth_m {
        let leave_m = walk.leave_m();
        let mut p = if begun { block.weights[i][lane] } else { 0.0 };
        if !begun && curves.hypotheses.near_m(0) < leave_m {
            (begun, p) = (true, block.weights[0][lane]);
        }
        while begun && far_m[i] < leave_m && i + 1 < far_m.len() {
            i += 1;
            p += block.weights[i][lane];
        }
        let occupied = see(p.min(1.0), &mut hidden);
        if let Some(flat) = curves.rays.spec.flat(walk.cell) {
            evidence.offer(flat, curves.model.key(occupied));
        }
        walk.step();
    }
}
