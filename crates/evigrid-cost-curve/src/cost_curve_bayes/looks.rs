//! All looks of one frame.

use std::ops::Range;

use evigrid_core::{CostVolume, MatchFilter};
use evigrid_grid::{FrameEvidence, ViewRays};
use multiversion::multiversion;

use super::look::{Look, LookModel};
use crate::elfes::PRIOR_TOLERANCE;
use crate::hypotheses::Hypotheses;
use crate::pixels::Pixel;

/// The frame that looks are taken at: everything that all of them have in common.
pub(crate) struct LookFrame<'a> {
    /// The costs of all pixels.
    pub volume: &'a CostVolume,
    /// The winner of every pixel; NaN where there is none.
    pub winners: &'a [f32],
    /// The pixels that the right image confirms, if it is asked.
    pub filter: MatchFilter<'a>,
    /// From costs to probabilities.
    pub model: LookModel,
    /// The depths that the costs of a pixel stand for.
    pub hypotheses: &'a Hypotheses,
    /// The rays of the pixels.
    pub rays: ViewRays<'a>,
    /// Edge of a look, pixels.
    pub edge_px: usize,
}

impl LookFrame<'_> {
    /// Whether the costs of a pixel say anything: there are some, and the right image confirms the winner.
    #[inline(always)]
    fn is_usable(&self, x: usize, y: usize) -> bool {
        let pixel = y * self.volume.width() + x;
        !self.winners[pixel].is_nan() && self.filter.is_confirmed(pixel)
    }
}

/// Offers the evidence of a row of looks to the cells of their rays; `look` is a buffer.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
pub(crate) fn draw_looks(frame: &LookFrame<'_>, row: usize, look: &mut Look, evidence: &FrameEvidence) {
    let (width, height, edge) = (frame.volume.width(), frame.volume.height(), frame.edge_px);
    let rows = row * edge..((row + 1) * edge).min(height);
    for x0 in (0..width).step_by(edge) {
        let columns = x0..(x0 + edge).min(width);
        look.pixels.clear();
        for y in rows.clone() {
            look.pixels.extend(columns.clone().filter(|&x| frame.is_usable(x, y)).map(|x| Pixel { x, y }));
        }
        if look.pixels.is_empty() {
            continue;
        }
        let middle = |range: &Range<usize>| 0.5 * (range.start + range.end - 1) as f64;
        let direction = frame.rays.direction(middle(&columns), middle(&rows));
        look.sections.fill(&frame.rays, frame.hypotheses, direction);
        look.fill_sums(&frame.model, frame.volume);
        offer(look, evidence);
    }
}

/// Offers each cell of a look's ray the mean over its pixels, unless it is as good as none, as evidence for a
/// cell of which any part may be filled: ln((1 + odds ratio) / 2).
#[inline(always)]
fn offer(look: &Look, evidence: &FrameEvidence) {
    let per_pixel = 1.0 / look.pixels.len() as f32;
    for (cell, sum) in look.sections.cells.iter().zip(&look.sums) {
        let Some(flat) = cell.flat else { continue };
        let log_odds = (0.5 + 0.5 * (sum * per_pixel).exp()).ln();
        if log_odds.abs() >= PRIOR_TOLERANCE {
            evidence.offer(flat, FrameEvidence::key(log_odds));
        }
    }
}
