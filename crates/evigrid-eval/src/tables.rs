//! The tables of a run: frames.csv, timing.csv, summary.csv, summary.md, curve.<method>.csv, and the maps, the
//! reference, config.toml and run.json beside them. Columns are documented in docs/metrics.md.

use std::fmt::Write as _;
use std::io::Write as _;

use anyhow::{Context, Result};
use csv::Writer;
use evigrid_grid::{LogOddsGrid, probability};
use evigrid_metrics::Curve;
use evigrid_truth::LaserTruth;
use serde_json::json;

use crate::{
    MethodResult, MethodStep, Observer, OutputSettings, PendingFile, ResultsFolder, RunInfo, RunResult,
    Scores, SealedFile, StageTime, Step, peak_memory_mib, write_map, write_truth,
};

/// Writes the tables of a run. All files are opened before the first frame and get their names after the last one.
#[derive(Debug)]
pub struct TableWriter {
    /// `None` once the files have their names.
    tables: Option<Tables>,
    info: RunInfo,
}

#[derive(Debug)]
struct Tables {
    frames: Writer<PendingFile>,
    timing: Writer<PendingFile>,
    summary: Writer<PendingFile>,
    markdown: PendingFile,
    config: PendingFile,
    run: PendingFile,
    curves: Vec<Writer<PendingFile>>,
    maps: Vec<PendingFile>,
    truth: PendingFile,
    /// What run.json says of the build and the machine.
    build: serde_json::Value,
}

impl TableWriter {
    /// Opens all files of a run. `build` goes into run.json as it is.
    ///
    /// # Errors
    /// If one cannot be created.
    pub fn create(folder: &ResultsFolder, info: &RunInfo, build: serde_json::Value) -> Result<Self> {
        let table = |name: &str| folder.create(name).map(Writer::from_writer);
        let per_method = |kind: &str, ending: &str| -> Vec<String> {
            info.methods.iter().map(|m| format!("{kind}.{m}.{ending}")).collect()
        };
        let tables = Tables {
            frames: table("frames.csv")?,
            timing: table("timing.csv")?,
            summary: table("summary.csv")?,
            markdown: folder.create("summary.md")?,
            config: folder.create("config.toml")?,
            run: folder.create("run.json")?,
            curves: per_method("curve", "csv").iter().map(|n| table(n)).collect::<Result<_>>()?,
            maps: per_method("map", "npz").iter().map(|n| folder.create(n)).collect::<Result<_>>()?,
            truth: folder.create("truth.npz")?,
            build,
        };
        Ok(Self { tables: Some(tables), info: info.clone() })
    }

    fn tables(&mut self) -> Result<&mut Tables> {
        self.tables.as_mut().context("the tables of this run are already complete")
    }
}

impl Tables {
    /// Writes what is known at the end; run.json is the last to get its name.
    fn finish(
        mut self,
        info: &RunInfo,
        result: &RunResult,
        maps: &[&LogOddsGrid],
        truth: Option<&LaserTruth>,
    ) -> Result<Vec<SealedFile>> {
        write_rows(&mut self.summary, summary_rows(info, result))?;
        for (writer, method) in self.curves.iter_mut().zip(&result.methods) {
            write_rows(writer, curve_rows(method.curve.as_ref()))?;
        }
        let text = markdown_summary(info, result);
        write_text(&mut self.markdown, &text)?;
        write_text(&mut self.config, &info.config.to_toml()?)?;
        write_text(&mut self.run, &run_json(info, result, &self.build)?)?;
        let mut files: Vec<SealedFile> =
            self.maps.into_iter().zip(maps).map(|(file, map)| write_map(file, map)).collect::<Result<_>>()?;
        if let Some(truth) = truth {
            files.push(write_truth(self.truth, truth)?);
        }
        for table in [self.frames, self.timing, self.summary].into_iter().chain(self.curves) {
            files.push(seal(table)?);
        }
        for text in [self.markdown, self.config, self.run] {
            files.push(text.seal()?);
        }
        Ok(files)
    }
}

