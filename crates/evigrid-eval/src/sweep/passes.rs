//! Passes over a recording for many points.

use anyhow::Result;
use evigrid_results::{MethodMaps, RunResult};
use rayon::prelude::*;

use super::point::Point;
use super::together::Followed;
use crate::pass::{Entrant, Order, Pass, groups};
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

/// Maps all frames for all points, then scores each and hands it to `write`, from any thread.
///
/// # Errors
/// If a frame cannot be read or mapped, or `write` fails.
pub(super) fn run_pass(
    recording: &Recording,
    points: &[&Point],
    clock: &dyn Clock,
    write: &(dyn Fn(&PointResult<'_>) -> Result<()> + Sync),
    frame_done: &mut dyn FnMut(usize),
) -> Result<()> {
    let mut pass = Pass::new(recording, points.iter().map(|point| point.entrant()).collect())?;
    pass.drive(recording, clock, Order::SideBySide, &mut |_, moment| {
        frame_done(moment.position + 1);
        Ok(())
    })?;
    (0..pass.len()).into_par_iter().try_for_each(|number| {
        let maps = pass.maps(number);
        let run = pass.run_result(number, vec![pass.method_result(number, &maps.layers)]);
        write(&PointResult { point: points[number], run, maps, truth: pass.truth(number) })
    })
}

/// Maps all frames for all points and shows every map after every frame: `follow` gets the number of the point.
///
/// # Errors
/// If a frame cannot be read or mapped, or `follow` fails.
pub(super) fn follow_pass(
    recording: &Recording,
    points: &[&Point],
    clock: &dyn Clock,
    follow: &mut dyn FnMut(usize, &Followed<'_>) -> Result<()>,
) -> Result<()> {
    let mut pass = Pass::new(recording, points.iter().map(|point| point.entrant()).collect())?;
    pass.drive(recording, clock, Order::SideBySide, &mut |pass, moment| {
        (0..pass.len()).try_for_each(|number| {
            let (layers, truth) = (pass.layers(number), pass.truth(number));
            follow(number, &Followed { frame: moment.frame, layers: &layers, truth })
        })
    })
}
