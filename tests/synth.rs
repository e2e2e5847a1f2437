//! `evigrid synth`: a data set that `check` and `run` take, and what it refuses.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{TINY_WORLD, evigrid, names, path, stderr, stdout};

/// A temporary folder with the file tiny.toml.
fn with_world(text: &str) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("tiny.toml"), text).unwrap();
    root
}

fn synth(root: &Path, more: &[&str]) -> std::process::Output {
    let (world, out) = (root.join("tiny.toml"), root.join("out"));
    evigrid(&[&["synth", path(&world), "--out", path(&out)], more].concat())
}

/// Refused with one line that holds all the parts; nothing is left beside the world.
fn check_refused(output: &std::process::Output, root: &Path, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("error: ") && !text.contains("panicked"), "{text}");
    for part in parts {
        assert!(text.contains(part), "expected {part:?} in: {text}");
    }
    assert_eq!(names(root), ["tiny.toml"]);
}

#[test]
fn a_written_world_can_be_checked_and_run() {
    let root = with_world(TINY_WORLD);
    let out = root.path().join("out");
    let output = synth(root.path(), &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("Data set: "), "{}", stdout(&output));
    assert!(stderr(&output).contains("frame 3/3"), "{}", stderr(&output));
    assert_eq!(names(root.path()), ["out", "tiny.toml"]);
    let truth = names(&out.join("ground_truth"));
    for name in ["disparity", "occlusion", "poses.txt", "voxels.npz", "world.toml"] {
        assert!(truth.iter().any(|found| found == name), "{name} is not in {truth:?}");
    }
    let check = evigrid(&["check", path(&out)]);
    assert!(check.status.success(), "{}", stdout(&check));
    assert!(stdout(&check).contains("laser origins"), "{}", stdout(&check));
    assert!(stdout(&check).contains("3 laser scans"), "{}", stdout(&check));
    let run = |dataset: &str| {
        let results = root.path().join("results");
        let args = ["run", "--dataset", dataset, "--out", path(&results)];
        let settings = ["--set", "output.recording=false", "--set", "stereo.disparities=32"];
        let output = evigrid(&[&args[..], &settings].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains("| winner-take-all |"), "{}", stdout(&output));
        fs::read_to_string(results.join("frames.csv")).unwrap()
    };
    // The same world straight from its description gives the same scores.
    let rendered = run(&format!("synth:{}", path(&root.path().join("tiny.toml"))));
    assert_eq!(run(path(&out)), rendered.replace("tiny", "out"));
}

#[test]
fn some_frames_of_a_world() {
    let root = with_world(TINY_WORLD);
    let output = synth(root.path(), &["--frames", "1..3"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let out = root.path().join("out");
    assert_eq!(names(&out.join("image_0")), ["000000.png", "000001.png"]);
    assert_eq!(fs::read_to_string(out.join("times.txt")).unwrap(), "0.100000000\n0.200000000\n");
}

#[test]
fn an_earlier_data_set_is_replaced_and_nothing_else() {
    let root = with_world(TINY_WORLD);
    let out = root.path().join("out");
    assert!(synth(root.path(), &[]).status.success());
    assert!(synth(root.path(), &["--frames", "0..1"]).status.success());
    assert_eq!(names(&out.join("image_0")), ["000000.png"]);
    fs::write(out.join("notes.txt"), "mine").unwrap();
    let output = synth(root.path(), &[]);
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{text}");
    assert!(text.contains("found \"notes.txt\" in it") && text.trim_end().ends_with("/out"), "{text}");
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    assert_eq!(names(&out.join("image_0")), ["000000.png"]);
}

#[test]
fn bad_input_is_told_in_one_line() {
    let root = with_world(TINY_WORLD);
    let (dir, out) = (root.path(), root.path().join("out"));
    let refused = |args: &[&str], parts: &[&str]| check_refused(&evigrid(args), dir, parts);
    refused(&["synth", "stret", "--out", path(&out)], &["stret", "did you mean `street`?"]);
    refused(&["synth", "street"], &["--out"]);
    refused(&["synth", "--out", path(&out)], &["WORLD"]);
    refused(&["synth", "no/world.toml", "--out", path(&out)], &["no/world.toml"]);
    refused(&["synth", "street", "--out", "/"], &["the name of a folder"]);
    check_refused(&synth(dir, &["--frames", "1..9"]), dir, &["0..3", "1..9"]);
    let file = dir.join("tiny.toml").join("out");
    refused(&["synth", "street", "--out", path(&file)], &["tiny.toml/out"]);
    for (from, to, parts) in [
        ("rate_hz", "rate_Hz", &["line 5", "`rate_Hz`", "did you mean `rate_hz`?", "tiny.toml"][..]),
        ("\"soil\"", "\"soul\"", &["line 43", "did you mean `soil`?", "tiny.toml"]),
        (
            "[light]",
            "[truth_grid]\ncell_size_m = 0\n[light]",
            &["line 25", "truth_grid.cell_size_m", "tiny.toml"],
        ),
        ("[light]", "[truth_grid]\ncell = 1\n[light]", &["line 26", "`cell`", "tiny.toml"]),
    ] {
        fs::write(dir.join("tiny.toml"), TINY_WORLD.replacen(from, to, 1)).unwrap();
        check_refused(&synth(dir, &[]), dir, parts);
    }
}

#[test]
fn the_help_lists_the_worlds() {
    let help = evigrid(&["synth", "--help"]);
    assert!(help.status.success() && stdout(&help).contains("Built-in worlds: street"), "{}", stdout(&help));
}
