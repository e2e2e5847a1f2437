//! The winner-take-all mapper, which draws free space cell by cell, against whole lines: every pixel's line
//! is walked from the camera to its end, and every cell of it is offered the profile's value. Cells must
//! agree to the last bit.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{RIG, Shot, accepted, bits, integrate, shot, spec};
use evigrid_core::{Disparity, Matches, Pose, level_camera};
use evigrid_cost_curve::{Deviation, Profile, ProfileTable, WinnerTakeAll, WinnerTakeAllSettings};
use evigrid_grid::{FrameEvidence, LogOddsGrid, RayWalk};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// A pixel's line, from the camera to the greatest depth.
struct Line<'a> {
    from: Vector3<f64>,
    to: Vector3<f64>,
    measured: [i64; 3],
    profile: Profile<'a>,
}

impl Line<'_> {
    /// The key that the line offers to a cell that it crosses.
    fn key(&self, cell: usize) -> Option<i32> {
        let camera = cell_of(self.from);
        let from_camera = |cell: [i64; 3]| (0..3).map(|a| (cell[a] - camera[a]).abs()).sum::<i64>();
        let steps = from_camera(self.measured) - from_camera(spec().voxel(cell).map(|v| v as i64));
        (steps >= i64::from(-self.profile.behind())).then(|| self.profile.key(steps.min(1_000_000) as i32))
    }

    /// The part of the line that lies within a cell, as a fraction of its length; negative if it misses the
    /// cell.
    fn overlap(&self, cell: usize) -> f64 {
        let (centre, half) = (spec().centre_m(cell), spec().cell_size_m() / 2.0);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (a, centre) in centre.iter().enumerate() {
            let (d, from) = (self.to[a] - self.from[a], self.from[a]);
            let (t0, t1) = ((centre - half - from) / d, (centre + half - from) / d);
            (enter, leave) = (enter.max(t0.min(t1)), leave.min(t0.max(t1)));
        }
        leave - enter
    }
}

fn cell_of(point: Vector3<f64>) -> [i64; 3] {
    spec().to_cells(point.into()).map(|v| v.floor() as i64)
}

/// The lines of all believable matches.
fn lines<'a>(settings: &WinnerTakeAllSettings, profiles: &'a ProfileTable, shot: &Shot) -> Vec<Line<'a>> {
    let line = |pixel: usize| {
        let ray = RIG.ray((pixel % RIG.width) as f64, (pixel / RIG.width) as f64);
        let (ray, from) = (shot.pose.rotation * ray, shot.pose.translation.vector);
        let depth = RIG.depth_m(f64::from(shot.matches.disparity.values()[pixel]));
        let deviation = match settings.deviation {
            Deviation::FollowsRange => {
                let depth_per_pixel = depth * depth / (RIG.baseline_m * RIG.focal_px);
                depth_per_pixel * settings.disparity_error_px * ray.abs().sum() / spec().cell_size_m()
            }
            Deviation::Constant => settings.constant_variance_cells.sqrt(),
        };
        let measured = cell_of(from + ray * depth.min(1e6));
        Line {
            from,
            to: from + ray * settings.max_depth_m,
            measured,
            profile: profiles.profile(deviation as f32),
        }
    };
    (0..RIG.width * RIG.height).filter(|&pixel| accepted(settings, &shot.matches, pixel)).map(line).collect()
}

