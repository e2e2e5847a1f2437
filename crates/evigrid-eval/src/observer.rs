use anyhow::Result;
use evigrid_core::{Frame, Matches};
use evigrid_grid::{GridSpec, LogOddsGrid};
use evigrid_truth::LaserTruth;

use crate::{Config, MethodResult, Scores, SealedFile};

/// What is known before the first frame.
#[derive(Debug, Clone)]
pub struct RunInfo {
    /// Name of the recording.
    pub dataset: String,
    /// Layout of the recording.
    pub layout: String,
    /// Frame numbers, in the order of the run.
    pub frames: Vec<usize>,
    /// Names of the methods.
    pub methods: Vec<String>,
    /// The grid of all maps.
    pub spec: GridSpec,
    /// All settings.
    pub config: Config,
}

/// One method after one frame.
#[derive(Debug)]
pub struct MethodStep<'a> {
    /// Name of the method.
    pub method: &'a str,
    /// Its map so far.
    pub map: &'a LogOddsGrid,
    /// Its scores so far; `None` while there was no laser scan.
    pub scores: Option<&'a Scores>,
}

/// Everything after one frame.
#[derive(Debug)]
pub struct Step<'a> {
    /// Position in the run, from 0.
    pub position: usize,
    /// The frame.
    pub frame: &'a Frame,
    /// What matching found.
    pub matches: &'a Matches,
    /// The reference so far; `None` while there was no laser scan.
    pub truth: Option<&'a LaserTruth>,
    /// The methods, in the order of the run.
    pub methods: &'a [MethodStep<'a>],
}

/// How long one stage of one frame took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageTime {
    /// Frame number.
    pub frame: usize,
    /// Position of the method in the run; `None` for what all methods share.
    pub method: Option<usize>,
    /// read, match, integrate, truth, score or record.
    pub stage: &'static str,
    /// Duration, milliseconds.
    pub ms: f64,
}

/// What a run found.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// One entry per method.
    pub methods: Vec<MethodResult>,
    /// How many frames were mapped.
    pub frames: usize,
    /// Numbers of the frames that had no laser scan: they were mapped, but are not in the reference.
    pub without_laser: Vec<usize>,
    /// Wall time of the whole loop, milliseconds.
    pub wall_ms: f64,
    /// Stages in the order of a frame, with the sum of their times over all frames and methods, milliseconds.
    pub stage_totals: Vec<(&'static str, f64)>,
}

/// Something that follows a run: a table, a recording, a progress bar. All methods do nothing unless written.
pub trait Observer {
    /// Before the first frame.
    ///
    /// # Errors
    /// If the run cannot be followed; it then does not begin.
    fn begin(&mut self, _info: &RunInfo) -> Result<()> {
        Ok(())
    }

    /// After each frame.
    ///
    /// # Errors
    /// If what was seen cannot be kept; the run then stops.
    fn frame(&mut self, _step: &Step<'_>) -> Result<()> {
        Ok(())
    }

    /// After [`Self::frame`] of all observers: how long the frame's stages took, that call included.
    ///
    /// # Errors
    /// As [`Self::frame`].
    fn times(&mut self, _times: &[StageTime]) -> Result<()> {
        Ok(())
    }

    /// After the last frame, with the final maps and the reference. Returned are the files that were written; when all
    /// observers have ended, they get their names together.
    ///
    /// # Errors
    /// If the result cannot be kept.
    fn end(
        &mut self,
        _result: &RunResult,
        _maps: &[&LogOddsGrid],
        _truth: Option<&LaserTruth>,
    ) -> Result<Vec<SealedFile>> {
        Ok(Vec::new())
    }
}
