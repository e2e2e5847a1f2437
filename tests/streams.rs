//! Standard output and standard error that cannot be written: nothing panics and no result is lost.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Output, Stdio};

use common::{TinyDrive, command, names, path, stderr, stdout, sweep_plan};

/// Where every write fails for want of space; `None`, with a word on it, on a machine that lacks it.
fn full() -> Option<Stdio> {
    let file = fs::File::options().write(true).open("/dev/full");
    if file.is_err() {
        common::skipped("no /dev/full here");
    }
    file.ok().map(Stdio::from)
}

/// Runs the binary with one full stream, or both.
fn run_full(args: &[&str], full_out: bool, full_err: bool) -> Option<Output> {
    let mut command = command(args);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    if full_out {
        command.stdout(full()?);
    }
    if full_err {
        command.stderr(full()?);
    }
    Some(command.output().unwrap())
}

/// Arguments of a run of the drive as [`TinyDrive::run`] has them.
fn run_args<'a>(dir: &'a Path, out: &'a Path) -> Vec<&'a str> {
    let mut args = vec!["run", "--dataset", path(dir), "--out", path(out)];
    args.extend(["--set", "stereo.disparities=16", "--set", "output.recording=false"]);
    args.extend(["--set", "grid.x_m=[0, 20]"]);
    args
}

/// The files of two runs are the same, but for times.
fn check_same_results(expected: &Path, found: &Path) {
    assert_eq!(names(found), names(expected));
    for name in names(expected) {
        if !["timing.csv", "run.json"].contains(&name.as_str()) {
            let read = |dir: &Path| fs::read(dir.join(&name)).unwrap();
            assert!(read(found) == read(expected), "{name} differs");
        }
    }
}

#[test]
fn a_run_survives_full_streams() {
    let drive = TinyDrive::new(3);
    let [dir, expected] = [drive.dir(), drive.root.path().join("expected")];
    assert!(drive.run(&expected, &[]).status.success());
    for (name, full_out, full_err) in [("err", false, true), ("out", true, false), ("both", true, true)] {
        let out = drive.root.path().join(name);
        // What a killed run left makes the next one warn.
        fs::create_dir(&out).unwrap();
        fs::write(out.join("summary.csv.partial"), "half").unwrap();
        let Some(output) = run_full(&run_args(&dir, &out), full_out, full_err) else { return };
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        check_same_results(&expected, &out);
        if !full_err {
            assert!(stderr(&output).contains("cannot write to standard output"), "{}", stderr(&output));
        }
    }
}

#[test]
fn a_sweep_and_a_synthetic_data_set_survive_full_streams() {
    let drive = TinyDrive::new(2);
    let plan = sweep_plan(&drive, "", "winner-take-all.peak_ratio = [1.5, 2.0]");
    let [swept, world] = ["swept", "world"].map(|name| drive.root.path().join(name));
    let commands: [(&[&str], _); 2] = [
        (&["sweep", path(&plan), "--out", path(&swept)], swept.join("points.csv")),
        (&["synth", "safety-1", "--frames", "0..1", "--out", path(&world)], world.join("calib.txt")),
    ];
    for (args, result) in commands {
        let Some(output) = run_full(args, true, true) else { return };
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        assert!(result.is_file(), "{}", result.display());
    }
}

#[test]
fn errors_keep_their_exit_code_when_nobody_can_read_them() {
    let wrong: [&[&str]; 4] =
        [&["rum"], &[], &["run", "--dataset", "nowhere"], &["compare", "nowhere", "nowhere"]];
    for args in wrong {
        let Some(output) = run_full(args, true, true) else { return };
        assert_eq!(output.status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn a_full_standard_output_is_an_error_of_commands_that_only_print() {
    let only_print: [&[&str]; 5] =
        [&["metrics"], &["methods"], &["--help"], &["run", "--help"], &["--version"]];
    for args in only_print {
        let Some(output) = run_full(args, true, false) else { return };
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(text.starts_with("error: cannot write to standard output: "), "{args:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{args:?}: {text}");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let only_print: [&[&str]; 3] = [&["metrics"], &["methods"], &["run", "--help"]];
    for args in only_print {
        let (reader, writer) = std::io::pipe().unwrap();
        // Closed before the first byte, so that every write meets a closed pipe.
        drop(reader);
        let output = command(args).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""), "{args:?}");
    }
    let mut child = command(&["methods"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    // The reader is dropped at the end of the statement, as `head -1` ends.
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""), "{line}");
    assert_eq!(stdout(&output), "");
}
