use std::path::Path;

use anyhow::Result;
use csv::Writer;
use evigrid_grid::LayerKind;
use serde_json::Value;

use crate::map_files::MapFiles;
use crate::plan_tables::{band_rows, reliability_rows, roc_rows};
use crate::safety_tables::{hazard_rows, place_rows};
use crate::tables::{TIMING_COLUMNS, curve_rows, frame_rows, frames_header, summary_rows, timing_rows};
use crate::{
    FrameRow, MethodMaps, PendingFile, ResultsFolder, RunInfo, RunResult, SealedFile, StageTime, TruthFile,
    files, markdown_summary, run_json, seal, write_rows, write_text,
};

/// Parts of the results that a run may leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    /// Tables of all frames, timing.csv and summary.md.
    pub frames: bool,
    /// Maps and truth.
    pub maps: bool,
}

/// Writes the results of a run. All files are opened before the first frame and get their names after the
/// last one.
#[derive(Debug)]
pub struct ResultsWriter {
    info: RunInfo,
    /// Description of the build and the machine in run.json.
    build: Value,
    config: PendingFile,
    run: PendingFile,
    /// Final scores of each kind of layer.
    summaries: Vec<LayerTable>,
    /// Hits against mistakes of each method that has voxels.
    curves: Vec<MethodTable>,
    frames: Option<FrameFiles>,
    maps: Option<MapFiles>,
}

/// A table for one kind of layer.
#[derive(Debug)]
struct LayerTable {
    kind: LayerKind,
    rows: Writer<PendingFile>,
}

/// A table for one method of the run, by its position.
#[derive(Debug)]
struct MethodTable {
    method: usize,
    rows: Writer<PendingFile>,
}

/// Files that follow the frames.
#[derive(Debug)]
struct FrameFiles {
    scores: Vec<LayerTable>,
    timing: Writer<PendingFile>,
    summary: PendingFile,
    safety: Option<SafetyFiles>,
    plans: Option<PlanFiles>,
}

/// Tables of ground plans, frame by frame.
#[derive(Debug)]
struct PlanFiles {
    bands: Writer<PendingFile>,
    reliability: Writer<PendingFile>,
    roc: Writer<PendingFile>,
}

/// Tables of safety maps.
#[derive(Debug)]
struct SafetyFiles {
    places: Writer<PendingFile>,
    hazards: Writer<PendingFile>,
}

impl ResultsWriter {
    /// Opens all files of a run. `build` goes into run.json as it is.
    ///
    /// # Errors
    /// If one cannot be created.
    pub fn create(folder: &ResultsFolder, info: &RunInfo, build: Value, kept: Kept) -> Result<Self> {
        let summary = |kind| Ok(LayerTable { kind, rows: table(folder, files::summary(kind))? });
        let curve = |layer: MethodLayer<'_>| {
            Ok(MethodTable { method: layer.method, rows: table(folder, &files::CURVE.of(layer.name))? })
        };
        let voxels = layers(info).filter(|layer| layer.kind == LayerKind::Voxels);
        Ok(Self {
            info: info.clone(),
            build,
            config: folder.create(files::CONFIG)?,
            run: folder.create(files::RUN)?,
            summaries: LayerKind::ALL.into_iter().map(summary).collect::<Result<_>>()?,
            curves: voxels.map(curve).collect::<Result<_>>()?,
            frames: kept.frames.then(|| FrameFiles::create(folder, info)).transpose()?,
            maps: kept.maps.then(|| MapFiles::create(folder, info)).transpose()?,
        })
    }

    /// Writes the scores after a frame, if the tables of frames are kept.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn frame(&mut self, row: &FrameRow<'_>) -> Result<()> {
        let tables = self.frames.iter_mut().flat_map(|frames| &mut frames.scores);
        for table in tables {
            write_rows(&mut table.rows, frame_rows(&self.info, table.kind, row))?;
        }
        Ok(())
    }

    /// Writes how long the stages of a frame took, and the peak memory of the process so far where the system
    /// tells it.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn times(&mut self, times: &[StageTime], peak_memory_mib: Option<f64>) -> Result<()> {
        match &mut self.frames {
            Some(frames) => write_rows(&mut frames.timing, timing_rows(&self.info, times, peak_memory_mib)),
            None => Ok(()),
        }
    }

    /// Writes the rest of the results. `maps` are the final maps of each method. The files are returned for
    /// [`ResultsFolder::publish`]; run.json is the last of them.
    ///
    /// # Errors
    /// If a file cannot be written, or a method lacks a layer that it should have.
    pub fn finish(
        mut self,
        result: &RunResult,
        maps: &[MethodMaps<'_>],
        truth: Option<TruthFile<'_>>,
    ) -> Result<Vec<SealedFile>> {
        let mut sealed = Vec::new();
        if let Some(files) = self.maps {
            files.finish(&self.info, maps, truth, &mut sealed)?;
        }
        if let Some(frames) = self.frames {
            frames.finish(&self.info, result, &mut sealed)?;
        }
        for mut table in self.summaries {
            if table.kind == LayerKind::Voxels || result.has_scores(table.kind) {
                write_rows(&mut table.rows, summary_rows(&self.info, result, table.kind))?;
                sealed.push(seal(table.rows)?);
            }
        }
        for mut table in self.curves {
            let method = result.methods.get(table.method);
            let scores = method.and_then(|method| method.scores_of(LayerKind::Voxels));
            write_rows(&mut table.rows, curve_rows(scores.and_then(|scores| scores.curve.as_ref())))?;
            sealed.push(seal(table.rows)?);
        }
        write_text(&mut self.config, &self.info.settings.toml)?;
        write_text(&mut self.run, &run_json(&self.info, result, &self.build)?)?;
        sealed.extend([self.config.seal()?, self.run.seal()?]);
        Ok(sealed)
    }
}

