//! Sweeps: a grid of settings x methods x data sets. docs/sweep.md has the plan's format and the files.
//!
//! A plan (`plan_file.rs`, or `--sweep` around a run) becomes points: one method, one recording, all
//! settings, checked before the first frame. The points of one recording with the same frames make a pass
//! (`passes.rs`), or several if their maps take more than 512 MiB.
//!
//! - In a pass a frame is read once, matched once per setting of the matcher and added once to each truth.
//!   Nothing is scored or recorded before the end. The scores of a point are those of a run with its
//!   settings, to the last byte.
//! - Maps are built by a `MapperFamily`: several maps of one method that see the same matches. A family of
//!   one is the method's `Mapper`. Methods may build many maps together where that is cheaper
//!   (`Method::build_family`).
//! - At its end a pass writes each point into `points/HASH/`, run.json last. The hash covers recording,
//!   frames and the settings that the point uses. A point that is there already, made by this version and
//!   commit, is kept. Tables and curves are made from these folders alone, so that a sweep that was killed
//!   cannot end with other files.
//! - [`map_together`] is a sweep without files: whoever wants many maps of one recording gets each when it
//!   is complete.

mod axis;
mod curve_plot;
mod lines;
mod outcome;
mod page;
mod passes;
mod plan;
mod plan_file;
mod point;
mod point_folder;
mod report;
mod together;

use std::path::Path;

use anyhow::{Context, Result};

use evigrid_results::ResultsFolder;

use crate::Clock;
use outcome::Outcome;
use passes::{PointResult, run_pass, split_into_passes};
use point_folder::PointFolders;
use report::Report;

pub use plan::{Sweep, SweepPlan};
pub use together::{Followed, Mapped, follow_together, map_together};

/// How far a sweep is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepStep<'a> {
    /// Left-overs of an earlier sweep that did not finish have been removed: files of these names.
    LeftOver(&'a [String]),
    /// So many of all points are there already.
    Kept {
        /// Points that need not be computed.
        kept: usize,
        /// All points.
        total: usize,
    },
    /// A pass over a recording begins.
    Pass {
        /// Name of the recording.
        dataset: &'a str,
        /// Points that are computed in it.
        points: usize,
        /// Frames of it.
        frames: usize,
    },
    /// So many frames of the pass are done.
    Frame(usize),
}

/// Computes all points of a sweep that the folder `out` does not hold yet, then writes tables and curves of
/// all.
///
/// `build` goes into each point's run.json. A point is kept if it has the same settings hash, and the same
/// version and commit in `build`.
///
/// # Errors
/// If a frame cannot be read or a file cannot be written. The points that were complete by then are kept.
pub fn run_sweep(
    sweep: &Sweep,
    out: &Path,
    build: &serde_json::Value,
    clock: &dyn Clock,
    progress: &mut dyn FnMut(SweepStep<'_>),
) -> Result<()> {
    let (folder, left_over) = ResultsFolder::open_sweep(out)?;
    if !left_over.is_empty() {
        progress(SweepStep::LeftOver(&left_over));
    }
    let report = Report::create(&folder, sweep)?;
    let folders = PointFolders { dir: out.join("points"), build, maps: sweep.plan.maps };
    let total = sweep.points().count();
    let kept = sweep.points().filter(|p| folders.read(p).is_some()).count();
    progress(SweepStep::Kept { kept, total });
    for data in &sweep.recordings {
        let missing = data.points.iter().filter(|p| folders.read(p).is_none()).collect();
        for points in split_into_passes(missing) {
            let info = &points[0].job.info;
            let (dataset, frames) = (info.dataset.as_str(), info.frames.len());
            progress(SweepStep::Pass { dataset, points: points.len(), frames });
            let write = |result: &PointResult<'_>| folders.write(result);
            run_pass(&data.recording, &points, clock, &write, &mut |_, moment| {
                progress(SweepStep::Frame(moment.position + 1));
                Ok(())
            })?;
        }
    }
    let outcomes: Result<Vec<Outcome<'_>>> = sweep
        .points()
        .map(|point| {
            let failed = || format!("cannot read {} again", folders.path(point).display());
            folders.read(point).with_context(failed)
        })
        .collect();
    folder.publish(report.finish(sweep, &outcomes?)?)
}
