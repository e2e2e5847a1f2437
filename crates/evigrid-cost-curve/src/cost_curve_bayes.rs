use std::sync::{Mutex, PoisonError};

use evigrid_core::{CostVolume, Matches};
use evigrid_grid::{FrameEvidence, GridSpec, LogOddsGrid, Mapper, View, ViewRays};
use multiversion::multiversion;
use rayon::prelude::*;

use crate::hypotheses::Hypotheses;
use crate::look::{Look, LookModel};
use crate::profile::PRIOR_TOLERANCE;
use crate::{CostCurveBayesSettings, CostScale, SettingError, mean_difference};

/// Occupancy mapping from the whole cost curve by Bayes' rule: the project's own variant of Brandao et al., derived in
/// docs/cost-curve-bayes.md.
#[derive(Debug)]
pub struct CostCurveBayes {
    settings: CostCurveBayesSettings,
    scale: CostScale,
    hypotheses: Hypotheses,
    /// What tasks need for themselves, kept from frame to frame.
    looks: Mutex<Vec<Look>>,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl CostCurveBayes {
    /// An empty map over a grid, for cost volumes of this scale.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(
        spec: GridSpec,
        settings: CostCurveBayesSettings,
        scale: CostScale,
    ) -> Result<Self, SettingError> {
        Ok(Self {
            settings: settings.checked()?,
            scale,
            hypotheses: Hypotheses::default(),
            looks: Mutex::default(),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }

    /// What the frame itself says of its noise.
    fn model(&self, view: &View<'_>, max_depth_m: f64) -> LookModel {
        let difference = mean_difference(view.left, view.right, view.matches, self.settings.tolerance_px());
        LookModel {
            sharpness: (self.scale.grey_levels / difference) as f32,
            outliers: self.settings.outlier_share as f32,
            stops: self.settings.stopping_prior() as f32,
            first_beyond: self.hypotheses.far_m().partition_point(|far_m| *far_m <= max_depth_m),
        }
    }
}

impl Mapper for CostCurveBayes {
    fn needs_volume(&self) -> bool {
        true
    }

    fn integrate(&mut self, view: &View<'_>) {
        let Some(volume) = view.volume else { return };
        self.hypotheses.fill(view.rig, volume);
        let depth_m = self.settings.max_depth_m;
        let frame = Frame {
            settings: &self.settings,
            hypotheses: &self.hypotheses,
            model: self.model(view, depth_m),
            rays: ViewRays::new(self.map.spec(), view.rig, view.map_from_left, depth_m),
            volume,
            matches: view.matches,
        };
        // Pixels within one matching window are one look.
        let edge = self.settings.look_edge_px(self.scale);
        (0..view.rig.height.div_ceil(edge)).into_par_iter().for_each(|row| {
            let mut look =
                self.looks.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
            draw_looks(&frame, edge, row, &mut look, &self.evidence);
            self.looks.lock().unwrap_or_else(PoisonError::into_inner).push(look);
        });
        // Fusion over frames: log-odds add up, from the prior on.
        let prior = self.settings.prior_log_odds();
        self.evidence.fuse_from(prior, &mut self.map, self.settings.clamp());
    }

    fn map(&self) -> &LogOddsGrid {
        &self.map
    }
}

/// What all looks of one frame have in common.
struct Frame<'a> {
    settings: &'a CostCurveBayesSettings,
    hypotheses: &'a Hypotheses,
    model: LookModel,
    rays: ViewRays<'a>,
    volume: &'a CostVolume,
    matches: &'a Matches,
}

impl Frame<'_> {
    /// Whether the costs of a pixel say anything: there are some, and the right image confirms the winner.
    #[inline(always)]
    fn counts(&self, x: usize, y: usize) -> bool {
        let pixel = y * self.volume.width() + x;
        !self.matches.disparity.values()[pixel].is_nan()
            && self.matches.left_right_difference_px[pixel] <= self.settings.tolerance_px()
    }
}

/// Offers the evidence of a row of looks to the cells of their rays.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn draw_looks(frame: &Frame<'_>, edge: usize, row: usize, look: &mut Look, evidence: &FrameEvidence) {
    let (width, height) = (frame.volume.width(), frame.volume.height());
    let rows = row * edge..((row + 1) * edge).min(height);
    for x0 in (0..width).step_by(edge) {
        let columns = x0..(x0 + edge).min(width);
        look.pixels.clear();
        for y in rows.clone() {
            look.pixels.extend(columns.clone().filter(|&x| frame.counts(x, y)).map(|x| [x, y]));
        }
        if look.pixels.is_empty() {
            continue;
        }
        let middle = |range: &std::ops::Range<usize>| 0.5 * (range.start + range.end - 1) as f64;
        let direction = frame.rays.direction(middle(&columns), middle(&rows));
        look.sections.fill(&frame.rays, frame.hypotheses, direction);
        look.fill_sums(&frame.model, frame.volume);
        offer(look, evidence);
    }
}

/// The mean over the pixels of the look, unless it is as good as none, as evidence for a cell of which any part may be filled: ln((1 + odds ratio) / 2).
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