impl FrameFiles {
    fn create(folder: &ResultsFolder, info: &RunInfo) -> Result<Self> {
        let is_wanted =
            |kind: &LayerKind| *kind == LayerKind::Voxels || layers(info).any(|layer| layer.kind == *kind);
        let scores = LayerKind::ALL.into_iter().filter(is_wanted).map(|kind| {
            let mut rows = table(folder, files::frames(kind))?;
            write_rows(&mut rows, [frames_header(info, kind)])?;
            Ok(LayerTable { kind, rows })
        });
        let scores = scores.collect::<Result<_>>()?;
        let mut timing = table(folder, files::TIMING)?;
        write_rows(&mut timing, [TIMING_COLUMNS.map(str::to_owned).to_vec()])?;
        let has = |kind: LayerKind| layers(info).any(|layer| layer.kind == kind);
        let safety = has(LayerKind::Safety).then(|| SafetyFiles::create(folder)).transpose()?;
        let plans = has(LayerKind::Plan).then(|| PlanFiles::create(folder)).transpose()?;
        Ok(Self { scores, timing, summary: folder.create(files::SUMMARY_PAGE)?, safety, plans })
    }

    fn finish(mut self, info: &RunInfo, result: &RunResult, sealed: &mut Vec<SealedFile>) -> Result<()> {
        for table in self.scores {
            sealed.push(seal(table.rows)?);
        }
        sealed.push(seal(self.timing)?);
        write_text(&mut self.summary, &markdown_summary(info, result))?;
        sealed.push(self.summary.seal()?);
        if let Some(plans) = self.plans {
            plans.finish(info, result, sealed)?;
        }
        self.safety.map_or(Ok(()), |safety| safety.finish(info, result, sealed))
    }
}

impl SafetyFiles {
    fn create(folder: &ResultsFolder) -> Result<Self> {
        Ok(Self { places: table(folder, files::SAFETY_PLACES)?, hazards: table(folder, files::HAZARDS)? })
    }

    /// Writes the tables that have rows.
    fn finish(self, info: &RunInfo, result: &RunResult, sealed: &mut Vec<SealedFile>) -> Result<()> {
        let tables = [(self.places, place_rows(info, result)), (self.hazards, hazard_rows(info, result))];
        write_tables(tables, sealed)
    }
}

impl PlanFiles {
    fn create(folder: &ResultsFolder) -> Result<Self> {
        Ok(Self {
            bands: table(folder, files::PLAN_BANDS)?,
            reliability: table(folder, files::PLAN_RELIABILITY)?,
            roc: table(folder, files::PLAN_ROC)?,
        })
    }

    /// Writes the tables, if anything was counted.
    fn finish(self, info: &RunInfo, result: &RunResult, sealed: &mut Vec<SealedFile>) -> Result<()> {
        let bands = (self.bands, band_rows(info, result));
        let reliability = (self.reliability, reliability_rows(info, result));
        write_tables([bands, reliability, (self.roc, roc_rows(info, result))], sealed)
    }
}

/// Writes the tables that have rows below their header.
fn write_tables<const N: usize>(
    tables: [(Writer<PendingFile>, Vec<Vec<String>>); N],
    sealed: &mut Vec<SealedFile>,
) -> Result<()> {
    for (mut table, rows) in tables.into_iter().filter(|(_, rows)| rows.len() > 1) {
        write_rows(&mut table, rows)?;
        sealed.push(seal(table)?);
    }
    Ok(())
}

fn table(folder: &ResultsFolder, name: &str) -> Result<Writer<PendingFile>> {
    folder.create(name).map(Writer::from_writer)
}

/// A kind of layer that a method of a run makes.
pub(crate) struct MethodLayer<'a> {
    /// Position of the method in the run.
    pub method: usize,
    pub name: &'a str,
    pub kind: LayerKind,
}

/// The layers of all methods of a run.
pub(crate) fn layers(info: &RunInfo) -> impl Iterator<Item = MethodLayer<'_>> {
    info.methods.iter().enumerate().flat_map(|(method, info)| {
        info.layers.iter().map(move |kind| MethodLayer { method, name: &info.name, kind: *kind })
    })
}

/// Whether a folder holds the maps of all methods of a run.
pub fn has_maps(dir: &Path, info: &RunInfo) -> bool {
    layers(info).all(|layer| dir.join(files::map(layer.kind).of(layer.name)).is_file())
}
