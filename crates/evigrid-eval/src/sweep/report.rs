//! What a sweep writes when all points are there: points.csv, sweep.toml, sweep.md, and per data set curves.NAME.csv and
//! curves.NAME.svg.

use std::fmt::Write as _;

use anyhow::Result;

use super::curve_plot::draw;
use super::outcome::Outcome;
use super::plan::Sweep;
use super::point::text;
use crate::tables::{seal, write_rows, write_text};
use crate::{PendingFile, ResultsFolder, SealedFile};

/// The files of a sweep, opened before the first frame.
#[derive(Debug)]
pub(super) struct Report {
    points: csv::Writer<PendingFile>,
    plan: PendingFile,
    markdown: PendingFile,
    /// Per recording: table and picture.
    curves: Vec<(csv::Writer<PendingFile>, PendingFile)>,
}

impl Report {
    /// Opens all files.
    pub fn create(folder: &ResultsFolder, sweep: &Sweep) -> Result<Self> {
        let table = |name: &str| folder.create(name).map(csv::Writer::from_writer);
        let curves = sweep.recordings.iter().map(|r| {
            let id = &r.sequence.info().id;
            Ok((table(&format!("curves.{id}.csv"))?, folder.create(&format!("curves.{id}.svg"))?))
        });
        Ok(Self {
            points: table("points.csv")?,
            plan: folder.create("sweep.toml")?,
            markdown: folder.create("sweep.md")?,
            curves: curves.collect::<Result<_>>()?,
        })
    }

    /// Writes all files.
    pub fn finish(mut self, sweep: &Sweep, outcomes: &[Outcome<'_>]) -> Result<Vec<SealedFile>> {
        write_rows(&mut self.points, point_rows(sweep, outcomes))?;
        write_text(&mut self.plan, &sweep.plan.to_toml()?)?;
        write_text(&mut self.markdown, &markdown(sweep, outcomes))?;
        let mut files = vec![seal(self.points)?, self.plan.seal()?, self.markdown.seal()?];
        for (recording, (mut table, mut picture)) in sweep.recordings.iter().zip(self.curves) {
            let id = &recording.sequence.info().id;
            let here: Vec<_> = outcomes.iter().filter(|o| o.point.info.dataset == *id).collect();
            let lines = lines(sweep, &here);
            write_rows(&mut table, curve_rows(sweep, &lines))?;
            files.push(seal(table)?);
            // Nothing to see without any laser scan: no picture.
            if lines.iter().any(|line| !line.scored().is_empty()) {
                write_text(&mut picture, &draw(id, &lines)?)?;
                files.push(picture.seal()?);
            }
        }
        Ok(files)
    }
}

/// Names of the swept keys.
fn keys(sweep: &Sweep) -> Vec<String> {
    sweep.plan.axes.iter().map(|a| a.key.clone()).collect()
}

/// The values of a point as cells.
fn values(outcome: &Outcome<'_>) -> Vec<String> {
    outcome.point.values.iter().map(|v| v.as_ref().map(text).unwrap_or_default()).collect()
}

/// points.csv: the swept keys, all columns of summary.csv, the folder.
fn point_rows(sweep: &Sweep, outcomes: &[Outcome<'_>]) -> Vec<Vec<String>> {
    // Where the tolerances of the scores are swept, points have different columns.
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in outcomes.iter().flat_map(|o| &o.row) {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let header =
        keys(sweep).into_iter().chain(columns.iter().map(|c| (*c).to_owned())).chain(["point".into()]);
    let mut rows = vec![header.collect()];
    for outcome in outcomes {
        let mut row = values(outcome);
        row.extend(columns.iter().map(|c| outcome.cell(c).to_owned()));
        row.push(outcome.point.hash.clone());
        rows.push(row);
    }
    rows
}

/// Points of one method that differ in one key.
pub(super) struct Line<'a> {
    /// Method, and the values of the other keys.
    pub name: String,
    /// In the order of the key's values.
    pub outcomes: Vec<&'a Outcome<'a>>,
}

impl Line<'_> {
    /// Mistakes and hits of the points that were scored.
    pub fn scored(&self) -> Vec<(f64, f64)> {
        self.outcomes.iter().filter_map(|o| Some((o.number("mistakes")?, o.number("hits")?))).collect()
    }
}

/// The lines of one recording: along the key with the most values, one for each method and combination of the others.
fn lines<'a>(sweep: &Sweep, outcomes: &[&'a Outcome<'a>]) -> Vec<Line<'a>> {
    let axes = &sweep.plan.axes;
    let along = (0..axes.len()).rev().max_by_key(|&i| axes[i].values.len());
    let mut lines: Vec<Line<'a>> = Vec::new();
    for outcome in outcomes {
        let mut name = outcome.point.method.name().to_owned();
        for (i, (axis, value)) in axes.iter().zip(&outcome.point.values).enumerate() {
            if let (true, Some(value)) = (Some(i) != along, value) {
                let key = axis.key.rsplit('.').next().unwrap_or(&axis.key);
                let _ = write!(name, ", {key} {}", text(value));
            }
        }
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.outcomes.push(outcome),
            None => lines.push(Line { name, outcomes: vec![outcome] }),
        }
    }
    lines
}

