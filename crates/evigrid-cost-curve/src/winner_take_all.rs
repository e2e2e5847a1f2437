use evigrid_core::{Matches, Pose, StereoRig};
use evigrid_grid::{FrameEvidence, GridSpec, LogOddsGrid, Mapper, RayWalk, View};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{Deviation, Profile, ProfileTable, SettingError, WinnerTakeAllSettings};

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
            profiles: ProfileTable::new(settings.evidence_bounds()),
            evidence: FrameEvidence::new(spec.cell_count()),
            map: LogOddsGrid::unknown(spec),
        })
    }
}

impl Mapper for WinnerTakeAll {
    fn integrate(&mut self, view: &View<'_>) {
        let rays = Rays::new(&self.settings, &self.profiles, self.map.spec(), view.rig, view.map_from_left);
        let width = view.rig.width;
        (0..view.rig.height).into_par_iter().for_each(|y| {
            for x in 0..width {
                let pixel = y * width + x;
                // The filters that a winner-take-all approach relies on (section I-A).
                if !passes_filters(&self.settings, view.matches, pixel) {
                    continue;
                }
                // From sensor space to grid space: the ray of the pixel, the cell that the winner falls into, and
                // Elfes' occupancy profile around it (eqs 1 to 3).
                let disparity = f64::from(view.matches.disparity.values()[pixel]);
                let ray = rays.ray(x, y, disparity);
                // Line drawing; where lines share a cell, the largest P wins.
                draw(&self.evidence, ray);
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
struct Ray<'a> {
    walk: RayWalk,
    /// Steps from the measured cell to the end of the line; negative where the line ends in front of it.
    measured_to_end: i32,
    profile: Profile<'a>,
}

/// What all rays of one view have in common.
struct Rays<'a> {
    settings: &'a WinnerTakeAllSettings,
    profiles: &'a ProfileTable,
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
        profiles: &'a ProfileTable,
        spec: &'a GridSpec,
        rig: &'a StereoRig,
        map_from_left: &Pose,
    ) -> Self {
        let to_cells = |v: Vector3<f64>| map_from_left.rotation * v / spec.cell_size_m();
        Self {
            settings,
            profiles,
            spec,
            rig,
            origin: spec.to_cells(map_from_left.translation.vector.into()),
            per_column: to_cells(Vector3::x() / rig.focal_px),
            per_row: to_cells(Vector3::y() / rig.focal_px),
            first: to_cells(rig.ray(0.0, 0.0)),
        }
    }

    fn ray(&self, x: usize, y: usize, disparity: f64) -> Ray<'_> {
        let direction = self.first + self.per_column * x as f64 + self.per_row * y as f64;
        let at_depth = |z: f64| -> [f64; 3] { std::array::from_fn(|a| self.origin[a] + z * direction[a]) };
        // A ray crosses |dx| + |dy| + |dz| cells per metre of depth.
        let cells_per_depth = direction.abs().sum();
        let depth = self.rig.depth_m(disparity);
        let profile = self.profiles.profile(self.deviation_cells(depth, cells_per_depth) as f32);
        // One step to spare: where exactly the last face lies does not matter, `draw` counts cells.
        let behind = f64::from(profile.behind() + 3) / cells_per_depth;
        let end = at_depth((depth + behind).min(self.settings.max_depth_m));
        Ray {
            walk: RayWalk::in_cells(self.spec, self.origin, end),
            measured_to_end: steps_beyond(self.origin, at_depth(depth), end),
            profile,
        }
    }

    /// Standard deviation of a measured range, in cells along the ray.
    fn deviation_cells(&self, depth: f64, cells_per_depth: f64) -> f64 {
        match self.settings.deviation {
            // dl = dz l / z; l / z cancels against the cells per metre of ray.
            Deviation::FollowsRange => {
                let depth_per_pixel = depth * depth / (self.rig.baseline_m * self.rig.focal_px);
                depth_per_pixel * self.settings.disparity_error_px * cells_per_depth
            }
            Deviation::Constant => self.settings.constant_variance_cells.sqrt(),
        }
    }
}

/// How many cells the end of a line lies beyond a point on it, counted along the line from `origin` (all in units of
/// cells); very negative for a point at infinity.
fn steps_beyond(origin: [f64; 3], point: [f64; 3], end: [f64; 3]) -> i32 {
    let steps = |to: [f64; 3]| -> f64 {
        (0..3).map(|a| (to[a].floor() - origin[a].floor()).abs()).filter(|d| !d.is_nan()).sum()
    };
    (steps(end) - steps(point)) as i32
}

/// Offers each cell of the line the profile's value at its distance from the measured cell.
#[inline]
fn draw(evidence: &FrameEvidence, ray: Ray<'_>) {
    for (cell, steps_to_end) in ray.walk {
        let steps = steps_to_end.saturating_sub(ray.measured_to_end);
        if steps < -ray.profile.behind() {
            break;
        }
        evidence.offer(cell, ray.profile.key(steps));
    }
}
