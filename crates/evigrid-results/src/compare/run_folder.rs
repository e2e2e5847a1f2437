//! A results folder of a run, read for a comparison and checked.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use evigrid_grid::LayerKind;
use evigrid_metrics::metric_of;
use serde::Deserialize;
use serde_json::Value;

use super::table::Table;
use crate::tables::{SUMMARY_KEYS, WITHOUT_LASER};
use crate::{RESULTS_FORMAT, files};

/// run.json and the summaries of a run.
#[derive(Debug)]
pub(super) struct RunFolder {
    pub(super) dir: PathBuf,
    pub(super) run: RunDescription,
    /// summary.csv, then those of the other kinds of layers that the folder has.
    pub(super) tables: Vec<SummaryTable>,
}

/// The final scores of one kind of layer.
#[derive(Debug)]
pub(super) struct SummaryTable {
    pub(super) kind: LayerKind,
    /// One entry per method of the run, in the order of the file.
    pub(super) methods: Vec<MethodScores>,
    table: Table,
}

/// A row of a summary.
#[derive(Debug, PartialEq)]
pub(super) struct MethodScores {
    pub(super) method: String,
    /// By column; `None` for an empty field.
    pub(super) values: BTreeMap<String, Option<f64>>,
}

impl MethodScores {
    /// Whether any metric has a value.
    pub(super) fn has_scores(&self) -> bool {
        self.values.iter().any(|(column, value)| value.is_some() && metric_of(column).is_some())
    }
}

/// run.json.
#[derive(Debug, Deserialize)]
pub(super) struct RunDescription {
    pub(super) dataset: String,
    pub(super) layout: String,
    pub(super) frames: Frames,
    pub(super) methods: Vec<String>,
    pub(super) build: Value,
    pub(super) settings: Value,
}

/// Frames of a run.
#[derive(Debug, Deserialize)]
pub(super) struct Frames {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) without_laser: Vec<usize>,
}

impl RunFolder {
    /// Reads a folder that `evigrid run` has written.
    ///
    /// # Errors
    /// If it is none, another version wrote it in another format, or its files are damaged.
    pub(super) fn read(dir: &Path) -> Result<Self> {
        let run = read_description(dir)?;
        let is_there =
            |kind: &LayerKind| *kind == LayerKind::Voxels || dir.join(files::summary(*kind)).is_file();
        let kinds = LayerKind::ALL.into_iter().filter(is_there);
        let tables: Vec<_> = kinds.map(|kind| SummaryTable::read(dir, kind, &run)).collect::<Result<_>>()?;
        if !tables.iter().any(|table| table.methods.iter().any(MethodScores::has_scores)) {
            bail!(
                "expected scores, found none (a recording without laser cannot be compared): {}",
                dir.join(files::summary(LayerKind::Voxels)).display()
            );
        }
        Ok(Self { dir: dir.to_owned(), run, tables })
    }

    /// The table of a kind of layer.
    pub(super) fn table(&self, kind: LayerKind) -> Option<&SummaryTable> {
        self.tables.iter().find(|table| table.kind == kind)
    }

    /// The first value that stands in a column of any table.
    pub(super) fn value(&self, column: &str) -> Option<f64> {
        let mut methods = self.tables.iter().flat_map(|table| &table.methods);
        methods.find_map(|method| method.values.get(column).copied().flatten())
    }
}

impl SummaryTable {
    fn read(dir: &Path, kind: LayerKind, run: &RunDescription) -> Result<Self> {
        let table = Table::read(&dir.join(files::summary(kind)), &SUMMARY_KEYS)?;
        let methods = read_methods(&table, run)?;
        let found: Vec<_> = methods.iter().map(|m| m.method.clone()).collect();
        if found.is_empty() || found != run.methods {
            let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            bail!(
                "expected one row for each method of run.json ({}), found {}: {}",
                list(&run.methods),
                list(&found),
                table.path.display()
            );
        }
        Ok(Self { kind, methods, table })
    }

    /// The scores of a method.
    pub(super) fn method(&self, name: &str) -> Option<&MethodScores> {
        self.methods.iter().find(|m| m.method == name)
    }

    /// Columns with scores: all but those that name a row or repeat run.json.
    pub(super) fn score_columns(&self) -> impl Iterator<Item = &String> {
        let is_score = |column: &str| !SUMMARY_KEYS.contains(&column) && column != WITHOUT_LASER;
        self.table.columns.iter().filter(move |column| is_score(column))
    }

    /// Whether there is a column of this name.
    pub(super) fn has_column(&self, column: &str) -> bool {
        self.table.has_column(column)
    }

    /// Nothing, if there is a column of this name.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn require_column(&self, column: &str) -> Result<()> {
        self.table.require_column(column)
    }
}

