//! Plans of sweeps that are refused before the first frame.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;
use std::process::Output;

use common::{TinyDrive, names, stderr, sweep, sweep_plan as plan};

/// The sweep is refused with one line that holds all the parts, and leaves nothing.
fn check_refused(output: &Output, out: &Path, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.starts_with("error: ") && text.lines().count() == 1, "{text}");
    assert!(parts.iter().all(|part| text.contains(part)), "expected {parts:?} in: {text}");
    assert!(!out.exists(), "left behind: {:?}", names(out));
}

#[test]
fn wrong_plans_are_refused_before_anything_is_written() {
    let drive = TinyDrive::new(3);
    let out = drive.root.path().join("out");
    for (head, keys, parts) in [
        ("dataset = 1", "", ["plan.toml", "unknown key `dataset` (did you mean `datasets`?)"]),
        (
            "",
            "stereo.windw = [3]",
            ["plan.toml", "unknown setting `stereo.windw` (did you mean `stereo.window`?)"],
        ),
        (
            "",
            "stereo.window = { from = 9, to = 3, step = 2 }",
            ["plan.toml: sweep.stereo.window", "found 9..3"],
        ),
        (
            "",
            "stereo.window = { from = 3, to = 9, step = 0 }",
            ["plan.toml: sweep.stereo.window", "a step above 0"],
        ),
        ("", "stereo.window = []", ["plan.toml: sweep.stereo.window", "an empty list"]),
        ("", "stereo.window = [5, 7, 5]", ["points 1 and 3 the same", "stereo.window = 5"]),
        ("", "truth.max_range_m = [80, 80.0]", ["points 1 and 2 the same", "truth.max_range_m = 80"]),
        ("", "stereo.window = [5, 6]", ["plan.toml", "an odd number"]),
        ("", "winner-take-all.peak_ratio = [0.5]", ["plan.toml", "a number from 1, found 0.5"]),
        (
            "",
            "winner-take-all.peak_ratio = [true]",
            ["plan.toml: sweep.winner-take-all.peak_ratio", "boolean"],
        ),
        ("", "run.dataset = [\"synth:street\"]", ["plan.toml", "lists of their own"]),
        ("", "output.recording = [true, false]", ["plan.toml", "sweep.output.recording"]),
        (
            "",
            "stereo.min_disparity = { from = 0, to = 4000, step = 1 }\nstereo.window = [3, 5, 7]",
            ["at most 10000 points", "12003"],
        ),
        ("frames = \"0..9\"", "", ["plan.toml", "within 0..3"]),
        ("methods = [\"winner\"]", "", ["plan.toml", "unknown method `winner`"]),
        ("methods = []", "", ["plan.toml", "at least one method"]),
        (
            "methods = [\"winner-take-all\", \"winner-take-all\"]",
            "",
            ["points 1 and 2 the same", "winner-take-all on"],
        ),
    ] {
        check_refused(&sweep(&plan(&drive, head, keys), &out), &out, &parts);
    }
    check_refused(&sweep(&out.join("none.toml"), &out), &out, &["none.toml", "cannot read"]);
    let twice = drive.run(&out, &["--sweep", "stereo.window=3..5:2", "--sweep", "stereo.window=[7]"]);
    check_refused(&twice, &out, &["--sweep", "`stereo.window` twice"]);
    check_refused(
        &drive.run(&out, &["--sweep", "stereo.window=3..5"]),
        &out,
        &["--sweep stereo.window=3..5", "A..B:STEP"],
    );
    check_refused(
        &drive.run(&out, &["--sweep", "stereo.windw=3..5:2"]),
        &out,
        &["unknown setting `stereo.windw`"],
    );
    check_refused(&sweep_of_two_drives(&drive, &out), &out, &["datasets: ", "`2011_09_26_drive_9999` twice"]);
}

/// Two folders with the same recording: nothing would tell their points apart.
fn sweep_of_two_drives(drive: &TinyDrive, out: &Path) -> Output {
    let dir = drive.dir();
    let file = drive.root.path().join("two.toml");
    fs::write(&file, format!("datasets = [{dir:?}, {:?}]\n", dir.join("."))).unwrap();
    sweep(&file, out)
}
