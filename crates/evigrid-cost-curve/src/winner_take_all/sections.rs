//! The sections of the rays around their measured cells, where Elfes' profile is more than simply free.

use evigrid_core::{MatchFilter, Matches, NO_MATCH, StereoRig};
use evigrid_grid::{FrameEvidence, RayWalk, ViewRays, cell_index};
use multiversion::multiversion;

use super::profile::{Profile, ProfileTable};
use super::settings::{Deviation, WinnerTakeAllSettings};
use crate::free_space::{NO_REACH, ReachImage};

/// Pixels whose matches are filtered at once.
const PIXELS: usize = 64;

/// The inverse sensor model of a frame: from a disparity to evidence.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InverseModel<'a> {
    pub settings: &'a WinnerTakeAllSettings,
    pub profiles: &'a ProfileTable,
}

/// Offers the profile of every believable match to the cells around the measured one, and sets how far in
/// front of them the rays are simply free.
pub(crate) fn draw_sections(
    rays: &ViewRays<'_>,
    model: InverseModel<'_>,
    matches: &Matches,
    reach: &mut ReachImage,
    evidence: &FrameEvidence,
) {
    // The filters that a winner-take-all approach relies on (section I-A).
    let filter = MatchFilter::new(matches, &model.settings.match_limits());
    let width = rays.rig.width;
    reach.fill(width, rays.rig.height, |y, row| draw_row(rays, model, filter, y, row, evidence));
}

/// Draws the sections of one row of pixels and sets their reach. Rounding and comparing take far fewer
/// instructions from AVX on; no result depends on it.
#[multiversion(targets("x86_64+avx2"))]
fn draw_row(
    rays: &ViewRays<'_>,
    model: InverseModel<'_>,
    filter: MatchFilter<'_>,
    y: usize,
    row: &mut [i32],
    evidence: &FrameEvidence,
) {
    let mut disparities = [NO_MATCH; PIXELS];
    for (row, x0) in row.chunks_mut(PIXELS).zip((0..).step_by(PIXELS)) {
        let disparities = &mut disparities[..row.len()];
        filter.fill(y * rays.rig.width + x0, disparities);
        for ((reach, &disparity), x) in row.iter_mut().zip(disparities.iter()).zip(x0..) {
            *reach = if disparity == NO_MATCH {
                NO_REACH
            } else {
                let direction = rays.direction(x as f64, y as f64);
                let offer = |cell, key| evidence.offer(cell, key);
                draw_section(rays, model, direction, f64::from(disparity), offer)
            };
        }
    }
}

/// Draws one ray's section, as keys that are offered to cells, and returns the ray's reach: from sensor space
/// to grid space.
#[inline(always)]
pub(crate) fn draw_section(
    rays: &ViewRays<'_>,
    model: InverseModel<'_>,
    direction: [f64; 3],
    disparity: f64,
    offer: impl Fn(usize, i32),
) -> i32 {
    // A ray crosses |dx| + |dy| + |dz| faces per metre of depth; between two points, up to 3 more or fewer.
    let faces_per_metre = direction[0].abs() + direction[1].abs() + direction[2].abs();
    let depth = rays.rig.depth_m(disparity);
    let deviation = model.deviation_cells(rays.rig, depth, faces_per_metre);
    let profile = model.profiles.profile(deviation as f32);
    // Beyond the rays' greatest depth one place is as good as another.
    let in_front = f64::from(profile.in_front() + 2) / faces_per_metre;
    let depth = depth.min(rays.max_depth_m + in_front);
    let measured = rays.at_depth(&direction, depth).map(cell_index);
    let start = depth - in_front;
    if start < rays.max_depth_m {
        let end = (depth + f64::from(profile.behind() + 2) / faces_per_metre).min(rays.max_depth_m);
        let (start, end) = (rays.at_depth(&direction, start.max(0.0)), rays.at_depth(&direction, end));
        draw(RayWalk::towards(rays.spec, start, end, measured), profile, offer);
    }
    rays.steps_to(&measured) - profile.in_front()
}

/// Offers each cell of the section the profile's value at its distance from the measured cell.
#[inline(always)]
fn draw(mut walk: RayWalk, profile: Profile<'_>, offer: impl Fn(usize, i32)) {
    // The section begins with up to 3 cells that are simply free.
    while walk.steps() >= profile.in_front() && walk.next().is_some() {}
    for ((cell, _), &key) in walk.clone().zip(profile.keys_from(walk.steps())) {
        offer(cell, key);
    }
}

impl InverseModel<'_> {
    /// Standard deviation of a measured range, in cells along the ray.
    #[inline(always)]
    fn deviation_cells(&self, rig: &StereoRig, depth_m: f64, faces_per_metre: f64) -> f64 {
        match self.settings.deviation {
            // dl = dz l / z; l / z cancels against the cells per metre of ray.
            Deviation::FollowsRange => {
                let depth_per_pixel = depth_m * depth_m / (rig.baseline_m * rig.focal_px);
                depth_per_pixel * self.settings.disparity_error_px * faces_per_metre
            }
            Deviation::Constant => self.settings.constant_variance_cells.sqrt(),
        }
    }
}