fn read_methods(table: &Table, run: &RunDescription) -> Result<Vec<MethodScores>> {
    let is_number = |column: &&String| !["dataset", "method"].contains(&column.as_str());
    let mut methods = Vec::new();
    for row in &table.rows {
        table.expect_text(row, "dataset", &run.dataset)?;
        table.expect_text(row, "frames", &run.frames.count.to_string())?;
        let columns = table.columns.iter().filter(is_number);
        let values = columns.map(|c| Ok((c.clone(), table.number(row, c)?)));
        let method = table.text(row, "method")?.to_owned();
        methods.push(MethodScores { method, values: values.collect::<Result<_>>()? });
    }
    Ok(methods)
}

fn read_description(dir: &Path) -> Result<RunDescription> {
    let path = dir.join(files::RUN);
    if !path.is_file() {
        bail!("expected a folder that `evigrid run` has written, found no run.json: {}", dir.display());
    }
    let text = std::fs::read_to_string(&path)
        .map_err(|e| anyhow::anyhow!("cannot read: {e}: {}", path.display()))?;
    let damaged = |e: serde_json::Error| {
        anyhow::anyhow!("expected what `evigrid run` writes, found: {e}: {}", path.display())
    };
    let value: Value = serde_json::from_str(&text).map_err(damaged)?;
    if value["format"] != RESULTS_FORMAT {
        let found = match &value["format"] {
            Value::Null => "none".to_owned(),
            other => other.to_string(),
        };
        bail!(
            "expected results in format {RESULTS_FORMAT}, found {found} (another version made them; \
             run it again): {}",
            path.display()
        );
    }
    serde_json::from_value(value).map_err(damaged)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RUN: &str = r#"{ "format": 1, "dataset": "d", "layout": "l", "methods": ["m"],
        "build": {}, "settings": {},
        "frames": { "first": 0, "last": 1, "count": 2, "stride": 1, "without_laser": [] } }"#;
    const COLUMNS: &str = "dataset,method,frames,hits,mistakes,mistakes_observed,missed,precision,recall,f1,\
        true_cells,observed_cells,frames_without_laser";

    fn folder(run: &[u8], summary: &[u8]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("run.json"), run).unwrap();
        std::fs::write(dir.path().join("summary.csv"), summary).unwrap();
        dir
    }

    #[test]
    fn a_small_run_is_read() {
        let summary = format!("{COLUMNS}\nd,m,2,3,0,0,1,1,0.75,,4,9,0\n");
        let folder = RunFolder::read(folder(RUN.as_bytes(), summary.as_bytes()).path()).unwrap();
        let table = folder.table(LayerKind::Voxels).unwrap();
        let scores = table.method("m").unwrap();
        assert_eq!((scores.values["recall"], scores.values["f1"]), (Some(0.75), None));
        assert_eq!(table.score_columns().next().unwrap(), "hits");
        assert_eq!((folder.value("true_cells"), folder.value("plan_f1")), (Some(4.0), None));
    }

    #[test]
    fn one_score_in_any_table_is_enough() {
        let read = |dir: &tempfile::TempDir| RunFolder::read(dir.path());
        let dir = folder(RUN.as_bytes(), b"dataset,method,frames,frames_without_laser\nd,m,2,0\n");
        let error = read(&dir).unwrap_err().to_string();
        assert!(error.contains("expected scores, found none"), "{error}");
        let plan = dir.path().join("summary.plan.csv");
        std::fs::write(&plan, "dataset,method,frames,plan_f1\nd,m,2,0.5\n").unwrap();
        assert_eq!(read(&dir).unwrap().value("plan_f1"), Some(0.5));
        std::fs::write(&plan, "dataset,method,frames,plan_f1\nd,other,2,0.5\n").unwrap();
        let error = read(&dir).unwrap_err().to_string();
        assert!(error.contains("(m), found other") && error.contains("summary.plan.csv"), "{error}");
    }

    proptest! {
        #[test]
        fn damaged_files_never_panic(
            bytes in prop::collection::vec(any::<u8>(), 0..200),
            at in 0_usize..400,
            row in "[dm,0-9.\"\n-]{0,60}",
        ) {
            let mut run = RUN.as_bytes().to_vec();
            let at = at.min(run.len());
            run.truncate(at);
            run.extend(&bytes);
            let _ = RunFolder::read(folder(&run, &bytes).path());
            let summary = format!("{COLUMNS}\n{row}");
            let _ = RunFolder::read(folder(RUN.as_bytes(), summary.as_bytes()).path());
            let _ = RunFolder::read(folder(RUN.as_bytes(), &bytes).path());
        }
    }
}
