//! `evigrid compare`: a map that got worse is caught, a repeated run is not, and what cannot be compared is refused.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use common::{TinyDrive, command, evigrid, names, path, stderr, stdout};

/// A drive that was run into the folder `base`.
struct Runs {
    drive: TinyDrive,
}

impl Runs {
    fn new() -> Self {
        let runs = Self { drive: TinyDrive::new(3) };
        runs.run("base", &[]);
        runs
    }

    fn folder(&self, name: &str) -> PathBuf {
        self.drive.root.path().join(name)
    }

    fn run(&self, name: &str, more: &[&str]) {
        let output = self.drive.run(&self.folder(name), more);
        assert!(output.status.success(), "{}", stderr(&output));
    }

    /// A copy of `base`, replacing whatever had the name.
    fn copy(&self, name: &str) {
        let _ = fs::remove_dir_all(self.folder(name));
        fs::create_dir(self.folder(name)).unwrap();
        for file in names(&self.folder("base")) {
            fs::copy(self.folder("base").join(&file), self.folder(name).join(&file)).unwrap();
        }
    }

    /// Replaces `from` in a file of a folder.
    fn edit(&self, name: &str, file: &str, from: &str, to: &str) {
        let file = self.folder(name).join(file);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{from:?} is not in {text}");
        fs::write(file, text.replace(from, to)).unwrap();
    }

    /// Changes a number in the only row of summary.csv.
    fn change(&self, name: &str, column: &str, change: impl Fn(f64) -> String) {
        let file = self.folder(name).join("summary.csv");
        let mut reader = csv::Reader::from_path(&file).unwrap();
        let header = reader.headers().unwrap().clone();
        let at = header.iter().position(|c| c == column).unwrap();
        let row = reader.into_records().next().unwrap().unwrap();
        let mut fields: Vec<String> = row.iter().map(str::to_owned).collect();
        fields[at] = change(fields[at].parse().unwrap());
        let mut writer = csv::Writer::from_path(&file).unwrap();
        writer.write_record(&header).unwrap();
        writer.write_record(&fields).unwrap();
    }

    /// Compares `base` with `new`.
    fn compare(&self, more: &[&str]) -> Output {
        let (base, new) = (self.folder("base"), self.folder("new"));
        evigrid(&[&["compare", path(&base), path(&new)], more].concat())
    }

    fn check(&self, more: &[&str], code: i32, parts: &[&str]) {
        let output = self.compare(more);
        let text = stdout(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {text}{}", stderr(&output));
        for part in parts {
            assert!(text.contains(part), "{more:?}: expected {part:?} in: {text}");
        }
    }

    fn check_refused(&self, parts: &[&str]) {
        check_refused(&self.compare(&[]), parts);
    }
}

/// One error line that holds all the parts, exit code 2, nothing on standard output.
fn check_refused(output: &Output, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}{}", stdout(output));
    assert!(text.starts_with("error: ") && text.trim_end().lines().count() == 1, "{text}");
    assert_eq!(stdout(output), "");
    for part in parts {
        assert!(text.contains(part), "expected {part:?} in: {text}");
    }
}

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
    runs.edit("new", "summary.csv", ",winner-take-all,", ",another,");
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
    runs.edit("new", "summary.csv", "2011_09_26_drive_9999", "elsewhere");
    runs.check_refused(&["data set", "elsewhere in NEW"]);
    runs.copy("new");
    runs.change("new", "true_cells", |v| (v * 1.1).ceil().to_string());
    runs.check_refused(&["true_cells of the reference"]);
}

/// The same recording and settings from elsewhere, with other files written, are the same conditions.
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