/// Writes what is left of a run of one method when it is a point of a sweep: everything but what follows the frames. The
/// map and the reference are written if they are given.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write_point(
    folder: &ResultsFolder,
    info: &RunInfo,
    result: &RunResult,
    map: Option<&LogOddsGrid>,
    truth: Option<&LaserTruth>,
    build: &serde_json::Value,
) -> Result<Vec<SealedFile>> {
    let table = |name: &str, rows: Vec<Vec<String>>| {
        let mut writer = Writer::from_writer(folder.create(name)?);
        write_rows(&mut writer, rows)?;
        seal(writer)
    };
    let text = |name: &str, text: &str| {
        let mut file = folder.create(name)?;
        write_text(&mut file, text)?;
        file.seal()
    };
    let mut files = Vec::new();
    for method in &result.methods {
        let rows = curve_rows(method.curve.as_ref());
        files.push(table(&format!("curve.{}.csv", method.method), rows)?);
        if let Some(map) = map {
            files.push(write_map(folder.create(&format!("map.{}.npz", method.method))?, map)?);
        }
    }
    if let Some(truth) = truth {
        files.push(write_truth(folder.create("truth.npz")?, truth)?);
    }
    files.push(table("summary.csv", summary_rows(info, result))?);
    files.push(text("config.toml", &info.config.to_toml()?)?);
    files.push(text("run.json", &run_json(info, result, build)?)?);
    Ok(files)
}

impl Observer for TableWriter {
    fn begin(&mut self, info: &RunInfo) -> Result<()> {
        let tables = self.tables()?;
        write_rows(&mut tables.frames, [frames_header(info)])?;
        let header = ["frame", "method", "stage", "ms", "peak_memory_mib"].map(str::to_owned);
        write_rows(&mut tables.timing, [header.to_vec()])
    }

    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        let rows: Vec<_> = step.methods.iter().map(|m| frame_row(&self.info, step, m)).collect();
        write_rows(&mut self.tables()?.frames, rows)
    }

    fn times(&mut self, times: &[StageTime]) -> Result<()> {
        let memory = peak_memory_mib().map_or(String::new(), |m| format!("{m:.1}"));
        let row = |t: &StageTime| {
            let method = t.method.map_or(String::new(), |m| self.info.methods[m].clone());
            vec![t.frame.to_string(), method, t.stage.to_owned(), format!("{:.3}", t.ms), memory.clone()]
        };
        let rows: Vec<_> = times.iter().map(row).collect();
        write_rows(&mut self.tables()?.timing, rows)
    }

    fn end(
        &mut self,
        result: &RunResult,
        maps: &[&LogOddsGrid],
        truth: Option<&LaserTruth>,
    ) -> Result<Vec<SealedFile>> {
        let tables = self.tables.take().context("the tables of this run are already complete")?;
        tables.finish(&self.info, result, maps, truth)
    }
}

const COUNT_COLUMNS: [&str; 7] =
    ["hits", "mistakes", "mistakes_observed", "missed", "precision", "recall", "f1"];

/// Names of the columns that [`score_cells`] fills.
fn score_columns(info: &RunInfo) -> Vec<String> {
    let more =
        ["true_cells", "observed_cells", "missed_unknown", "touched", "precision_observed", "f1_observed"];
    let tolerant = info
        .config
        .score
        .tolerances_m
        .iter()
        .flat_map(|t| ["accuracy", "completeness", "f_score"].map(|name| format!("{name}_{t}m")));
    COUNT_COLUMNS.iter().chain(&more).map(|s| (*s).to_owned()).chain(tolerant).collect()
}

