use evigrid_core::{MatchFilter, MatchLimits, Matches, NO_MATCH, SettingError, View};
use evigrid_grid::{GridSpec, Layer, LogOddsGrid, MapError, MapperFamily, Method, ViewRays};
use multiversion::multiversion;

use super::mapper::WinnerTakeAll;
use super::nested::{NestedEvidence, NestedMaps};
use super::nested_free_space::draw_free_space;
use super::nested_reach::{NestedReach, PixelReach};
use super::profile::ProfileTable;
use super::sections::{InverseModel, draw_section};
use super::settings::WinnerTakeAllSettings;

/// The maps of [`WinnerTakeAll`] for several peak ratios, all other settings being the same (Brandao et al.,
/// section IV-B: 1.5 to 12).
///
/// Matches that pass a peak ratio pass all smaller ones. Every line is therefore drawn once, for as many maps
/// as its match passes the ratio of, and of every cell it is asked which is the highest ratio with a line
/// through it.
#[derive(Debug)]
pub struct PeakRatios {
    settings: WinnerTakeAllSettings,
    /// The peak ratios by rising value.
    ratios: Vec<f64>,
    /// Place of each member's peak ratio among them.
    places: Vec<usize>,
    profiles: ProfileTable,
    reach: NestedReach,
    evidence: NestedEvidence,
    maps: NestedMaps,
}

impl PeakRatios {
    /// Empty maps over a grid, one for each of the peak ratios, at least one; that of `settings` does not
    /// count.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(
        spec: GridSpec,
        settings: WinnerTakeAllSettings,
        peak_ratios: &[f64],
    ) -> Result<Self, SettingError> {
        for &peak_ratio in peak_ratios {
            WinnerTakeAll::check(&WinnerTakeAllSettings { peak_ratio, ..settings })?;
        }
        let mut ratios = peak_ratios.to_vec();
        ratios.sort_by(f64::total_cmp);
        let places = peak_ratios.iter().map(|p| ratios.partition_point(|r| r < p)).collect();
        Ok(Self {
            settings,
            places,
            profiles: ProfileTable::new(settings.evidence_bounds()),
            reach: NestedReach::default(),
            evidence: NestedEvidence::new(spec.cell_count(), ratios.len()),
            maps: NestedMaps::unknown(spec, ratios.len()),
            ratios,
        })
    }

    /// The map of one of the peak ratios so far, by its position in the list that the family was built from.
    pub fn map(&self, member: usize) -> LogOddsGrid {
        self.maps.map(self.places[member])
    }
}

impl MapperFamily for PeakRatios {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let rays = ViewRays::new(self.maps.spec(), view.rig, view.map_from_left, self.settings.max_depth_m);
        let filter = NestedFilter::new(&self.settings, &self.ratios, view.matches);
        let model = InverseModel { settings: &self.settings, profiles: &self.profiles };
        let evidence = &self.evidence;
        self.reach.fill(view.rig.width, view.rig.height, |y, row| {
            draw_row(&rays, model, filter, y, row, evidence);
        });
        draw_free_space(&rays, &self.reach, self.profiles.free(), evidence);
        // One layer more on either side, for what rounding may have put beyond the end of a ray.
        let [layers, ..] = rays.box_in_grid();
        let layers = layers.start.saturating_sub(1)..(layers.end + 1).min(rays.spec.shape()[0]);
        self.evidence.fuse_into(&mut self.maps, self.settings.clamp(), layers);
        Ok(())
    }

    fn layers(&self, member: usize) -> Vec<Layer<'_>> {
        vec![Layer::from(self.map(member))]
    }
}

/// The match filters of all maps, which differ in the peak ratio.
#[derive(Debug, Clone, Copy)]
struct NestedFilter<'a> {
    /// The filter of a map that lets all peak ratios pass.
    widest: MatchFilter<'a>,
    peak_ratio: &'a [f32],
    ratios: &'a [f64],
}

impl<'a> NestedFilter<'a> {
    fn new(settings: &WinnerTakeAllSettings, ratios: &'a [f64], matches: &'a Matches) -> Self {
        let limits = MatchLimits { peak_ratio: 1.0, ..settings.match_limits() };
        Self { widest: MatchFilter::new(matches, &limits), peak_ratio: &matches.peak_ratio, ratios }
    }

    /// How many maps believe the winner of a pixel that passes the widest filter.
    #[inline]
    fn level(&self, pixel: usize) -> usize {
        let ratio = f64::from(self.peak_ratio[pixel]);
        self.ratios.partition_point(|r| ratio >= *r)
    }
}

/// Draws the sections of one row of pixels, and sets how far in front of them the rays are simply free.
#[multiversion(targets("x86_64+avx2"))]
fn draw_row(
    rays: &ViewRays<'_>,
    model: InverseModel<'_>,
    filter: NestedFilter<'_>,
    y: usize,
    row: &mut [PixelReach],
    evidence: &NestedEvidence,
) {
    for (x, reach) in row.iter_mut().enumerate() {
        let pixel = y * rays.rig.width + x;
        let disparity = filter.widest.at(pixel);
        let level = if disparity == NO_MATCH { 0 } else { filter.level(pixel) };
        *reach = if level == 0 {
            PixelReach::NONE
        } else {
            let direction = rays.direction(x as f64, y as f64);
            let offer = |cell, key| evidence.offer(cell, level, key);
            let steps = draw_section(rays, model, direction, f64::from(disparity), offer);
            PixelReach { steps, level: level as i32 }
        };
    }
}
