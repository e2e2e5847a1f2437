//! `evigrid compare`: a map that got worse is caught, a repeated run is not.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::runs::{Runs, check_refused};
use common::{command, evigrid, names, path, stderr, stdout};

#[test]
fn a_repeated_run_is_unchanged() {
    let runs = Runs::new();
    runs.run("new", &[]);
    let output = runs.compare(&["--tolerance", "0", "--tolerance", "0%"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("Verdict: unchanged (0 worse, 0 better"), "{}", stdout(&output));
    assert!(!stdout(&output).contains("recall"), "{}", stdout(&output));
    runs.check(&["--all"], 0, &["recall", "f_score_0.4m", "match_ms", "unchanged"]);
}

/// The mapper is made worse by a setting of its own, which is what is tried out, and no condition.
#[test]
fn a_mapper_made_worse_is_caught() {
    let runs = Runs::new();
    runs.run("new", &["--set", "winner-take-all.max_depth_m=7"]);
    let note = "winner-take-all.max_depth_m 25.0 in BASE, 7.0 in NEW";
    runs.check(&[], 1, &["recall", "worse", "Verdict: worse", note]);
    let (base, new) = (runs.folder("base"), runs.folder("new"));
    let back = evigrid(&["compare", path(&new), path(&base)]);
    assert_eq!(back.status.code(), Some(0), "{}", stdout(&back));
    assert!(stdout(&back).contains("Verdict: better (0 worse"), "{}", stdout(&back));
}

/// The built-in world, as if disparities were fifteen times as uncertain.
#[test]
fn a_worse_map_of_the_built_in_world_is_caught() {
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, more: &[&str]| {
        let out = dir.path().join(name);
        let args = ["run", "--frames", "0..2", "--set", "output.recording=false", "--out", path(&out)];
        let output = evigrid(&[&args, more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        out
    };
    let (base, again) = (run("base", &[]), run("again", &[]));
    let worse = run("worse", &["--set", "winner-take-all.disparity_error_px=3"]);
    let same = evigrid(&["compare", path(&base), path(&again)]);
    assert_eq!(same.status.code(), Some(0), "{}{}", stdout(&same), stderr(&same));
    let output = evigrid(&["compare", path(&base), path(&worse)]);
    assert_eq!(output.status.code(), Some(1), "{}{}", stdout(&output), stderr(&output));
}

#[test]
fn tolerances_decide() {
    let runs = Runs::new();
    let lower = |by: f64| {
        runs.copy("new");
        runs.change("new", "recall", |v| format!("{:.6}", v - by));
    };
    lower(0.001);
    runs.check(&[], 0, &["Verdict: unchanged"]);
    runs.check(&["--tolerance", "recall=0.0005"], 1, &["-0.001000", "Verdict: worse (1 worse, 0 better"]);
    lower(0.003);
    runs.check(&[], 1, &["-0.003000"]);
    runs.check(&["--tolerance", "0.003"], 0, &[]);
    runs.check(&["--tolerance", "f1=0.003"], 1, &[]);
    runs.check(&["--tolerance", "recall=off"], 0, &["not judged"]);
    lower(-0.003);
    runs.check(&[], 0, &["+0.003000", "Verdict: better (0 worse, 1 better"]);
    runs.copy("new");
    runs.change("new", "hits", |v| (v * 0.9).floor().to_string());
    runs.check(&[], 0, &["not judged"]);
    runs.check(&["--tolerance", "hits=1%"], 1, &["worse"]);
    runs.copy("new");
    runs.change("new", "precision", |_| String::new());
    runs.check(&[], 1, &["undefined"]);
}

#[test]
fn times_are_judged_when_asked_for() {
    let runs = Runs::new();
    runs.copy("new");
    for folder in ["base", "new"] {
        let ms = if folder == "base" { "10.0" } else { "13.0" };
        let text =
            format!("frame,method,stage,ms,peak_memory_mib\n0,,match,{ms},50.0\n0,,record,{ms}9,50.0\n");
        fs::write(runs.folder(folder).join("timing.csv"), text).unwrap();
    }
    runs.check(&[], 0, &["match_ms", "+30.00 %", "not judged", "Verdict: unchanged"]);
    runs.check(&["--timing"], 1, &["match_ms", "Verdict: worse (1 worse"]);
    runs.check(&["--timing=40%"], 0, &["Verdict: unchanged"]);
    runs.check(&["--tolerance", "match_ms=2"], 1, &[]);
    fs::remove_file(runs.folder("base").join("timing.csv")).unwrap();
    runs.check(&[], 0, &["note: no time and memory", "base has no timing.csv"]);
    check_refused(&runs.compare(&["--timing"]), &["timing.csv", "base"]);
}

#[test]
fn a_method_that_is_gone_is_worse_and_a_new_one_a_note() {
    let runs = Runs::new();
    runs.copy("new");
    runs.edit("new", "run.json", "\"winner-take-all\"\n", "\"another\"\n");
    for summary in ["summary.csv", "summary.plan.csv"] {
        runs.edit("new", summary, ",winner-take-all,", ",another,");
    }
    runs.check(&[], 1, &["winner-take-all  (all)", "missing", "note: method another is new", "1 worse"]);
}

#[test]
fn new_columns_are_notes_and_lost_ones_are_refused() {
    let runs = Runs::new();
    runs.copy("new");
    runs.edit("new", "summary.csv", "curve_area", "curve_height");
    runs.check_refused(&["`curve_area`", "new/summary.csv"]);
    let (base, new) = (runs.folder("base"), runs.folder("new"));
    let text = fs::read_to_string(base.join("summary.csv")).unwrap();
    let mut lines = text.lines();
    let wider = format!("{},shine\n{},0.5\n", lines.next().unwrap(), lines.next().unwrap());
    fs::write(new.join("summary.csv"), &wider).unwrap();
    runs.check(&[], 0, &["note: column shine is new"]);
    fs::write(base.join("summary.csv"), &wider).unwrap();
    runs.check(&[], 0, &["note: column shine is unknown"]);
}

/// A reader that has gone away changes neither the exit code nor what stands on standard error.
#[test]
fn a_closed_pipe_is_no_error() {
    let runs = Runs::new();
    runs.copy("new");
    runs.change("new", "recall", |_| "0".into());
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let (base, new) = (runs.folder("base"), runs.folder("new"));
    let output = command(&["compare", path(&base), path(&new)]).stdout(writer).output().unwrap();
    assert_eq!((output.status.code(), stderr(&output)), (Some(1), String::new()));
}

/// The baselines of this repository can be read by this version.
#[test]
fn the_baselines_are_runs() {
    let baselines = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/baselines");
    let folders: Vec<_> = names(&baselines).into_iter().filter(|n| baselines.join(n).is_dir()).collect();
    assert!(folders.contains(&"street".to_owned()), "{folders:?}");
    for folder in folders {
        let dir = baselines.join(folder);
        let output = evigrid(&["compare", path(&dir), path(&dir)]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}
