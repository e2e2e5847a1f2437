//! Drawing curves whose probabilities are first spread over the cells of each pixel's ray.

use evigrid_grid::{FrameEvidence, ViewRays, cell_index};
use multiversion::multiversion;

use crate::cost_curve::Frame;
use crate::curve_block::{CurveBlock, LANES, see};
use crate::depth_walk::DepthWalk;

/// Offers the profiles of the pixels of row `y` to all cells of their rays.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn draw_row(frame: &Frame<'_>, y: usize, block: &mut CurveBlock, evidence: &FrameEvidence) {
    block.fill_least(frame.volume, y);
    for x0 in (0..frame.rays.rig.width).step_by(LANES) {
        block.fill_p(&frame.model, frame.volume, y, x0);
        for lane in 0..LANES.min(frame.rays.rig.width - x0) {
            if block.measured[lane] && frame.accepts(x0 + lane, y) {
                spread(frame, frame.rays.direction((x0 + lane) as f64, y as f64), block, lane);
                draw_ray(frame, frame.rays.direction((x0 + lane) as f64, y as f64), block, lane, evidence);
            }
        }
    }
}

/// Each hypothesis' p over the number of cells that its depths take up on the ray, instead of the pixel's weights.
fn spread(frame: &Frame<'_>, direction: [f64; 3], block: &mut CurveBlock, lane: usize) {
    let mut near = cell_at(&frame.rays, &direction, frame.hypotheses.near_m(0));
    for (i, &far_m) in frame.hypotheses.far_m().iter().enumerate() {
        let far = cell_at(&frame.rays, &direction, far_m);
        let cells = 1 + (0..3).map(|a| near[a].abs_diff(far[a])).sum::<u64>();
        // What reaches to infinity has no share anywhere.
        let share = if far_m.is_finite() { block.p(i, lane) / cells as f32 } else { 0.0 };
        block.weights[i][lane] = share;
        near = far;
    }
}

fn cell_at(rays: &ViewRays<'_>, direction: &[f64; 3], depth_m: f64) -> [i64; 3] {
    rays.at_depth(direction, depth_m).map(cell_index)
}

/// Eqs 5 and 4 along all cells from the camera on, whether they are in the grid or not.
fn draw_ray(
    frame: &Frame<'_>,
    direction: [f64; 3],
    block: &CurveBlock,
    lane: usize,
    evidence: &FrameEvidence,
) {
    let far_m = frame.hypotheses.far_m();
    let mut hidden = 0.0;
    // Hypothesis 0 has not begun before `near_m(0)`.
    let (mut i, mut begun) = (0, false);
    let mut walk = DepthWalk::new(&frame.rays, direction);
    while walk.enter_m < frame.rays.max_depth_m {
        let leave_m = walk.leave_m();
        let mut p = if begun { block.weights[i][lane] } else { 0.0 };
        if !begun && frame.hypotheses.near_m(0) < leave_m {
            (begun, p) = (true, block.weights[0][lane]);
        }
        while begun && far_m[i] < leave_m && i + 1 < far_m.len() {
            i += 1;
            p += block.weights[i][lane];
        }
        let occupied = see(p.min(1.0), &mut hidden);
        if let Some(flat) = frame.rays.spec.flat(walk.cell) {
            evidence.offer(flat, frame.model.key(occupied));
        }
        walk.step();
    }
}
