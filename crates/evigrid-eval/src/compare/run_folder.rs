//! What two runs are compared by, read from a results folder and checked.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use serde::Deserialize;
use serde_json::Value;

use super::metric::OTHER_COLUMNS;
use super::table::Table;
use crate::tables::RESULTS_FORMAT;

/// run.json and summary.csv of a run.
#[derive(Debug)]
pub(super) struct RunFolder {
    pub(super) dir: PathBuf,
    pub(super) run: RunDescription,
    /// The columns of summary.csv that hold numbers.
    pub(super) columns: Vec<String>,
    /// One entry per method, in the order of the file.
    pub(super) methods: Vec<MethodScores>,
}

/// A row of summary.csv.
#[derive(Debug, PartialEq)]
pub(super) struct MethodScores {
    pub(super) method: String,
    /// By column; `None` for an empty field.
    pub(super) values: BTreeMap<String, Option<f64>>,
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

/// Which frames a run has used.
#[derive(Debug, Deserialize)]
pub(super) struct Frames {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) without_laser: Vec<usize>,
}

/// What every version has written to summary.csv.
const REQUIRED: [&str; 13] = [
    "dataset",
    "method",
    "frames",
    "hits",
    "mistakes",
    "mistakes_observed",
    "missed",
    "precision",
    "recall",
    "f1",
    "true_cells",
    "observed_cells",
    "frames_without_laser",
];

impl RunFolder {
    /// Reads a folder that `evigrid run` has written.
    ///
    /// # Errors
    /// If it is none, another version wrote it in another format, or its files are damaged.
    pub(super) fn read(dir: &Path) -> Result<Self> {
        let run = read_description(dir)?;
        let table = Table::read(&dir.join("summary.csv"), &REQUIRED)?;
        let is_number = |column: &&String| !["dataset", "method"].contains(&column.as_str());
        let columns: Vec<String> = table.columns.iter().filter(is_number).cloned().collect();
        let folder =
            Self { dir: dir.to_owned(), methods: read_methods(&table, &columns, &run)?, columns, run };
        folder.check_methods(&table)?;
        Ok(folder)
    }

    fn check_methods(&self, table: &Table) -> Result<()> {
        let found: Vec<_> = self.methods.iter().map(|m| m.method.clone()).collect();
        if found.is_empty() || found != self.run.methods {
            let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            bail!(
                "expected one row for each method of run.json ({}), found {}: {}",
                list(&self.run.methods),
                list(&found),
                table.path.display()
            );
        }
        if self.methods.iter().all(|m| m.values["hits"].is_none()) {
            bail!(
                "expected scores, found none (a recording without laser cannot be compared): {}",
                table.path.display()
            );
        }
        Ok(())
    }

    /// The scores of a method.
    pub(super) fn method(&self, name: &str) -> Option<&MethodScores> {
        self.methods.iter().find(|m| m.method == name)
    }

    /// Columns with scores: all but those that name a row or say what it is measured against.
    pub(super) fn score_columns(&self) -> impl Iterator<Item = &String> {
        self.columns.iter().filter(|c| !OTHER_COLUMNS.contains(&c.as_str()))
    }
}

fn read_methods(table: &Table, columns: &[String], run: &RunDescription) -> Result<Vec<MethodScores>> {
    let mut methods = Vec::new();
    for row in &table.rows {
        table.expect_text(row, "dataset", &run.dataset)?;
        table.expect_text(row, "frames", &run.frames.count.to_string())?;
        let values = columns.iter().map(|c| Ok((c.clone(), table.number(row, c)?)));
        let method = table.text(row, "method")?.to_owned();
        methods.push(MethodScores { method, values: values.collect::<Result<_>>()? });
    }
    Ok(methods)
}

fn read_description(dir: &Path) -> Result<RunDescription> {
    let path = dir.join("run.json");
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
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    const RUN: &str = r#"{ "format": 1, "dataset": "d", "layout": "l", "methods": ["m"], "build": {}, "settings": {},
        "frames": { "first": 0, "last": 1, "count": 2, "stride": 1, "without_laser": [] } }"#;

    fn folder(run: &[u8], summary: &[u8]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("run.json"), run).unwrap();
        std::fs::write(dir.path().join("summary.csv"), summary).unwrap();
        dir
    }

    #[test]
    fn a_small_run_is_read() {
        let summary = format!("{}\nd,m,2,3,0,0,1,1,0.75,,4,9,0\n", REQUIRED.join(","));
        let folder = RunFolder::read(folder(RUN.as_bytes(), summary.as_bytes()).path()).unwrap();
        let scores = folder.method("m").unwrap();
        assert_eq!((scores.values["recall"], scores.values["f1"]), (Some(0.75), None));
        assert_eq!(folder.score_columns().next().unwrap(), "hits");
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
            let summary = format!("{}\n{row}", REQUIRED.join(","));
            let _ = RunFolder::read(folder(RUN.as_bytes(), summary.as_bytes()).path());
            let _ = RunFolder::read(folder(RUN.as_bytes(), &bytes).path());
        }
    }
}
