use evigrid_core::{SettingError, View};
use evigrid_grid::{FrameEvidence, GridSpec, Layer, LogOddsGrid, MapError, Mapper, Method, ViewRays};

use super::profile::ProfileTable;
use super::sections::{InverseModel, draw_sections};
use super::settings::WinnerTakeAllSettings;
use crate::free_space::{ReachImage, draw_free_space};

/// Occupancy mapping from the winner of each pixel (Brandao et al., section II-A, and the baseline of IV).
///
/// Lines are drawn from the camera through every pixel; where they share a cell, the largest P wins. Most of
/// a line gets one and the same P, the lowest that a frame may give. Only the short section around the
/// measured cell is therefore drawn pixel by pixel; of every other cell it is asked whether any line crosses
/// it in front of that section. The map is the same as that of whole lines.
#[derive(Debug)]
pub struct WinnerTakeAll {
    settings: WinnerTakeAllSettings,
    profiles: ProfileTable,
    reach: ReachImage,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl WinnerTakeAll {
    /// An empty map over a grid.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: WinnerTakeAllSettings) -> Result<Self, SettingError> {
        Self::check(&settings)?;
        Ok(Self {
            settings,
            profiles: ProfileTable::new(settings.evidence_bounds()),
            reach: ReachImage::default(),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }

    /// The map so far.
    pub fn map(&self) -> &LogOddsGrid {
        &self.map
    }
}

impl Mapper for WinnerTakeAll {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        // From sensor space to grid space.
        let rays = ViewRays::new(self.map.spec(), view.rig, view.map_from_left, self.settings.max_depth_m);
        // The cell of each believable winner, and Elfes' occupancy profile around it (eqs 1 to 3).
        let model = InverseModel { settings: &self.settings, profiles: &self.profiles };
        draw_sections(&rays, model, view.matches, &mut self.reach, &self.evidence);
        // The rest of the lines, from the camera to where the profile begins.
        draw_free_space(&rays, &self.reach, self.profiles.free(), &self.evidence);
        // Fusion over frames: log-odds add up.
        self.evidence.fuse_into(&mut self.map, self.settings.clamp());
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.map)]
    }
}
