//! The files of a sweep whose points are all there: points.csv, sweep.toml, sweep.md, and per data set
//! curves.NAME.csv and curves.NAME.svg.

use anyhow::Result;
use evigrid_grid::LayerKind;
use evigrid_metrics::{METRICS, Metric};
use evigrid_results::{PendingFile, ResultsFolder, SealedFile, files, seal, write_rows, write_text};

use super::curve_plot::draw;
use super::lines::{Line, lines};
use super::outcome::Outcome;
use super::page::page;
use super::plan::Sweep;

/// The files of a sweep, opened before the first frame.
#[derive(Debug)]
pub(super) struct Report {
    points: csv::Writer<PendingFile>,
    plan: PendingFile,
    page: PendingFile,
    curves: Vec<CurveFiles>,
}

/// Table and picture of the curves of one recording.
#[derive(Debug)]
struct CurveFiles {
    table: csv::Writer<PendingFile>,
    picture: PendingFile,
}

impl Report {
    /// Opens all files.
    pub fn create(folder: &ResultsFolder, sweep: &Sweep) -> Result<Self> {
        let table = |name: &str| folder.create(name).map(csv::Writer::from_writer);
        let curves = sweep.recordings.iter().map(|recording| {
            let (csv, svg) =
                (files::SWEEP_CURVES.of(recording.id()), files::SWEEP_PICTURE.of(recording.id()));
            Ok(CurveFiles { table: table(&csv)?, picture: folder.create(&svg)? })
        });
        Ok(Self {
            points: table(files::POINTS)?,
            plan: folder.create(files::SWEEP_PLAN)?,
            page: folder.create(files::SWEEP_PAGE)?,
            curves: curves.collect::<Result<_>>()?,
        })
    }

    /// Writes all files.
    pub fn finish(mut self, sweep: &Sweep, outcomes: &[Outcome<'_>]) -> Result<Vec<SealedFile>> {
        write_rows(&mut self.points, point_rows(sweep, outcomes))?;
        write_text(&mut self.plan, &sweep.plan.to_toml()?)?;
        write_text(&mut self.page, &page(sweep, outcomes))?;
        let mut files = vec![seal(self.points)?, self.plan.seal()?, self.page.seal()?];
        for (recording, mut curves) in sweep.recordings.iter().zip(self.curves) {
            let here = of_recording(outcomes, recording.id());
            let lines = lines(sweep, &here);
            write_rows(&mut curves.table, curve_rows(sweep, &here, &lines))?;
            files.push(seal(curves.table)?);
            // Nothing to see where no map has hits and mistakes: no picture.
            if lines.iter().any(|line| !line.scored().is_empty()) {
                write_text(&mut curves.picture, &draw(recording.id(), &lines)?)?;
                files.push(curves.picture.seal()?);
            }
        }
        Ok(files)
    }
}

/// The outcomes on one recording.
pub(super) fn of_recording<'a>(outcomes: &'a [Outcome<'a>], id: &str) -> Vec<&'a Outcome<'a>> {
    outcomes.iter().filter(|outcome| outcome.point.job.info.dataset == id).collect()
}

/// Names of the swept keys.
pub(super) fn keys(sweep: &Sweep) -> Vec<String> {
    sweep.plan.axes.iter().map(|axis| axis.key.clone()).collect()
}

/// The metrics of a kind of layer that sweeps show.
pub(super) fn metrics_of(kind: LayerKind) -> impl Iterator<Item = &'static Metric> {
    METRICS.iter().filter(move |metric| metric.is_in_sweeps() && metric.of.layer() == Some(kind))
}

/// The kinds of layers that the methods of these points make, in the order of tables.
pub(super) fn kinds(outcomes: &[&Outcome<'_>]) -> impl Iterator<Item = LayerKind> {
    LayerKind::ALL.into_iter().filter(|kind| outcomes.iter().any(|outcome| outcome.layers().contains(kind)))
}

/// points.csv: the swept keys, the columns of the summaries of all kinds that the methods make, the folder.
fn point_rows(sweep: &Sweep, outcomes: &[Outcome<'_>]) -> Vec<Vec<String>> {
    // Where the tolerances of the scores are swept, points have different columns.
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in outcomes.iter().flat_map(|outcome| &outcome.row) {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let header =
        keys(sweep).into_iter().chain(columns.iter().map(|c| (*c).to_owned())).chain(["point".into()]);
    let mut rows = vec![header.collect()];
    for outcome in outcomes {
        let mut row = outcome.values();
        row.extend(columns.iter().map(|column| outcome.cell(column).to_owned()));
        row.push(outcome.point.hash().to_owned());
        rows.push(row);
    }
    rows
}

/// curves.NAME.csv: line by line.
fn curve_rows(sweep: &Sweep, outcomes: &[&Outcome<'_>], lines: &[Line<'_>]) -> Vec<Vec<String>> {
    let scores: Vec<&str> = kinds(outcomes).flat_map(metrics_of).map(|metric| metric.name).collect();
    let header =
        ["line".to_owned()].into_iter().chain(keys(sweep)).chain(scores.iter().map(|s| (*s).to_owned()));
    let mut rows = vec![header.collect()];
    for line in lines {
        for outcome in &line.outcomes {
            let mut row = vec![line.name.clone()];
            row.extend(outcome.values());
            row.extend(scores.iter().map(|column| outcome.cell(column).to_owned()));
            rows.push(row);
        }
    }
    rows
}
