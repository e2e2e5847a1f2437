//! `evigrid compare` refuses runs that cannot be compared, and says why.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::runs::{Runs, check_refused};
use common::{TinyDrive, evigrid, stderr};

#[test]
fn different_conditions_are_refused_and_named() {
    let runs = Runs::new();
    for (more, parts) in [
        (&["--frames", "0..2"][..], &["frames 3 of 0 to 2 in BASE, 2 of 0 to 1 in NEW"][..]),
        (&["--stride", "2"], &["stride 1 in BASE, 2 in NEW"]),
        (&["--set", "grid.x_m=[0, 30]"], &["grid.x_m [0.0,20.0] in BASE, [0.0,30.0] in NEW"]),
        (
            &["--set", "truth.max_range_m=20", "--set", "score.tolerances_m=[0.3]"],
            &["truth.max_range_m 80.0 in BASE, 20.0 in NEW", "score.tolerances_m", "base and ", "/new"],
        ),
    ] {
        runs.run("new", more);
        runs.check_refused(parts);
    }
    let other = TinyDrive::new(3);
    fs::remove_file(other.scan(1)).unwrap();
    assert!(other.run(&runs.folder("new"), &[]).status.success());
    runs.check_refused(&["frames without laser [] in BASE, [1] in NEW"]);
    runs.copy("new");
    runs.edit("new", "run.json", "2011_09_26_drive_9999", "elsewhere");
    for summary in ["summary.csv", "summary.plan.csv"] {
        runs.edit("new", summary, "2011_09_26_drive_9999", "elsewhere");
    }
    runs.check_refused(&["data set", "elsewhere in NEW"]);
    runs.copy("new");
    runs.change("new", "true_cells", |v| (v * 1.1).ceil().to_string());
    runs.check_refused(&["true_cells of the reference"]);
}

/// A recording read from elsewhere, with other files written, is no other condition.
#[test]
fn where_things_lie_is_no_condition() {
    let runs = Runs::new();
    let other = TinyDrive::new(3);
    let output = other.run(&runs.folder("new"), &["--frames", "0..3", "--set", "output.disparity=true"]);
    assert!(output.status.success(), "{}", stderr(&output));
    runs.check(&[], 0, &["Verdict: unchanged"]);
}

#[test]
fn settings_that_one_run_does_not_know_have_their_defaults() {
    let runs = Runs::new();
    runs.copy("new");
    let file = runs.folder("new").join("run.json");
    let text = fs::read_to_string(&file).unwrap();
    let without = |key: &str| text.lines().filter(|l| !l.contains(key)).collect::<Vec<_>>().join("\n");
    fs::write(&file, without("\"max_range_m\"")).unwrap();
    runs.check(&[], 0, &[]);
    fs::write(&file, text.replace("\"max_range_m\"", "\"wind_mps\": 3, \"max_range_m\"")).unwrap();
    runs.check_refused(&["truth.wind_mps none in BASE, 3 in NEW"]);
}

#[test]
fn folders_that_are_no_runs_are_refused() {
    let runs = Runs::new();
    runs.check_refused(&["no run.json", "/new"]);
    fs::create_dir(runs.folder("new")).unwrap();
    runs.check_refused(&["no run.json", "/new"]);
    let refused_run = |text: &str, parts: &[&str]| {
        runs.copy("new");
        fs::write(runs.folder("new").join("run.json"), text).unwrap();
        runs.check_refused(&[parts, &["new/run.json"]].concat());
    };
    refused_run("", &["expected what `evigrid run` writes"]);
    refused_run("[1]", &["format 1", "found none"]);
    refused_run("{}", &["format 1", "found none"]);
    refused_run("{\"format\": 2}", &["format 1", "found 2", "another version"]);
    refused_run("{\"format\": 1}", &["missing field `dataset`"]);

    let refused_table = |spoil: &dyn Fn(), parts: &[&str]| {
        runs.copy("new");
        spoil();
        runs.check_refused(&[parts, &["new/summary.csv"]].concat());
    };
    let file = || runs.folder("new").join("summary.csv");
    refused_table(&|| fs::remove_file(file()).unwrap(), &["cannot read the table"]);
    refused_table(&|| fs::write(file(), "").unwrap(), &["expected the column `dataset`"]);
    refused_table(&|| fs::write(file(), [0xff, 0xfe, 0x0a]).unwrap(), &["cannot read the table"]);
    refused_table(
        &|| runs.edit("new", "summary.csv", ",f1,", ",f2,"),
        &["expected the column `f1`, found dataset"],
    );
    refused_table(&|| runs.edit("new", "summary.csv", ",touched,", ",f1,"), &["`f1` twice"]);
    refused_table(
        &|| runs.change("new", "f1", |_| "good".into()),
        &["column `f1`", "a finite number", "`good`", "line 2"],
    );
    refused_table(&|| runs.change("new", "f1", |_| "NaN".into()), &["column `f1`", "`NaN`"]);
    refused_table(&|| runs.change("new", "hits", |_| "-3".into()), &["column `hits`", "at least 0", "`-3`"]);
    refused_table(&|| runs.change("new", "frames", |_| "9".into()), &["`frames`", "3 as in run.json", "`9`"]);
    refused_table(&|| keep_lines(&file(), 1), &["one row for each method", "winner-take-all", "found none"]);
    refused_table(&|| runs.edit("new", "summary.csv", ",0\n", "\n"), &["cannot read the table", "line"]);
}

fn keep_lines(file: &Path, count: usize) {
    let text = fs::read_to_string(file).unwrap();
    fs::write(file, text.lines().take(count).map(|l| format!("{l}\n")).collect::<String>()).unwrap();
}

#[test]
fn runs_without_scores_are_refused() {
    let runs = Runs::new();
    fs::remove_dir_all(runs.drive.dir().join("velodyne_points")).unwrap();
    runs.run("base", &[]);
    runs.run("new", &[]);
    runs.check_refused(&["expected scores", "without laser", "base/summary.csv"]);
}

#[test]
fn wrong_options_are_refused() {
    let runs = Runs::new();
    runs.copy("new");
    for (option, parts) in [
        ("--tolerance=recal=0.1", &["recal", "did you mean `recall`?"][..]),
        ("--tolerance=f1=-1", &["--tolerance", "at least 0", "-1"]),
        ("--tolerance=touched=1", &["touched", "better or worse"]),
        ("--tolerance=f_score_0.7m=0.1", &["f_score_0.7m", "did you mean `f_score_0."]),
        ("--timing=fast", &["--timing", "fast"]),
    ] {
        check_refused(&runs.compare(&[option]), parts);
    }
    check_refused(&evigrid(&["compare", "only_one"]), &["NEW"]);
}
