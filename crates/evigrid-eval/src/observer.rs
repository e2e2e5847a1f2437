use std::fmt;

use anyhow::Result;
use evigrid_core::{Frame, Matching};
use evigrid_grid::{HybridModel, Layer, Pictures};
use evigrid_metrics::Scores;
use evigrid_results::{MethodMaps, RunInfo, RunResult, SealedFile, StageTime};

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
    /// The 3-D model behind its safety map.
    pub hybrid: LazyModel<'a>,
    /// What it has made of the frame on the way to its map.
    pub pictures: LazyPictures<'a>,
}

/// What a method has made of the last frame on the way to its map, made when it is asked for.
#[derive(Clone, Copy)]
pub struct LazyPictures<'a>(Option<&'a dyn Fn() -> Pictures>);

impl<'a> LazyPictures<'a> {
    /// Nothing.
    pub const NONE: Self = Self(None);

    /// Pictures that `make` makes.
    pub fn new(make: &'a dyn Fn() -> Pictures) -> Self {
        Self(Some(make))
    }

    /// The pictures now.
    pub fn get(&self) -> Pictures {
        self.0.map_or_else(Pictures::default, |make| make())
    }
}

impl fmt::Debug for LazyPictures<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LazyPictures").finish_non_exhaustive()
    }
}

/// The 3-D model behind the safety map of a method, made when it is asked for.
#[derive(Clone, Copy)]
pub struct LazyModel<'a>(Option<&'a dyn Fn() -> Option<HybridModel>>);

impl<'a> LazyModel<'a> {
    /// No model.
    pub const NONE: Self = Self(None);

    /// A model that `make` makes.
    pub fn new(make: &'a dyn Fn() -> Option<HybridModel>) -> Self {
        Self(Some(make))
    }

    /// The model now; `None` if the method makes none.
    pub fn get(&self) -> Option<HybridModel> {
        self.0.and_then(|make| make())
    }
}

impl fmt::Debug for LazyModel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LazyModel").finish_non_exhaustive()
    }
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

    /// After the last frame, with the final maps of every method and the truth. Returned are the files that
    /// were written; when all observers have ended, they get their names together.
    ///
    /// # Errors
    /// If the result cannot be kept.
    fn end(
        &mut self,
        _result: &RunResult,
        _maps: &[MethodMaps<'_>],
        _truth: &Truth,
    ) -> Result<Vec<SealedFile>> {
        Ok(Vec::new())
    }
}