/// curves.NAME.csv: line by line.
fn curve_rows(sweep: &Sweep, lines: &[Line<'_>]) -> Vec<Vec<String>> {
    const SCORES: [&str; 5] = ["hits", "mistakes", "precision", "recall", "f1"];
    let header = ["line".to_owned()].into_iter().chain(keys(sweep)).chain(SCORES.map(str::to_owned));
    let mut rows = vec![header.collect()];
    for line in lines {
        for outcome in &line.outcomes {
            let mut row = vec![line.name.clone()];
            row.extend(values(outcome));
            row.extend(SCORES.map(|column| outcome.cell(column).to_owned()));
            rows.push(row);
        }
    }
    rows
}

/// Rows of sweep.md per data set; the table of all is points.csv.
const MARKDOWN_ROWS: usize = 40;

/// The sweep as a page that a person reads.
fn markdown(sweep: &Sweep, outcomes: &[Outcome<'_>]) -> String {
    let mut page = format!("# Sweep {}\n\n{} points.\n", sweep.name(), outcomes.len());
    for axis in &sweep.plan.axes {
        let (first, last) = (&axis.values[0], &axis.values[axis.values.len() - 1]);
        let _ = write!(
            page,
            "\n- `{}`: {} values, {} to {}",
            axis.key,
            axis.values.len(),
            text(first),
            text(last)
        );
    }
    page.push('\n');
    for recording in &sweep.recordings {
        let id = &recording.sequence.info().id;
        let here: Vec<_> = outcomes.iter().filter(|o| o.point.info.dataset == *id).collect();
        let _ = writeln!(page, "\n## {id}\n");
        markdown_table(&mut page, sweep, &here);
    }
    page
}

fn markdown_table(page: &mut String, sweep: &Sweep, outcomes: &[&Outcome<'_>]) {
    let f1 = |o: &Outcome<'_>| o.number("f1").unwrap_or(0.0);
    let Some(best) =
        outcomes.iter().filter(|o| o.number("f1").is_some()).min_by(|a, b| f1(b).total_cmp(&f1(a)))
    else {
        page.push_str("No laser scan came with these frames: the maps are not scored.\n");
        return;
    };
    let _ = writeln!(page, "Highest F1: {} ({:.3}).\n", best.point.label(&sweep.plan.axes), f1(best));
    let header: String = keys(sweep).iter().map(|key| format!(" {key} |")).collect();
    let _ = writeln!(page, "| method |{header} hits | mistakes | precision | recall | F1 |");
    let _ = writeln!(page, "|{}", " --- |".repeat(6 + sweep.plan.axes.len()));
    for outcome in outcomes.iter().take(MARKDOWN_ROWS) {
        let mut cells = vec![outcome.point.method.name().to_owned()];
        cells.extend(values(outcome));
        cells.extend(["hits", "mistakes"].map(|c| outcome.cell(c).to_owned()));
        let rate = |c: &str| outcome.number(c).map_or(String::new(), |v| format!("{v:.3}"));
        cells.extend(["precision", "recall", "f1"].map(rate));
        let _ = writeln!(page, "| {} |", cells.join(" | "));
    }
    if outcomes.len() > MARKDOWN_ROWS {
        let _ = writeln!(page, "\n{} more are in points.csv.", outcomes.len() - MARKDOWN_ROWS);
    }
}
