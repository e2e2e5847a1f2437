use std::sync::{Mutex, PoisonError};

use evigrid_core::{CostVolume, Matches};
use evigrid_grid::{FrameEvidence, GridSpec, LogOddsGrid, Mapper, View, ViewRays};
use rayon::prelude::*;

use crate::curve_block::{CurveBlock, CurveModel};
use crate::free_space::draw_free_space;
use crate::hypotheses::Hypotheses;
use crate::reach::ReachImage;
use crate::{
    CostCurveSettings, CostExponent, CostScale, HypothesesToCells, SettingError, curve_cells, curve_lines,
    free_space_costs, pixel_variance,
};

/// Occupancy mapping from the whole cost curve of each pixel (Brandao et al., section III).
///
/// Lines are drawn from the camera through every pixel up to the largest depth; where they share a cell, the largest P
/// wins. The part of a line in front of all hypotheses that are more than simply free is not drawn pixel by pixel: of
/// every cell it is asked whether any line crosses it there. The map is the same as that of whole lines.
#[derive(Debug)]
pub struct CostCurve {
    settings: CostCurveSettings,
    scale: CostScale,
    hypotheses: Hypotheses,
    reach: ReachImage,
    /// What tasks need for themselves, kept from frame to frame.
    blocks: Mutex<Vec<CurveBlock>>,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl CostCurve {
    /// An empty map over a grid, for cost volumes of this scale.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: CostCurveSettings, scale: CostScale) -> Result<Self, SettingError> {
        Ok(Self {
            settings: settings.checked()?,
            scale,
            hypotheses: Hypotheses::default(),
            reach: ReachImage::default(),
            blocks: Mutex::default(),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }

    /// Eqs 10 and 7, and the costs of free space where they are modelled.
    fn model(&self, view: &View<'_>, volume: &CostVolume) -> CurveModel {
        let settings = &self.settings;
        let winners = &view.matches.disparity;
        let variance = settings.variance_factor * pixel_variance(view.left, view.right, winners);
        let exponent = CostExponent::new(settings.cost_unit, variance, self.scale.window_pixels);
        let free_space = settings.free_space_model.then(|| free_space_costs(volume, winners)).flatten();
        CurveModel::new(exponent, self.scale, free_space, settings.evidence_bounds())
    }
}

impl Mapper for CostCurve {
    fn needs_volume(&self) -> bool {
        true
    }

    fn integrate(&mut self, view: &View<'_>) {
        let Some(volume) = view.volume else { return };
        let model = self.model(view, volume);
        // Between the hypotheses and the cells: the depths that a disparity stands for.
        self.hypotheses.fill(view.rig, volume);
        let depth_m = self.settings.max_depth_m.min(self.hypotheses.near_m(self.hypotheses.len()));
        let rays = ViewRays::new(self.map.spec(), view.rig, view.map_from_left, depth_m);
        let (settings, hypotheses) = (&self.settings, &self.hypotheses);
        let frame = Frame { settings, hypotheses, model, rays, volume, matches: view.matches };
        // Eqs 7, 9 (or 6), 5 and 4 of every pixel, from sensor space to grid space.
        match self.settings.hypotheses_to_cells {
            HypothesesToCells::PerDisparity => {
                self.reach.fill(view.rig.width, view.rig.height, |y, reach| {
                    with_block(&self.blocks, |block| {
                        curve_lines::draw_row(&frame, y, reach, block, &self.evidence);
                    });
                });
                // The rest of the lines, where P is at its lower bound.
                draw_free_space(&frame.rays, &self.reach, model.free_key(), &self.evidence);
            }
            HypothesesToCells::SpreadOverCells => (0..view.rig.height).into_par_iter().for_each(|y| {
                with_block(&self.blocks, |block| curve_cells::draw_row(&frame, y, block, &self.evidence));
            }),
        }
        // Fusion over frames: log-odds add up.
        self.evidence.fuse_into(&mut self.map, self.settings.clamp());
    }

    fn map(&self) -> &LogOddsGrid {
        &self.map
    }
}

/// What all pixels of one frame have in common.
pub(crate) struct Frame<'a> {
    settings: &'a CostCurveSettings,
    pub hypotheses: &'a Hypotheses,
    pub model: CurveModel,
    pub rays: ViewRays<'a>,
    pub volume: &'a CostVolume,
    matches: &'a Matches,
}

impl Frame<'_> {
    /// Whether a pixel is to be drawn: all are, unless the right image is asked.
    #[inline(always)]
    pub fn accepts(&self, x: usize, y: usize) -> bool {
        !self.settings.left_right_check
            || self.matches.left_right_difference_px[y * self.volume.width() + x]
                <= self.settings.left_right_tolerance_px
    }
}

/// Runs a task with a block that no other task has.
fn with_block(blocks: &Mutex<Vec<CurveBlock>>, task: impl FnOnce(&mut CurveBlock)) {
    let mut block = blocks.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
    task(&mut block);
    blocks.lock().unwrap_or_else(PoisonError::into_inner).push(block);
}
