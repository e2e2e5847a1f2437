use anyhow::{Context, Result};
use evigrid_results::{
    FrameRow, Kept, MethodMaps, ResultsFolder, ResultsWriter, RunInfo, RunResult, SealedFile, StageTime,
};

use crate::{Observer, Step, Truth, peak_memory_mib};

/// Writes the tables and map files of a run.
#[derive(Debug)]
pub struct TableWriter {
    /// `None` once the files are whole.
    writer: Option<ResultsWriter>,
}

impl TableWriter {
    /// Opens all files of a run. `build` goes into run.json as it is.
    ///
    /// # Errors
    /// If one cannot be created.
    pub fn create(folder: &ResultsFolder, info: &RunInfo, build: serde_json::Value) -> Result<Self> {
        let kept = Kept { frames: true, maps: true };
        Ok(Self { writer: Some(ResultsWriter::create(folder, info, build, kept)?) })
    }

    fn writer(&mut self) -> Result<&mut ResultsWriter> {
        self.writer.as_mut().context("the tables of this run are already complete")
    }
}

impl Observer for TableWriter {
    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        self.writer()?.frame(&FrameRow {
            frame: step.frame.index(),
            stamp_ns: step.frame.stamp_ns(),
            scans: step.truth.scans(),
            matched_pixels: step.matching.map_or(0, |m| m.matches.disparity.valid_count()),
            scores: step.methods.iter().map(|m| m.scores).collect(),
        })
    }

    fn times(&mut self, times: &[StageTime]) -> Result<()> {
        self.writer()?.times(times, peak_memory_mib())
    }

    fn end(&mut self, result: &RunResult, maps: &[MethodMaps<'_>], truth: &Truth) -> Result<Vec<SealedFile>> {
        let writer = self.writer.take().context("the tables of this run are already complete")?;
        writer.finish(result, maps, truth.file())
    }
}
