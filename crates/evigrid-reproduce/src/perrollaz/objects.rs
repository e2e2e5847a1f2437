//! Objects of the worlds in the plans: those that are seen, those that move, and cells inside them that are called
//! free.

use std::collections::BTreeMap;

use anyhow::Result;
use evigrid_grid::PlanSpec;
use evigrid_synth::{Track, tracks};
use evigrid_udisparity::{VisibilityFilteredSettings, VisibilitySettings};

use super::panels::FREE;
use super::scene::{Grids, Seen};
use crate::job::Job;
use crate::table::rounded;

/// Worlds with their frames.
const DRIVES: [(&str, usize); 3] = [("crossing", 100), ("box-and-pedestrian", 50), ("parked-row", 60)];
/// Cells count as occupied from here on.
const OCCUPIED: f32 = 0.5;
/// Frames after which an object that has come into view counts for velocities.
const SETTLED: usize = 10;
/// Objects that are farther are not counted, metres.
const FARTHEST_M: f64 = 15.0;

/// Cells of a plan whose centre lies in an object.
pub fn cells_of<'a>(spec: &'a PlanSpec, object: &'a Track) -> impl Iterator<Item = usize> + 'a {
    let (s, c) = object.yaw_rad.sin_cos();
    (0..spec.cell_count()).filter(move |&cell| {
        let [x, y] = spec.centre_m(cell);
        let (dx, dy) = (x - object.centre_m.x, y - object.centre_m.y);
        let along = [c * dx + s * dy, c * dy - s * dx];
        along[0].abs() <= 0.5 * object.lengths_m.x && along[1].abs() <= 0.5 * object.lengths_m.y
    })
}

/// What is known of one object, summed over frames.
#[derive(Default)]
struct Sums {
    frames: usize,
    cells: usize,
    free: [usize; 2],
    /// Frames in which its largest probability is above a half, before and after the filter.
    found: [usize; 2],
    speed_mps: f64,
    /// Of frames in which it moves and is found: errors of the velocity across the line of sight and along it.
    errors: Vec<[f64; 2]>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut rows = Vec::new();
    for (world, frames) in DRIVES {
        job.say(&format!("synth:{world}, {frames} frames"));
        rows.extend(drive(world, frames)?);
    }
    let header = [
        "world",
        "object",
        "frames_in_view",
        "speed_mps",
        "found_percent",
        "found_filtered_percent",
        "free_inside_percent",
        "free_inside_filtered_percent",
        "velocity_frames",
        "sideways_error_mps",
        "radial_error_mps",
    ];
    job.write_table(&header, rows)
}

fn drive(world: &str, frames: usize) -> Result<Vec<Vec<String>>> {
    let mut grids = Grids::with_filter(world, VisibilitySettings::default(), fine())?;
    let mut all: BTreeMap<String, Sums> = BTreeMap::new();
    for index in 0..frames.min(grids.drive.world.frame_count()) {
        grids.add(index, &mut |seen| {
            let (plain, spec) = Seen::plan(seen.plain)?;
            let (filtered, _) = Seen::plan(seen.filtered)?;
            for object in tracks(&seen.drive.world, &seen.drive.map_from_world, index) {
                let camera = seen.frame.map_from_left().translation.vector;
                let away = [object.centre_m.x - camera.x, object.centre_m.y - camera.y];
                let cells: Vec<usize> = cells_of(&spec, &object).collect();
                let is_near = away[0].hypot(away[1]) < FARTHEST_M && is_in_view(seen, &object);
                if cells.is_empty() || !is_near {
                    continue;
                }
                let sums = all.entry(object.name.clone()).or_default();
                sums.add(&cells, [plain.probabilities(), filtered.probabilities()]);
                let speed = object.velocity_mps.norm();
                sums.speed_mps = sums.speed_mps.max(speed);
                if let (true, true, Some(velocities)) =
                    (object.is_moving, sums.frames > SETTLED, filtered.velocities())
                {
                    // The velocity that most of the probability of its cells has.
                    let mut votes: Vec<([f32; 2], f32)> = Vec::new();
                    for &cell in cells.iter().filter(|cell| filtered.probabilities()[**cell] > OCCUPIED) {
                        let (mode, p) = (velocities[cell].mode_mps, filtered.probabilities()[cell]);
                        match votes.iter_mut().find(|(other, _)| *other == mode) {
                            Some((_, sum)) => *sum += p,
                            None => votes.push((mode, p)),
                        }
                    }
                    if let Some((mode, _)) = votes.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
                        sums.errors.push(errors(*mode, &object, away));
                    }
                }
            }
            Ok(())
        })?;
    }
    Ok(all.into_iter().map(|(name, sums)| sums.row(world, name)).collect())
}

/// Steps of 0.4 m/s up to 8 m/s, so that pedestrians can be told apart.
fn fine() -> VisibilitySettings {
    VisibilitySettings { velocities: 41, velocity_step_mps: 0.4, ..VisibilityFilteredSettings::default().0 }
}

/// Whether the middle of an object is in the image.
fn is_in_view(seen: &Seen<'_>, object: &Track) -> bool {
    let place = seen.frame.map_from_left().inverse() * object.centre_m;
    seen.frame.rig().project(&place).is_some_and(|(x, _)| x >= 0.0 && x < seen.frame.rig().width as f64)
}

/// Errors across the line of sight and along it, metres per second.
fn errors(mode: [f32; 2], object: &Track, away: [f64; 2]) -> [f64; 2] {
    let length = away[0].hypot(away[1]);
    let sight = away.map(|m| m / length);
    let error = [f64::from(mode[0]) - object.velocity_mps.x, f64::from(mode[1]) - object.velocity_mps.y];
    let radial = error[0] * sight[0] + error[1] * sight[1];
    [(error[1] * sight[0] - error[0] * sight[1]).abs(), radial.abs()]
}

impl Sums {
    fn add(&mut self, cells: &[usize], maps: [&[f32]; 2]) {
        self.frames += 1;
        self.cells += cells.len();
        for (n, map) in maps.into_iter().enumerate() {
            self.free[n] += cells.iter().filter(|cell| f64::from(map[**cell]) < FREE).count();
            let largest = cells.iter().map(|cell| map[*cell]).fold(f32::NAN, f32::max);
            self.found[n] += usize::from(largest > OCCUPIED);
        }
    }

    fn row(&self, world: &str, name: String) -> Vec<String> {
        let share = |part: usize, all: usize| rounded(100.0 * part as f64 / all as f64, 1);
        let median = |n: usize| {
            let mut list: Vec<f64> = self.errors.iter().map(|error| error[n]).collect();
            list.sort_by(f64::total_cmp);
            rounded(list.get(list.len() / 2).copied().unwrap_or(f64::NAN), 2)
        };
        let names = [world.to_owned(), name, self.frames.to_string(), rounded(self.speed_mps, 2)];
        let shares = self.found.map(|n| share(n, self.frames)).into_iter();
        let free = self.free.map(|n| share(n, self.cells));
        let velocities = [self.errors.len().to_string(), median(0), median(1)];
        names.into_iter().chain(shares).chain(free).chain(velocities).collect()
    }
}
