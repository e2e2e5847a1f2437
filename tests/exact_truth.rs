//! `truth.source = exact`: a world's own truth in a run, without a laser and without a detour over the disk.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use common::{TINY_WORLD, TinyDrive, evigrid, names, path, stderr, stdout};

fn summary(out: &Path) -> HashMap<String, String> {
    let rows = csv::Reader::from_path(out.join("summary.csv")).unwrap().into_deserialize().next();
    rows.unwrap().unwrap()
}

/// The box of the tiny world is 1 m x 3 m x 2 m with its lower corner at (6.5, -1, 0); the camera is at (0,
/// 0.15, 1.25). So in the map it fills x 6.5 to 7.5, y -1.15 to 1.85, z -1.25 to 0.75. On a grid of 0.2 m
/// from (0, -5, -1.15) that is 6 x 16 x 10 cells. Of those, 4 x 14 x 9 lie wholly inside; the ground is below
/// the grid.
#[test]
fn a_run_is_scored_against_the_shapes_of_its_world() {
    let dir = tempfile::tempdir().unwrap();
    let (world, out) = (dir.path().join("tiny.toml"), dir.path().join("out"));
    fs::write(&world, TINY_WORLD).unwrap();
    let dataset = format!("synth:{}", path(&world));
    let sets = [
        "truth.source=exact",
        "grid.x_m=[0, 20]",
        "grid.z_m=[-1.15, 2]",
        "stereo.disparities=16",
        "output.recording=false",
    ];
    let mut args = vec!["run", "--dataset", &dataset, "--out", path(&out)];
    args.extend(sets.iter().flat_map(|set| ["--set", set]));
    let output = evigrid(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("The exact truth: 456 occupied cells"), "{}", stdout(&output));
    let row = summary(&out);
    let number = |column: &str| row[column].parse::<usize>().unwrap();
    let (filled, inside) = (6 * 16 * 10, 4 * 14 * 9);
    assert_eq!(number("true_cells"), filled - inside);
    assert_eq!(number("observed_cells"), 100 * 50 * 16 - inside);
    assert_eq!(number("hits") + number("missed"), filled - inside);
    assert!(number("hits") > 0, "{row:?}");
    assert_eq!(row["frames_without_laser"], "0");
}

#[test]
fn a_recording_of_the_real_world_has_no_exact_truth() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    let output = drive.run(&out, &["--set", "truth.source=exact"]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.starts_with("error: truth.source: expected laser") && text.lines().count() == 1, "{text}");
    assert!(names(&out).is_empty());
}
