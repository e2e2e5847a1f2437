use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{CompareOptions, Comparison, compare};
use crate::test_run::{info, result};
use crate::{Kept, ResultsFolder, ResultsWriter, RunInfo};

/// Two folders with the run of the tests.
struct Runs(tempfile::TempDir);

impl Runs {
    fn new() -> Self {
        let runs = Self(tempfile::tempdir().unwrap());
        runs.write("base", &info());
        runs.write("new", &info());
        runs
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, info: &RunInfo) {
        let (folder, _) = ResultsFolder::open(&self.path(name)).unwrap();
        let kept = Kept { frames: false, maps: false };
        let writer = ResultsWriter::create(&folder, info, Value::Null, kept).unwrap();
        folder.publish(writer.finish(&result(), &[], None).unwrap()).unwrap();
    }

    fn edit(&self, file: &str, from: &str, to: &str) {
        let file = self.path(file);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{from:?} is not in {text}");
        fs::write(file, text.replace(from, to)).unwrap();
    }

    fn compare(&self) -> anyhow::Result<Comparison> {
        compare(&self.path("base"), &self.path("new"), &CompareOptions::default(), &defaults())
    }

    fn text(&self) -> String {
        self.compare().unwrap().to_text(true)
    }
}

fn defaults() -> Value {
    json!({ "grid": { "cell_size_m": 0.2 }, "truth": { "source": "laser" }, "line": { "width": 1 } })
}

#[test]
fn every_table_is_compared() {
    let runs = Runs::new();
    let text = runs.text();
    for part in ["f_score_0.2m", "plan_auc", "safety_fn_rate", "Verdict: unchanged (0 worse, 0 better"] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let safety_of_line = |line: &str| line.starts_with("line ") && line.contains("safety");
    assert!(!text.lines().any(safety_of_line), "a method without such maps has no such rows: {text}");
    runs.edit("new/summary.plan.csv", "0.750000", "0.700000");
    assert!(runs.compare().unwrap().is_worse());
    assert!(runs.text().contains("Verdict: worse (2 worse"), "{}", runs.text());
}

#[test]
fn scores_that_a_method_has_lost_are_worse() {
    let runs = Runs::new();
    runs.edit("new/summary.safety.csv", "yard,all,2,0.000000,,0.000000,1.000000", "yard,all,2,,,,");
    assert!(runs.text().contains("Verdict: worse (3 worse"), "{}", runs.text());
}

#[test]
fn a_table_that_is_lost_is_refused_and_a_new_one_a_note() {
    let runs = Runs::new();
    fs::remove_file(runs.path("new/summary.plan.csv")).unwrap();
    let error = runs.compare().unwrap_err().to_string();
    assert!(
        error.contains("expected summary.plan.csv as in BASE, found none") && error.contains("/new"),
        "{error}"
    );
    fs::remove_file(runs.path("base/summary.plan.csv")).unwrap();
    assert!(!runs.text().contains("plan_f1"));
    runs.write("new", &info());
    assert!(runs.text().contains("note: table summary.plan.csv is new; there is nothing to compare it with"));
}

#[test]
fn another_source_of_truth_is_another_condition() {
    let runs = Runs::new();
    runs.edit("base/run.json", "\"source\": \"laser\"", "\"min_range_m\": 1");
    runs.edit("new/run.json", "\"source\": \"laser\"", "\"min_range_m\": 1, \"source\": \"exact\"");
    let error = runs.compare().unwrap_err().to_string();
    assert!(error.contains("truth.source \"laser\" in BASE, \"exact\" in NEW"), "{error}");
    runs.edit("new/run.json", "exact", "laser");
    assert!(!runs.compare().unwrap().is_worse());
}

#[test]
fn another_reference_is_another_condition() {
    let runs = Runs::new();
    runs.edit("new/summary.csv", ",2,4,0,3,", ",2,5,0,3,");
    let error = runs.compare().unwrap_err().to_string();
    assert!(error.contains("observed_cells of the reference 4 in BASE, 5 in NEW"), "{error}");
}

/// A run of an older version, with one table and without a source of truth.
#[test]
fn the_baseline_of_this_repository_can_be_compared() {
    let street = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/baselines/street");
    let comparison = compare(&street, &street, &CompareOptions::default(), &defaults()).unwrap();
    assert!(!comparison.is_worse());
    let text = comparison.to_text(true);
    assert!(text.contains("average_precision") && text.contains("has no timing.csv"), "{text}");
}
