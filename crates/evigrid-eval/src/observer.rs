use anyhow::Result;
use evigrid_core::{Frame, Matching};
use evigrid_grid::Layer;
use evigrid_metrics::Scores;
use evigrid_results::{RunInfo, RunResult, SealedFile, StageTime};

use crate::{Config, Truth};

/// One method after one frame.
#[derive(Debug)]
pub struct MethodStep<'a> {
    /// Name of the method.
    pub method: &'a str,
    /// Its layers so far.
    pub layers: &'a [Layer<'a>],
    /// Its scores so far: one entry per layer that there is a truth for.
    pub scores: &'a [Scores],
}

/// Everything after one frame.
#[derive(Debug)]
pub struct Step<'a> {
    /// Position in the run, from 0.
    pub position: usize,
    /// The frame.
    pub frame: &'a Frame,
    /// The result of matching; `None` if no method needed it.
    pub matching: Option<&'a Matching>,
    /// The truth so far.
    pub truth: &'a Truth,
    /// The methods, in the order of the run.
    pub methods: &'a [MethodStep<'a>],
}

/// A follower of a run: a table, a recording, a progress bar. All methods do nothing unless written.
pub trait Observer {
    /// Before the first frame.
    ///
    /// # Errors
    /// If the run cannot be followed; it then does not begin.
    fn begin(&mut self, _info: &RunInfo, _config: &Config) -> Result<()> {
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

    /// After the last frame, with the final layers of every method and the truth. Returned are the files that
    /// were written; when all observers have ended, they get their names together.
    ///
    /// # Errors
    /// If the result cannot be kept.
    fn end(
        &mut self,
        _result: &RunResult,
        _layers: &[Vec<Layer<'_>>],
        _truth: &Truth,
    ) -> Result<Vec<SealedFile>> {
        Ok(Vec::new())
    }
}
