use std::sync::{Mutex, PoisonError};

use evigrid_core::{CostVolume, MatchFilter, SettingError, View};
use evigrid_grid::{
    FrameEvidence, GridSpec, Layer, LayerKind, LogOddsGrid, MapError, Mapper, Method, Needs, ViewRays,
};
use rayon::prelude::*;

use super::look::{Look, LookModel};
use super::looks::{LookFrame, draw_looks};
use super::settings::CostCurveBayesSettings;
use crate::cost_statistics::mean_difference;
use crate::hypotheses::Hypotheses;

/// Occupancy mapping from the whole cost curve by Bayes' rule: the project's own variant of Brandao et al.,
/// derived in docs/cost-curve-bayes.md.
#[derive(Debug)]
pub struct CostCurveBayes {
    settings: CostCurveBayesSettings,
    hypotheses: Hypotheses,
    /// Buffers of tasks, kept from frame to frame.
    looks: Mutex<Vec<Look>>,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl CostCurveBayes {
    /// An empty map over a grid.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: CostCurveBayesSettings) -> Result<Self, SettingError> {
        Self::check(&settings)?;
        Ok(Self {
            settings,
            hypotheses: Hypotheses::default(),
            looks: Mutex::default(),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }

    /// The map so far.
    pub fn map(&self) -> &LogOddsGrid {
        &self.map
    }

    /// From costs to probabilities, by the noise that the frame itself shows.
    fn model(&self, view: &View<'_>, volume: &CostVolume) -> LookModel {
        let settings = &self.settings;
        let difference = mean_difference(view.left, view.right, view.matches, settings.left_right_px());
        LookModel {
            sharpness: (volume.scale().grey_levels / difference) as f32,
            outliers: settings.outlier_share as f32,
            stops: settings.stopping_prior() as f32,
            first_beyond: self.hypotheses.far_m().partition_point(|far_m| *far_m <= settings.max_depth_m),
        }
    }
}

impl Mapper for CostCurveBayes {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let volume = MapError::volume(view)?;
        self.hypotheses.fill(view.rig, volume);
        let depth_m = self.settings.max_depth_m;
        let frame = LookFrame {
            volume,
            winners: view.matches.disparity.values(),
            filter: MatchFilter::new(view.matches, &self.settings.match_limits()),
            model: self.model(view, volume),
            hypotheses: &self.hypotheses,
            rays: ViewRays::new(self.map.spec(), view.rig, view.map_from_left, depth_m),
            // Pixels within one matching window are one look.
            edge_px: self.settings.look_edge_px(volume.scale()),
        };
        (0..view.rig.height.div_ceil(frame.edge_px)).into_par_iter().for_each(|row| {
            let mut look =
                self.looks.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
            draw_looks(&frame, row, &mut look, &self.evidence);
            self.looks.lock().unwrap_or_else(PoisonError::into_inner).push(look);
        });
        // Fusion over frames: log-odds add up, from the prior on.
        let prior = self.settings.prior_log_odds();
        self.evidence.fuse_from(prior, &mut self.map, self.settings.clamp());
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.map)]
    }
}

impl Method for CostCurveBayes {
    const NAME: &'static str = "cost-curve-bayes";
    const SUMMARY: &'static str = "the matching costs of all disparities as evidence by Bayes' rule, \
        with a realistic prior and looks instead of pixels: our own";
    const NEEDS: Needs = Needs::COSTS;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = CostCurveBayesSettings;

    fn check(settings: &CostCurveBayesSettings) -> Result<(), SettingError> {
        settings.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &CostCurveBayesSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self::new(spec, *settings)?))
    }
}
