//! Rows and headers of the tables of a run.

use std::io::Write as _;

use anyhow::{Context, Result, anyhow};
use csv::Writer;
use evigrid_grid::{LayerKind, probability};
use evigrid_metrics::{Curve, Score, Scores};

use crate::info::scores_of;
use crate::{FrameRow, MethodInfo, PendingFile, RunInfo, RunResult, SealedFile, StageTime};

/// Columns that name a row of a summary.
pub(crate) const SUMMARY_KEYS: [&str; 3] = ["dataset", "method", "frames"];
/// The last column of summary.csv.
pub(crate) const WITHOUT_LASER: &str = "frames_without_laser";
/// Columns of timing.csv.
pub(crate) const TIMING_COLUMNS: [&str; 5] = ["frame", "method", "stage", "ms", "peak_memory_mib"];

fn owned(columns: &[&str]) -> Vec<String> {
    columns.iter().map(|column| (*column).to_owned()).collect()
}

/// Cells of these columns; empty where there is no reference or a rate is undefined (0 / 0).
fn cells(scores: Option<&Scores>, columns: &[String]) -> Vec<String> {
    let cell = |column: &String| scores?.score(column).map(Score::cell);
    columns.iter().map(|column| cell(column).unwrap_or_default()).collect()
}

/// Header of the table of all frames for a kind of layer.
pub(crate) fn frames_header(info: &RunInfo, kind: LayerKind) -> Vec<String> {
    let mut header = owned(&["dataset", "method", "frame", "stamp_ns"]);
    header.extend(Scores::columns(kind, &info.tolerances_m, false));
    if kind == LayerKind::Voxels {
        header.extend(owned(&["scans", "matched_pixels"]));
    }
    header
}

/// Rows of one frame: of all methods for voxels, else of those that make such a map.
pub(crate) fn frame_rows(info: &RunInfo, kind: LayerKind, frame: &FrameRow<'_>) -> Vec<Vec<String>> {
    let columns = Scores::columns(kind, &info.tolerances_m, false);
    let row = |(method, scores): (&MethodInfo, &&[Scores])| {
        let mut row = vec![info.dataset.clone(), method.name.clone()];
        row.extend([frame.frame.to_string(), frame.stamp_ns.to_string()]);
        row.extend(cells(scores_of(scores, kind), &columns));
        if kind == LayerKind::Voxels {
            row.extend([frame.scans, frame.matched_pixels].map(|n| n.to_string()));
        }
        row
    };
    let methods = info.methods.iter().zip(&frame.scores);
    methods.filter(|(m, _)| kind == LayerKind::Voxels || m.layers.contains(&kind)).map(row).collect()
}

/// Rows of timing.csv for some stages.
pub(crate) fn timing_rows(
    info: &RunInfo,
    times: &[StageTime],
    peak_memory_mib: Option<f64>,
) -> Vec<Vec<String>> {
    let memory = peak_memory_mib.map_or(String::new(), |m| format!("{m:.1}"));
    let row = |t: &StageTime| {
        let method = t.method.map_or(String::new(), |m| info.methods[m].name.clone());
        vec![t.frame.to_string(), method, t.stage.to_owned(), format!("{:.3}", t.ms), memory.clone()]
    };
    times.iter().map(row).collect()
}

/// Header of the table of final scores for a kind of layer.
pub fn summary_header(info: &RunInfo, kind: LayerKind) -> Vec<String> {
    let mut header = owned(&SUMMARY_KEYS);
    header.extend(Scores::columns(kind, &info.tolerances_m, true));
    if kind == LayerKind::Voxels {
        header.push(WITHOUT_LASER.to_owned());
    }
    header
}

/// The table of final scores for a kind of layer: header, then one row per method.
pub(crate) fn summary_rows(info: &RunInfo, result: &RunResult, kind: LayerKind) -> Vec<Vec<String>> {
    let columns = Scores::columns(kind, &info.tolerances_m, true);
    let mut rows = vec![summary_header(info, kind)];
    for method in &result.methods {
        let mut row = vec![info.dataset.clone(), method.method.clone(), result.frames.to_string()];
        row.extend(cells(method.scores_of(kind), &columns));
        if kind == LayerKind::Voxels {
            row.push(result.without_laser.len().to_string());
        }
        rows.push(row);
    }
    rows
}

/// The table of hits against mistakes: header, then one row per threshold.
pub(crate) fn curve_rows(curve: Option<&Curve>) -> Vec<Vec<String>> {
    let mut rows =
        vec![owned(&["threshold", "threshold_log_odds", "hits", "mistakes", "precision", "recall"])];
    if let Some(curve) = curve {
        for point in &curve.points {
            let (hits, all) = (point.hits as f64, (point.hits + point.mistakes) as f64);
            rows.push(vec![
                format!("{:.6}", probability(f64::from(point.log_odds))),
                format!("{:.1}", point.log_odds),
                point.hits.to_string(),
                point.mistakes.to_string(),
                rate(hits / all),
                rate(hits / curve.true_cells as f64),
            ]);
        }
    }
    rows
}

fn rate(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.6}") }
}

/// Writes rows to a table and flushes them.
///
/// # Errors
/// If they cannot be written.
pub fn write_rows(
    writer: &mut Writer<PendingFile>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<()> {
    let failed = writer.get_ref().failed();
    for row in rows {
        writer.write_record(row).with_context(|| failed.clone())?;
    }
    writer.flush().context(failed)
}

/// Writes text to a file.
///
/// # Errors
/// If it cannot be written.
pub fn write_text(file: &mut PendingFile, text: &str) -> Result<()> {
    file.write_all(text.as_bytes()).with_context(|| file.failed())
}

/// Ends a table, as [`PendingFile::seal`] ends a file.
///
/// # Errors
/// If what was written does not reach the disk.
pub fn seal(writer: Writer<PendingFile>) -> Result<SealedFile> {
    let failed = writer.get_ref().failed();
    writer.into_inner().map_err(|e| anyhow!("{}", e.error())).context(failed)?.seal()
}
