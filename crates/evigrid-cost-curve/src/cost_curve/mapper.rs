use std::sync::{Mutex, PoisonError};

use evigrid_core::{CostVolume, MatchFilter, SettingError, View};
use evigrid_grid::{
    FrameEvidence, GridSpec, Layer, LayerKind, LogOddsGrid, MapError, Mapper, Method, Needs, ViewRays,
};
use rayon::prelude::*;

use super::cost_exponent::CostExponent;
use super::curve_block::{CurveBlock, CurveModel};
use super::frame_curves::FrameCurves;
use super::settings::{CostCurveSettings, HypothesesToCells};
use super::{curve_cells, curve_lines};
use crate::cost_statistics::{free_space_costs, pixel_variance};
use crate::free_space::{ReachImage, draw_free_space};
use crate::hypotheses::Hypotheses;

/// Occupancy mapping from the whole cost curve of each pixel (Brandao et al., section III).
///
/// Lines are drawn from the camera through every pixel up to the largest depth; where they share a cell, the
/// largest P wins. The part of a line in front of all hypotheses that are more than simply free is not drawn
/// pixel by pixel: of every cell it is asked whether any line crosses it there. The map is the same as that
/// of whole lines.
#[derive(Debug)]
pub struct CostCurve {
    settings: CostCurveSettings,
    hypotheses: Hypotheses,
    reach: ReachImage,
    /// Buffers of tasks, kept from frame to frame.
    blocks: Mutex<Vec<CurveBlock>>,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl CostCurve {
    /// An empty map over a grid.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: CostCurveSettings) -> Result<Self, SettingError> {
        Self::check(&settings)?;
        Ok(Self {
            settings,
            hypotheses: Hypotheses::default(),
            reach: ReachImage::default(),
            blocks: Mutex::default(),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }

    /// The map so far.
    pub fn map(&self) -> &LogOddsGrid {
        &self.map
    }

    /// From costs to probabilities, by eqs 10 and 7, and by the costs of free space where they are modelled.
    fn model(&self, view: &View<'_>, volume: &CostVolume) -> CurveModel {
        let settings = &self.settings;
        let winners = &view.matches.disparity;
        let variance = settings.variance_factor * pixel_variance(view.left, view.right, winners);
        let scale = volume.scale();
        let exponent = CostExponent::new(settings.cost_unit, variance, scale.window_pixels);
        let free_space = settings.free_space_model.then(|| free_space_costs(volume, winners)).flatten();
        CurveModel::new(exponent, scale, free_space, settings.evidence_bounds())
    }
}

impl Mapper for CostCurve {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let volume = MapError::volume(view)?;
        let model = self.model(view, volume);
        // Between the hypotheses and the cells: the depths that a disparity stands for.
        self.hypotheses.fill(view.rig, volume);
        let depth_m = self.settings.max_depth_m.min(self.hypotheses.near_m(self.hypotheses.len()));
        let rays = ViewRays::new(self.map.spec(), view.rig, view.map_from_left, depth_m);
        let filter = MatchFilter::new(view.matches, &self.settings.match_limits());
        let curves = FrameCurves { volume, model, hypotheses: &self.hypotheses, rays, filter };
        // Eqs 7, 9 (or 6), 5 and 4 of every pixel, from sensor space to grid space.
        match self.settings.hypotheses_to_cells {
            HypothesesToCells::PerDisparity => {
                self.reach.fill(view.rig.width, view.rig.height, |y, reach| {
                    with_block(&self.blocks, |block| {
                        curve_lines::draw_row(&curves, y, reach, block, &self.evidence);
                    });
                });
                // The rest of the lines, where P is at its lower bound.
                draw_free_space(&curves.rays, &self.reach, model.free_key(), &self.evidence);
            }
            HypothesesToCells::SpreadOverCells => (0..view.rig.height).into_par_iter().for_each(|y| {
                with_block(&self.blocks, |block| curve_cells::draw_row(&curves, y, block, &self.evidence));
            }),
        }
        // Fusion over frames: log-odds add up.
        self.evidence.fuse_into(&mut self.map, self.settings.clamp());
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.map)]
    }
}

impl Method for CostCurve {
    const NAME: &'static str = "cost-curve";
    const SUMMARY: &'static str =
        "the matching costs of all disparities of each pixel as evidence: Brandao et al.";
    const NEEDS: Needs = Needs::COSTS;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = CostCurveSettings;

    fn check(settings: &CostCurveSettings) -> Result<(), SettingError> {
        settings.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &CostCurveSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self::new(spec, *settings)?))
    }
}

/// Runs a task with a block that no other task has.
fn with_block(blocks: &Mutex<Vec<CurveBlock>>, task: impl FnOnce(&mut CurveBlock)) {
    let mut block = blocks.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
    task(&mut block);
    blocks.lock().unwrap_or_else(PoisonError::into_inner).push(block);
}
