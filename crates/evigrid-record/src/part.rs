//! The parts that a recording is made of. A part writes its entities and says which views show them; recorder
//! and layout know nothing of single parts.

use anyhow::Result;
use evigrid_eval::{Config, Step};
use evigrid_results::{PendingFile, RunInfo, RunResult};
use rerun::{AsComponents, EntityPath, TimePoint};

use crate::blueprint::Pane;
use crate::rrd::{Rrd, Store};

/// Where a part writes to.
pub(crate) struct Out<'a> {
    pub rrd: &'a mut Rrd<PendingFile>,
    pub store: &'a mut Store,
    /// The moment of the current frame; empty before the first and after the last.
    pub at: TimePoint,
}

impl Out<'_> {
    /// Logs components at a path, valid from the current frame on.
    pub fn log(&mut self, path: impl Into<EntityPath>, components: &dyn AsComponents) -> Result<()> {
        self.rrd.log(self.store, path, &self.at, components)
    }

    /// Logs components at a path, valid at all times.
    pub fn always(&mut self, path: impl Into<EntityPath>, components: &dyn AsComponents) -> Result<()> {
        self.rrd.log(self.store, path, &TimePoint::default(), components)
    }
}

/// A run before its first frame.
#[derive(Clone, Copy)]
pub(crate) struct Start<'a> {
    pub info: &'a RunInfo,
    pub config: &'a Config,
}

/// The places of the window, in the order in which they are filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    /// Maps in space: the largest place, tabs.
    Space,
    /// Maps from above, tabs.
    Above,
    /// Text below the maps.
    Text,
    /// Images, one below the other.
    Image,
    /// Scores over the frames, tabs.
    Scores,
    /// Curves of the whole run.
    Curve,
}

/// The facts of a run that decide on its layout.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown {
    /// Whether there is a truth.
    pub scored: bool,
    /// First and last cell along x where any map is occupied.
    pub extent_x: (usize, usize),
}

/// One part of a recording.
pub(crate) trait Part {
    /// Logs everything that holds at all times.
    fn begin(&mut self, _out: &mut Out<'_>) -> Result<()> {
        Ok(())
    }

    /// Logs a frame.
    fn frame(&mut self, _out: &mut Out<'_>, _step: &Step<'_>) -> Result<()> {
        Ok(())
    }

    /// Logs the result of the run.
    fn end(&mut self, _out: &mut Out<'_>, _result: &RunResult) -> Result<()> {
        Ok(())
    }

    /// First and last cell along x where this part has something to look at.
    fn extent_x(&self) -> Option<(usize, usize)> {
        None
    }

    /// The views that show this part, with their places.
    fn panes(&self, _shown: &Shown) -> Vec<(Slot, Pane)> {
        Vec::new()
    }
}
