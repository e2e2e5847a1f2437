use std::borrow::Cow;

use evigrid_core::Matches;
use evigrid_grid::{GridSpec, LogOddsGrid, MapperFamily, NestedEvidence, NestedMaps, View, ViewRays};
use multiversion::multiversion;

use crate::nested_free_space::draw_free_space;
use crate::nested_reach::{NestedReach, PixelReach};
use crate::sections::{InverseModel, draw_section, is_confirmed};
use crate::{ProfileTable, SettingError, WinnerTakeAllSettings};

/// The maps of [`crate::WinnerTakeAll`] for several peak ratios, all other settings being the same (Brandao et al.,
/// section IV-B: 1.5 to 12).
///
/// Matches that pass a peak ratio pass all smaller ones. Every line is therefore drawn once, for as many maps as its
/// match passes the ratio of, and of every cell it is asked which is the highest ratio with a line through it.
#[derive(Debug)]
pub struct PeakRatios {
    settings: WinnerTakeAllSettings,
    /// By rising value.
    ratios: Vec<f64>,
    /// Which of them each member has.
    place: Vec<usize>,
    profiles: ProfileTable,
    reach: NestedReach,
    evidence: NestedEvidence,
    maps: NestedMaps,
}

impl PeakRatios {
    /// Empty maps over a grid, one for each of the peak ratios, at least one; that of `settings` does not count.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(
        spec: GridSpec,
        settings: WinnerTakeAllSettings,
        peak_ratios: &[f64],
    ) -> Result<Self, SettingError> {
        for &peak_ratio in peak_ratios {
            WinnerTakeAllSettings { peak_ratio, ..settings }.checked()?;
        }
        let mut ratios = peak_ratios.to_vec();
        ratios.sort_by(f64::total_cmp);
        let place = peak_ratios.iter().map(|p| ratios.partition_point(|r| r < p)).collect();
        Ok(Self {
            settings,
            place,
            profiles: ProfileTable::new(settings.evidence_bounds()),
            reach: NestedReach::default(),
            evidence: NestedEvidence::new(spec.cell_count(), ratios.len()),
            maps: NestedMaps::unknown(spec, ratios.len()),
            ratios,
        })
    }
}

impl MapperFamily for PeakRatios {
    fn integrate(&mut self, view: &View<'_>) {
        let rays = ViewRays::new(self.maps.spec(), view.rig, view.map_from_left, self.settings.max_depth_m);
        let filters = Filters { settings: &self.settings, ratios: &self.ratios, matches: view.matches };
        let model = InverseModel { settings: &self.settings, profiles: &self.profiles };
        let evidence = &self.evidence;
        self.reach.fill(view.rig.width, view.rig.height, |y, row| {
            draw_row(&rays, model, filters, y, row, evidence);
        });
        draw_free_space(&rays, &self.reach, self.profiles.free(), evidence);
        // One layer more on either side, for what rounding may have put beyond the end of a ray.
        let [layers, ..] = rays.box_in_grid();
        let layers = layers.start.saturating_sub(1)..(layers.end + 1).min(rays.spec.shape()[0]);
        self.evidence.fuse_into(&mut self.maps, self.settings.clamp(), layers);
    }

    fn map(&self, member: usize) -> Cow<'_, LogOddsGrid> {
        Cow::Owned(self.maps.map(self.place[member]))
    }
}

/// What decides how many maps believe a pixel's winner.
#[derive(Debug, Clone, Copy)]
struct Filters<'a> {
    settings: &'a WinnerTakeAllSettings,
    ratios: &'a [f64],
    matches: &'a Matches,
}

impl Filters<'_> {
    /// How many maps believe a pixel's winner. NaN fails every comparison.
    #[inline]
    fn level(&self, pixel: usize) -> usize {
        if !is_confirmed(self.settings, self.matches, pixel) {
            return 0;
        }
        let ratio = f64::from(self.matches.peak_ratio[pixel]);
        self.ratios.partition_point(|r| ratio >= *r)
    }
}

/// Draws the sections of one row of pixels, and sets how far in front of them the rays are simply free.
#[multiversion(targets("x86_64+avx2"))]
fn draw_row(
    rays: &ViewRays<'_>,
    model: InverseModel<'_>,
    filters: Filters<'_>,
    y: usize,
    row: &mut [PixelReach],
    evidence: &NestedEvidence,
) {
    for (x, reach) in row.iter_mut().enumerate() {
        let pixel = y * rays.rig.width + x;
        let level = filters.level(pixel);
        *reach = if level == 0 {
            PixelReach::NONE
        } else {
            let disparity = f64::from(filters.matches.disparity.values()[pixel]);
            let direction = rays.direction(x as f64, y as f64);
            let offer = |cell, key| evidence.offer(cell, level, key);
            PixelReach { steps: draw_section(rays, model, direction, disparity, offer), level: level as i32 }
        };
    }
}