fn draw_whole(settings: &WinnerTakeAllSettings, lines: &[Line<'_>]) -> LogOddsGrid {
    let spec = spec();
    let (mut map, mut evidence) = (LogOddsGrid::unknown(spec), FrameEvidence::new(spec.cell_count()));
    for line in lines {
        let walk = RayWalk::new(&spec, line.from.into(), line.to.into()).map(|(cell, _)| cell);
        walk.map_while(|cell| Some((cell, line.key(cell)?)))
            .for_each(|(cell, key)| evidence.offer(cell, key));
    }
    evidence.fuse_into(&mut map, settings.clamp());
    map
}

fn check(settings: &WinnerTakeAllSettings, shot: &Shot) -> Result<(), TestCaseError> {
    let profiles = ProfileTable::new(settings.evidence_bounds());
    let lines = lines(settings, &profiles, shot);
    let slow = draw_whole(settings, &lines);
    let mut fast = WinnerTakeAll::new(spec(), *settings).unwrap();
    integrate(&mut fast, shot);
    for cell in 0..spec().cell_count() {
        let (found, expected) = (fast.map().log_odds(cell), slow.log_odds(cell));
        if found != expected {
            // A line that only touches a cell may count as crossing it or not.
            let crossing = lines.iter().filter(|line| line.overlap(cell) > 1e-9);
            let touching = lines.iter().filter(|line| line.overlap(cell).abs() <= 1e-9);
            let least = crossing.filter_map(|line| line.key(cell)).max();
            let allowed: Vec<_> =
                touching.filter_map(|line| line.key(cell)).filter(|k| Some(*k) > least).collect();
            let found_key = found.map(FrameEvidence::key);
            prop_assert!(
                found_key == least || found_key.is_some_and(|k| allowed.contains(&k)),
                "{cell}: {found:?}, expected {expected:?}, {} lines touch it",
                allowed.len()
            );
        }
    }
    Ok(())
}

fn settings() -> impl Strategy<Value = WinnerTakeAllSettings> {
    (any::<bool>(), any::<bool>(), 1.5..15.0_f64, 1.0..4.0_f64).prop_map(
        |(follows_range, left_right_check, max_depth_m, peak_ratio)| WinnerTakeAllSettings {
            deviation: if follows_range { Deviation::FollowsRange } else { Deviation::Constant },
            left_right_check,
            max_depth_m,
            peak_ratio,
            ..WinnerTakeAllSettings::default()
        },
    )
}

/// Cameras anywhere in the grid or beside it, turned anywhere.
fn poses() -> impl Strategy<Value = Pose> {
    let at = [-2.0..14.0_f64, -4.0..4.0, -3.0..3.0];
    (at, [-3.2..3.2_f64, -1.6..1.6, -3.2..3.2]).prop_map(|(at, turn)| {
        let turn = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
        Pose::from_parts(Vector3::from(at).into(), turn * level_camera())
    })
}

/// Surfaces instead of noise: a slanted plane with a box in front of it.
fn surfaces() -> impl Strategy<Value = Matches> {
    let hole = prop::collection::vec(0..10_u8, RIG.width * RIG.height);
    ([0.3..4.0_f64, -0.2..0.2, -0.2..0.2], 0..RIG.width, 0..RIG.height, 2.0..8.0_f32, hole).prop_map(
        |([d, dx, dy], left, top, near, hole)| {
            let disparity = (0..RIG.width * RIG.height).map(|pixel| {
                let (x, y) = (pixel % RIG.width, pixel / RIG.width);
                let boxed = (left..left + 5).contains(&x) && (top..top + 4).contains(&y);
                let plane = (d + dx * x as f64 + dy * y as f64).max(0.0) as f32;
                if hole[pixel] < 3 {
                    f32::NAN
                } else if boxed {
                    near
                } else {
                    plane
                }
            });
            Matches::from_disparity(Disparity::new(RIG.width, RIG.height, disparity.collect()).unwrap())
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    #[test]
    fn noise_equals_whole_lines(settings in settings(), shot in shot()) {
        check(&settings, &shot)?;
    }

    #[test]
    fn noise_seen_from_anywhere_equals_whole_lines(settings in settings(), shot in shot(), pose in poses()) {
        check(&settings, &Shot { pose, ..shot })?;
    }

    #[test]
    fn surfaces_equal_whole_lines(settings in settings(), matches in surfaces(), pose in poses()) {
        check(&settings, &Shot { pose, matches })?;
    }

    /// Rays along faces and through edges of the grid: a camera on a lattice point that looks along an axis.
    #[test]
    fn a_level_camera_on_the_lattice_equals_whole_lines(
        settings in settings(),
        matches in surfaces(),
        at in [0..30_i32, -7..8_i32, -5..6_i32],
    ) {
        let at = Point3::from(at.map(|k| f64::from(k) * 0.4));
        check(&settings, &Shot { pose: Pose::from_parts(at.coords.into(), level_camera()), matches })?;
    }

    #[test]
    fn any_number_of_threads_makes_the_same_map(shots in prop::collection::vec(shot(), 1..4)) {
        let maps = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut mapper = WinnerTakeAll::new(spec(), WinnerTakeAllSettings::default()).unwrap();
            pool.install(|| shots.iter().for_each(|shot| integrate(&mut mapper, shot)));
            bits(mapper.map())
        });
        prop_assert_eq!(&maps[0], &maps[1]);
        prop_assert_eq!(&maps[0], &maps[2]);
    }
}
