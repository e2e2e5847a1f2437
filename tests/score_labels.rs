//! `evigrid score --truth`: maps of safety labels against true labels, file against file.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use common::runs::check_refused;
use common::{evigrid, path, stderr, stdout};

/// A few frames of a world, mapped with its exact disparities on the grid of its truth.
fn run(out: &Path, more: &[&str]) {
    let sets = [
        "truth.source=exact",
        "stereo.matcher=exact",
        "output.recording=false",
        "grid.cell_size_m=0.1",
        "grid.x_m=[0.4, 10.4]",
        "grid.y_m=[-4.5, 5.5]",
        "grid.z_m=[-2, 1]",
        // So few frames move the robot that less evidence must do.
        "safety-map.occupied_at=20",
    ];
    let mut args = vec!["run", "--dataset", "synth:safety-4", "--frames", "0..16", "--method", "safety-map"];
    args.extend(["--out", path(out)]);
    args.extend(sets.iter().chain(more).flat_map(|set| ["--set", set]));
    let output = evigrid(&args);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// The picture of the truth that `synth` writes for the same world.
fn picture(dir: &Path) -> PathBuf {
    let world = dir.join("world");
    let output = evigrid(&["synth", "safety-4", "--frames", "0..1", "--out", path(&world)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let found = walk(&world).into_iter().find(|file| file.ends_with("safety_map.png"));
    found.unwrap()
}

fn walk(dir: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { walk(&path) } else { vec![path] }).collect()
}

/// The row of a score by its headings.
fn scores(map: &Path, truth: &Path) -> HashMap<String, String> {
    let output = evigrid(&["score", path(map), "--truth", path(truth)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    let mut lines = text.lines().map(|line| line.split('|').map(|cell| cell.trim().to_owned()));
    let (header, row) = (lines.next().unwrap(), lines.nth(1).unwrap());
    header.zip(row).collect()
}

#[test]
fn a_truth_agrees_with_itself_and_with_its_picture() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    run(&out, &["score.safety_radius_m=100"]);
    let (map, truth) = (out.join("safety.safety-map.npz"), out.join("truth.safety.npz"));
    let picture = picture(dir.path());
    for other in [&truth, &picture] {
        let row = scores(&truth, other);
        for (heading, value) in [
            ("unsafe taken for safe", "0.000"),
            ("safe taken for unsafe", "0.000"),
            ("unclassified", "0.000"),
            ("unsafe found", "1.000"),
        ] {
            assert_eq!(row[heading], value, "{heading}");
        }
    }
    // With a radius that holds the whole map, the run has the same scores after its last frame.
    let mut rows = csv::Reader::from_path(out.join("frames.safety.csv")).unwrap();
    let last: HashMap<String, String> = rows.deserialize().last().unwrap().unwrap();
    let row = scores(&map, &truth);
    for (heading, column) in [
        ("unsafe taken for safe", "safety_fn_rate"),
        ("safe taken for unsafe", "safety_fp_rate"),
        ("unclassified", "safety_unclassified"),
        ("unsafe found", "safety_unsafe_found"),
        ("planes, cm", "safety_plane_distance_cm"),
    ] {
        let value: f64 = last[column].parse().unwrap();
        assert!((value - row[heading].parse::<f64>().unwrap()).abs() <= 0.0005, "{column}");
    }
    assert!(row["unsafe found"] != "0.000");
}

#[test]
fn labels_without_truth_or_on_other_cells_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let outs = [dir.path().join("a"), dir.path().join("b")];
    run(&outs[0], &[]);
    run(&outs[1], &["grid.cell_size_m=0.2"]);
    let map = outs[0].join("safety.safety-map.npz");
    let truth = outs[1].join("truth.safety.npz");
    let refused = |args: &[&str], parts: &[&str]| check_refused(&evigrid(args), parts);
    refused(&["score", path(&map), "--truth", path(&truth)], &["0.2 m", "0.1 m", path(&map), path(&truth)]);
    refused(&["score", path(&map), "--dataset", "synth:safety-4"], &["--truth", "safety.safety-map.npz"]);
    let voxels = outs[0].join("truth.npz");
    refused(&["score", path(&voxels), "--truth", path(&truth)], &["truth.npz", "labels"]);
    let both = ["score", path(&map), "--truth", path(&truth), "--dataset", "synth:safety-4"];
    refused(&both, &["--truth", "--dataset"]);
    // A grey level that stands for no label.
    let picture = picture(dir.path());
    let mut grey = image::open(&picture).unwrap().to_luma8();
    grey.put_pixel(3, 2, image::Luma([7]));
    grey.save(&picture).unwrap();
    refused(
        &["score", path(&map), "--truth", path(&picture)],
        &["safety_map.png", "found 7", "row 2, column 3"],
    );
}
