use evigrid_core::{Matches, Pose, StereoRig};
use evigrid_grid::{FrameEvidence, GridSpec, LogOddsGrid, Mapper, RayWalk, View};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{Deviation, ProfileTable, SettingError, WinnerTakeAllSettings};

/// Occupancy mapping from the winner of each pixel (Brandao et al., section II-A and the baseline of section IV).
#[derive(Debug)]
pub struct WinnerTakeAll {
    settings: WinnerTakeAllSettings,
    profiles: ProfileTable,
    evidence: FrameEvidence,
    map: LogOddsGrid,
}

impl WinnerTakeAll {
    /// An empty map over a grid.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: WinnerTakeAllSettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        Ok(Self {
            settings,
            profiles: ProfileTable::new(settings.clamp()),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }
}

impl Mapper for WinnerTakeAll {
    fn integrate(&mut self, view: &View<'_>) {
        let rays = Rays::new(&self.settings, self.map.spec(), view.rig, view.map_from_left);
        let width = view.rig.width;
        (0..view.rig.height).into_par_iter().for_each(|y| {
            for x in 0..width {
                let pixel = y * width + x;
                // The filters that a winner-take-all approach relies on (section I-A).
                if !passes_filters(&self.settings, view.matches, pixel) {
                    continue;
                }
                // From sensor space to grid space: the ray of the pixel, and the cell that the winner falls into.
                let disparity = f64::from(view.matches.disparity.values()[pixel]);
                let ray = rays.ray(x, y, disparity);
                // Elfes' occupancy profile around it (eqs 1 to 3), line by line, the largest P winning a cell.
                draw(&self.evidence, &self.profiles, ray);
            }
        });
        // Fusion over frames: log-odds add up.
        self.evidence.fuse_into(&mut self.map, self.settings.clamp());
    }

    fn map(&self) -> &LogOddsGrid {
        &self.map
    }
}

/// Whether a pixel's winner is to be believed. NaN fails every comparison.
fn passes_filters(settings: &WinnerTakeAllSettings, matches: &Matches, pixel: usize) -> bool {
    let confirmed = !settings.left_right_check
        || matches.left_right_difference_px[pixel] <= settings.left_right_tolerance_px;
    confirmed && f64::from(matches.peak_ratio[pixel]) >= settings.peak_ratio
}

/// A pixel's line through the grid.
struct Ray {
    walk: RayWalk,
    /// Steps from the last drawn cell to the measured one: 0 unless the measurement lies beyond the largest depth.
    beyond: usize,
    /// Standard deviation of the measurement along the ray, cells.
    deviation_cells: f32,
}

/// What all rays of one view have in common.
struct Rays<'a> {
    settings: &'a WinnerTakeAllSettings,
    spec: &'a GridSpec,
    rig: &'a StereoRig,
    /// Camera centre in units of cells.
    origin: [f64; 3],
    /// Change of the viewing ray (scaled to depth 1, map frame, cells) per column and per row, and its value at (0, 0).
    per_column: Vector3<f64>,
    per_row: Vector3<f64>,
    first: Vector3<f64>,
}

impl<'a> Rays<'a> {
    fn new(
        settings: &'a WinnerTakeAllSettings,
        spec: &'a GridSpec,
        rig: &'a StereoRig,
        map_from_left: &Pose,
    ) -> Self {
        let to_cells = |v: Vector3<f64>| map_from_left.rotation * v / spec.cell_size_m();
        Self {
            settings,
            spec,
            rig,
            origin: spec.to_cells(map_from_left.translation.vector.into()),
            per_column: to_cells(Vector3::x() / rig.focal_px),
            per_row: to_cells(Vector3::y() / rig.focal_px),
            first: to_cells(rig.ray(0.0, 0.0)),
        }
    }

    fn ray(&self, x: usize, y: usize, disparity: f64) -> Ray {
        let direction = self.first + self.per_column * x as f64 + self.per_row * y as f64;
        let at_depth = |z: f64| -> [f64; 3] { std::array::from_fn(|a| self.origin[a] + z * direction[a]) };
        let depth = self.rig.depth_m(disparity);
        let drawn = depth.min(self.settings.max_depth_m);
        let beyond = if depth > drawn { steps(at_depth(drawn), at_depth(depth)) } else { 0 };
        // A ray crosses |dx| + |dy| + |dz| cells per unit of depth.
        let cells_per_depth = direction.abs().sum();
        let deviation_cells = match self.settings.deviation {
            // dl = dz l / z, and l / z cancels against the cells per metre of ray.
            Deviation::FollowsRange => {
                let per_pixel = depth * depth / (self.rig.baseline_m * self.rig.focal_px);
                per_pixel * self.settings.disparity_error_px * cells_per_depth
            }
            Deviation::Constant => self.settings.constant_variance_cells.sqrt(),
        };
        let walk = RayWalk::in_cells(self.spec, self.origin, at_depth(drawn));
        Ray { walk, beyond, deviation_cells: deviation_cells as f32 }
    }
}

/// Cells that a straight line crosses from one point to the next, both in units of cells; saturates for points at
/// infinity.
fn steps(from: [f64; 3], to: [f64; 3]) -> usize {
    let sum: f64 = (0..3).map(|a| to[a].floor() - from[a].floor()).map(f64::abs).filter(|d| !d.is_nan()).sum();
    sum as usize
}

/// Offers each cell of the line the profile's value at its distance from the measured cell.
#[inline]
fn draw(evidence: &FrameEvidence, profiles: &ProfileTable, ray: Ray) {
    let row = profiles.row(ray.deviation_cells);
    for (cell, steps_to_end) in ray.walk {
        let steps = (steps_to_end as usize).saturating_add(ray.beyond);
        evidence.offer(cell, row.get(steps).copied().unwrap_or(profiles.free()));
    }
}