/// The scores as cells of a table; empty where there is no reference or a rate is undefined (0 / 0).
fn score_cells(scores: Option<&Scores>, tolerances: usize) -> Vec<String> {
    let Some(s) = scores else { return vec![String::new(); COUNT_COLUMNS.len() + 6 + 3 * tolerances] };
    let c = &s.counts;
    let (precision_observed, f1_observed) = c.observed_precision_and_f1();
    let whole = |values: &[usize]| values.iter().map(usize::to_string).collect::<Vec<_>>();
    let mut cells = whole(&[c.hits, c.mistakes, c.mistakes_observed, c.missed()]);
    cells.extend([c.precision(), c.recall(), c.f1()].map(rate));
    cells.extend(whole(&[s.true_cells, s.observed_cells, c.missed_unknown, c.touched]));
    cells.extend([precision_observed, f1_observed].map(rate));
    cells.extend(s.tolerant.iter().flat_map(|t| [t.accuracy, t.completeness, t.f_score].map(rate)));
    cells
}

fn rate(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.6}") }
}

fn frames_header(info: &RunInfo) -> Vec<String> {
    let mut header = ["dataset", "method", "frame", "stamp_ns"].map(str::to_owned).to_vec();
    header.extend(score_columns(info));
    header.extend(["scans", "matched_pixels"].map(str::to_owned));
    header
}

fn frame_row(info: &RunInfo, step: &Step<'_>, method: &MethodStep<'_>) -> Vec<String> {
    let frame = step.frame;
    let mut row = vec![info.dataset.clone(), method.method.to_owned()];
    row.extend([frame.index().to_string(), frame.stamp_ns().to_string()]);
    row.extend(score_cells(method.scores, info.config.score.tolerances_m.len()));
    let scans = step.truth.map_or(0, LaserTruth::scans);
    row.extend([scans.to_string(), step.matches.disparity.valid_count().to_string()]);
    row
}

pub(crate) fn summary_header(info: &RunInfo) -> Vec<String> {
    let mut header = ["dataset", "method", "frames"].map(str::to_owned).to_vec();
    header.extend(score_columns(info));
    header.extend(["curve_area", "average_precision", "frames_without_laser"].map(str::to_owned));
    header
}

fn summary_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let rows = result.methods.iter().map(|m| summary_row(info, result, m));
    std::iter::once(summary_header(info)).chain(rows).collect()
}

fn summary_row(info: &RunInfo, result: &RunResult, method: &MethodResult) -> Vec<String> {
    let mut row = vec![info.dataset.clone(), method.method.clone(), result.frames.to_string()];
    row.extend(score_cells(method.scores.as_ref(), info.config.score.tolerances_m.len()));
    let curve = method.curve.as_ref();
    row.push(curve.map_or(String::new(), |c| rate(c.area())));
    row.push(curve.map_or(String::new(), |c| rate(c.average_precision())));
    row.push(result.without_laser.len().to_string());
    row
}

