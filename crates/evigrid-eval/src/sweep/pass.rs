//! One pass over a recording for many points.

use std::borrow::Cow;

use anyhow::Result;
use evigrid_core::Frame;
use evigrid_grid::LogOddsGrid;
use evigrid_replay::Sequence;
use evigrid_truth::LaserTruth;
use rayon::prelude::*;

use super::point::Point;
use crate::ground_truth::GroundTruth;
use crate::method::Family;
use crate::pair_matcher::{PairMatcher, view};
use crate::plan::map_frame;
use crate::prefetch::read_ahead;
use crate::{Clock, MethodResult, RunResult};

/// What the maps of one pass may need, bytes. One point is always computed.
const PASS_BYTES: usize = 512 << 20;
/// What a cell of a point needs at most: its log-odds and its evidence in a frame; in a reference of its own also
/// log-odds, evidence and two marks. Bytes.
const CELL_BYTES: usize = 8 + 10;

/// Splits the points of one recording into passes: those of one pass see the same frames and fit into memory. Points
/// that share their matching come one after the other.
pub(super) fn split_into_passes(mut points: Vec<&Point>) -> Vec<Vec<&Point>> {
    let mut passes: Vec<Vec<&Point>> = Vec::new();
    while let Some(&first) = points.first() {
        let (mut same, others) =
            points.into_iter().partition::<Vec<_>, _>(|p| p.info.frames == first.info.frames);
        points = others;
        let mut kinds: Vec<&Point> = Vec::new();
        same.sort_by_cached_key(|p| position(&mut kinds, p, same_matches));
        let (mut pass, mut bytes) = (Vec::new(), 0);
        for point in same {
            let more = CELL_BYTES * point.info.spec.cell_count();
            if !pass.is_empty() && bytes + more > PASS_BYTES {
                passes.push(std::mem::take(&mut pass));
                bytes = 0;
            }
            bytes += more;
            pass.push(point);
        }
        passes.push(pass);
    }
    passes
}

/// The position of the first of `kinds` that is the same as a point; if there is none, the point is added to them.
fn position<'a>(kinds: &mut Vec<&'a Point>, point: &'a Point, same: fn(&Point, &Point) -> bool) -> usize {
    let found = kinds.iter().position(|kind| same(kind, point));
    found.unwrap_or_else(|| {
        kinds.push(point);
        kinds.len() - 1
    })
}

fn same_matches(a: &Point, b: &Point) -> bool {
    a.info.config.stereo == b.info.config.stereo && a.info.config.input == b.info.config.input
}

fn same_truth(a: &Point, b: &Point) -> bool {
    a.info.config.grid == b.info.config.grid && a.info.config.truth == b.info.config.truth
}

/// What one point has found.
pub(super) struct PointResult<'a> {
    /// The point.
    pub point: &'a Point,
    /// What a run of it would have found.
    pub run: RunResult,
    /// Its map.
    pub map: Cow<'a, LogOddsGrid>,
    /// Its reference, if there was any laser scan.
    pub truth: Option<&'a LaserTruth>,
}

/// Maps all frames for all points, then scores each and hands it to `write`, from any thread.
pub(super) fn run_pass(
    sequence: &dyn Sequence,
    points: &[&Point],
    clock: &dyn Clock,
    write: &(dyn Fn(&PointResult<'_>) -> Result<()> + Sync),
    frame_done: &mut dyn FnMut(usize),
) -> Result<()> {
    let frames = &points[0].info.frames;
    let map_from_world = map_frame(sequence, frames)?;
    let mut pass = Pass::new(points)?;
    std::thread::scope(|scope| -> Result<()> {
        let read = read_ahead(scope, sequence, frames, map_from_world, clock);
        for (position, frame) in read.iter().enumerate() {
            pass.step(&frame?.0)?;
            frame_done(position + 1);
        }
        Ok(())
    })?;
    pass.finish(write)
}

/// The state of a pass between frames.
struct Pass<'a> {
    points: &'a [&'a Point],
    matchers: Vec<Matcher>,
    truths: Vec<GroundTruth>,
    /// The reference of each point.
    truth_of: Vec<usize>,
}

/// One setting of the matcher with all maps that are made from it.
struct Matcher {
    matcher: PairMatcher,
    families: Vec<Family>,
}

impl<'a> Pass<'a> {
    fn new(points: &'a [&'a Point]) -> Result<Self> {
        let mut kinds = Vec::new();
        let matcher_of: Vec<usize> = points.iter().map(|p| position(&mut kinds, p, same_matches)).collect();
        let matchers = kinds.iter().enumerate().map(|(number, kind)| {
            let members: Vec<usize> = (0..points.len()).filter(|&i| matcher_of[i] == number).collect();
            Matcher::new(kind, points, &members)
        });
        let matchers = matchers.collect::<Result<_>>()?;
        let mut kinds = Vec::new();
        let truth_of = points.iter().map(|p| position(&mut kinds, p, same_truth)).collect();
        let truths = kinds.iter().map(|kind| Ok(GroundTruth::new(kind.info.spec, kind.info.config.truth)?));
        Ok(Self { points, matchers, truths: truths.collect::<Result<_>>()?, truth_of })
    }

    /// One frame: truth, and for every setting of the matcher match and integrate.
    fn step(&mut self, frame: &Frame) -> Result<()> {
        self.truths.iter_mut().for_each(|truth| truth.add(frame));
        self.matchers.iter_mut().try_for_each(|matcher| matcher.step(frame))
    }

    fn finish(&self, write: &(dyn Fn(&PointResult<'_>) -> Result<()> + Sync)) -> Result<()> {
        let families: Vec<&Family> = self.matchers.iter().flat_map(|m| &m.families).collect();
        let members =
            families.iter().flat_map(|f| f.members.iter().enumerate().map(move |(n, &i)| (*f, n, i)));
        let members: Vec<_> = members.collect();
        members
            .into_par_iter()
            .try_for_each(|(family, number, i)| write(&self.result(i, family.mapper.map(number))))
    }

    fn result<'b>(&'b self, i: usize, map: Cow<'b, LogOddsGrid>) -> PointResult<'b> {
        let (point, truth) = (self.points[i], &self.truths[self.truth_of[i]]);
        let (reference, tolerances) = (truth.reference(), &point.info.config.score.tolerances_m);
        let run = RunResult {
            methods: vec![MethodResult::of(point.method.name(), &map, reference.as_ref(), tolerances)],
            frames: point.info.frames.len(),
            without_laser: truth.without_laser().to_vec(),
            wall_ms: 0.0,
            stage_totals: Vec::new(),
        };
        PointResult { point, run, map, truth: truth.if_any() }
    }
}

impl Matcher {
    fn new(kind: &Point, points: &[&Point], members: &[usize]) -> Result<Self> {
        let infos: Vec<_> = members.iter().map(|&i| (i, points[i].method, &points[i].info)).collect();
        Ok(Self { matcher: PairMatcher::new(&kind.info.config)?, families: Family::build(&infos)? })
    }

    fn step(&mut self, frame: &Frame) -> Result<()> {
        let keep_volume = self.families.iter().any(|f| f.mapper.needs_volume());
        let matching = self.matcher.run(frame, keep_volume)?;
        let view = view(frame, &matching);
        self.families.par_iter_mut().for_each(|family| family.mapper.integrate(&view));
        self.matcher.recycle(matching);
        Ok(())
    }
}
