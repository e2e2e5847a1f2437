//! Passes over a recording for many points.

use anyhow::Result;
use evigrid_results::{MethodMaps, RunResult};
use rayon::prelude::*;

use super::point::Point;
use crate::pass::{Entrant, Moment, Order, Pass, groups};
use crate::{Clock, Recording, Truth};

/// Memory that the maps of one pass may need, bytes. One point is always computed.
const PASS_BYTES: usize = 512 << 20;
/// Memory that a cell of a point needs at most: its log-odds and its evidence in a frame; in a truth of its
/// own also log-odds, evidence and two marks. Bytes.
const CELL_BYTES: usize = 8 + 10;

/// Splits the points of one recording into passes: those of one pass see the same frames and fit into memory.
/// Points that share their matching come one after the other.
pub(super) fn split_into_passes(points: Vec<&Point>) -> Vec<Vec<&Point>> {
    let entrants: Vec<Entrant<'_>> = points.iter().map(|point| point.entrant()).collect();
    let mut passes = Vec::new();
    for same_frames in groups(&entrants, |a, b| a.job.info.frames == b.job.info.frames) {
        let here: Vec<Entrant<'_>> = same_frames.iter().map(|&i| entrants[i]).collect();
        let (mut pass, mut bytes) = (Vec::new(), 0);
        for i in groups(&here, Entrant::same_matches).into_iter().flatten() {
            let more = CELL_BYTES * here[i].job.info.spec.cell_count();
            if !pass.is_empty() && bytes + more > PASS_BYTES {
                passes.push(std::mem::take(&mut pass));
                bytes = 0;
            }
            bytes += more;
            pass.push(points[same_frames[i]]);
        }
        passes.push(pass);
    }
    passes
}

/// The finding of one point.
pub(super) struct PointResult<'a> {
    /// The point.
    pub point: &'a Point,
    /// The result that a run of it would have.
    pub run: RunResult,
    /// Its maps.
    pub maps: MethodMaps<'a>,
    /// Its truth.
    pub truth: &'a Truth,
}

/// Sees all maps after every frame.
pub(super) type Follow<'a> = dyn FnMut(&Pass<'_>, &Moment<'_>) -> Result<()> + 'a;

/// Maps all frames for all points, which `follow` sees, then scores each and hands it to `write`, from any thread.
///
/// # Errors
/// If a frame cannot be read or mapped, or `follow` or `write` fails.
pub(super) fn run_pass(
    recording: &Recording,
    points: &[&Point],
    clock: &dyn Clock,
    write: &(dyn Fn(&PointResult<'_>) -> Result<()> + Sync),
    follow: &mut Follow<'_>,
) -> Result<()> {
    let mut pass = Pass::new(recording, points.iter().map(|point| point.entrant()).collect())?;
    pass.drive(recording, clock, Order::SideBySide, &mut |pass, moment| follow(pass, &moment))?;
    (0..pass.len()).into_par_iter().try_for_each(|number| {
        let maps = pass.maps(number);
        let run = pass.run_result(number, vec![pass.method_result(number, &maps.layers)]);
        write(&PointResult { point: points[number], run, maps, truth: pass.truth(number) })
    })
}