fn curve_rows(curve: Option<&Curve>) -> Vec<Vec<String>> {
    let header = ["threshold", "threshold_log_odds", "hits", "mistakes", "precision", "recall"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for point in curve.iter().flat_map(|c| c.points.iter().map(|p| (p, c.true_cells))) {
        let (p, true_cells) = point;
        let (hits, all) = (p.hits as f64, (p.hits + p.mistakes) as f64);
        rows.push(vec![
            format!("{:.6}", probability(f64::from(p.log_odds))),
            format!("{:.1}", p.log_odds),
            p.hits.to_string(),
            p.mistakes.to_string(),
            rate(hits / all),
            rate(hits / true_cells as f64),
        ]);
    }
    rows
}

/// The result as a page that a person reads.
pub fn markdown_summary(info: &RunInfo, result: &RunResult) -> String {
    let mut text = String::new();
    let [nx, ny, nz] = info.spec.shape();
    let c = info.spec.cell_size_m();
    let first = info.frames.first().copied().unwrap_or(0);
    let last = info.frames.last().copied().unwrap_or(0);
    let _ = writeln!(
        text,
        "# {}\n\n{} frames ({first} to {last}), {} x {} x {} m in cells of {c} m.\n",
        info.dataset,
        result.frames,
        nx as f64 * c,
        ny as f64 * c,
        nz as f64 * c
    );
    let Some(scores) = result.methods.iter().find_map(|m| m.scores.as_ref()) else {
        text.push_str("No laser scan came with these frames: the maps are not scored.\n");
        return text;
    };
    let _ = writeln!(
        text,
        "The laser says: {} occupied cells, {} observed.\n",
        scores.true_cells, scores.observed_cells
    );
    let tolerances: String =
        scores.tolerant.iter().map(|t| format!(" F within {} m |", t.tolerance_m)).collect();
    let _ = writeln!(
        text,
        "| method | hits | mistakes | of them observed | missed | precision | recall | F1 |{tolerances} curve area |"
    );
    let _ = writeln!(text, "|{}", " --- |".repeat(9 + scores.tolerant.len()));
    for method in &result.methods {
        text.push_str(&markdown_row(method));
    }
    if !result.without_laser.is_empty() {
        let _ = writeln!(
            text,
            "\nFrames without a laser scan (mapped, but not in the reference): {}.",
            result.without_laser.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
        );
    }
    text.push_str(
        "\nHits: occupied in the map and for the laser. Mistakes: occupied in the map alone. \
         Missed: occupied for the laser alone.\n",
    );
    text
}

fn markdown_row(method: &MethodResult) -> String {
    let (Some(s), Some(curve)) = (&method.scores, &method.curve) else { return String::new() };
    let c = &s.counts;
    let tolerant: String = s.tolerant.iter().map(|t| format!(" {:.3} |", t.f_score)).collect();
    format!(
        "| {} | {} | {} | {} | {} | {:.3} | {:.3} | {:.3} |{tolerant} {:.3} |\n",
        method.method,
        c.hits,
        c.mistakes,
        c.mistakes_observed,
        c.missed(),
        c.precision(),
        c.recall(),
        c.f1(),
        curve.area()
    )
}

/// Version of the tables of a run, in run.json. It rises when a column or a key changes its meaning or its name;
/// `evigrid compare` refuses runs of another one. New columns and keys leave it as it is.
pub(crate) const RESULTS_FORMAT: u64 = 1;

/// run.json: what was run, with what, on what machine.
///
/// # Errors
/// Never for finite settings.
pub fn run_json(info: &RunInfo, result: &RunResult, build: &serde_json::Value) -> Result<String> {
    let settings = serde_json::to_value(&info.config)?;
    let value = json!({
        "format": RESULTS_FORMAT,
        "build": build,
        "dataset": info.dataset,
        "layout": info.layout,
        "frames": {
            "first": info.frames.first(),
            "last": info.frames.last(),
            "count": info.frames.len(),
            "stride": info.config.run.stride,
            "without_laser": result.without_laser,
        },
        "methods": info.methods,
        "settings_hash": settings_hash(info)?,
        "settings": settings,
    });
    Ok(serde_json::to_string_pretty(&value)? + "\n")
}

/// Two runs with the same hash were made under the same conditions: recording, frames and all settings, but not
/// where the recording lies or what else was written.
pub(crate) fn settings_hash(info: &RunInfo) -> Result<String> {
    let mut config = info.config.clone();
    config.run.dataset.clone_from(&info.dataset);
    config.output = OutputSettings::default();
    let text = format!("{}{:?}", config.to_toml()?, info.frames);
    Ok(format!("{:016x}", fnv1a(text.as_bytes())))
}

/// FNV-1a, 64 bits: tells whether two runs had the same settings.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

pub(crate) fn write_rows(
    writer: &mut Writer<PendingFile>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<()> {
    let failed = writer.get_ref().failed();
    for row in rows {
        writer.write_record(row).with_context(|| failed.clone())?;
    }
    writer.flush().context(failed)
}

pub(crate) fn write_text(file: &mut PendingFile, text: &str) -> Result<()> {
    file.write_all(text.as_bytes()).with_context(|| file.failed())
}

pub(crate) fn seal(writer: Writer<PendingFile>) -> Result<SealedFile> {
    let failed = writer.get_ref().failed();
    writer.into_inner().map_err(|e| anyhow::anyhow!("{}", e.error())).context(failed)?.seal()
}
