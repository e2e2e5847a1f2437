//! Methods that show ground plans, from the command line: scored frame by frame, and what is refused.
#![allow(clippy::unwrap_used, missing_docs)]

use std::path::Path;
use std::process::{Command, Output};

const BINARY: &str = env!("CARGO_BIN_EXE_evigrid");

/// The street's first frames on 20 m x 20 m.
fn run(out: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(BINARY);
    command.args(["run", "--dataset", "synth:street", "--frames", "0..3", "--out"]).arg(out);
    let settings = [
        "grid.x_m=[0,20]",
        "grid.y_m=[-10,10]",
        "grid.z_m=[-2,1]",
        "output.recording=false",
        "stereo.disparities=65",
    ];
    settings.iter().for_each(|setting| {
        command.args(["--set", setting]);
    });
    command.args(more).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The rows of a table, header first.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let table = std::fs::read_to_string(path).unwrap();
    table.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn plans_of_all_methods_stand_in_one_table_frame_by_frame() {
    let dir = tempfile::tempdir().unwrap();
    let methods = ["visibility", "visibility-filtered", "ternary", "souza"];
    let mut more = vec!["--set", "stereo.matcher=double-correlation"];
    methods.iter().for_each(|method| more.extend(["--method", method]));
    let output = run(dir.path(), &more);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary = rows(&dir.path().join("summary.plan.csv"));
    let column = |name: &str| summary[0].iter().position(|column| column == name).unwrap();
    let auc = |row: &[String]| row[column("plan_frames_auc")].parse::<f64>().unwrap();
    let found: Vec<&str> = summary[1..].iter().map(|row| row[1].as_str()).collect();
    assert_eq!(found, methods);
    // Far from a plan that knows nothing (0.5), and the ternary grid far from it.
    assert!(auc(&summary[1]) > 0.85 && auc(&summary[2]) > 0.85, "{summary:?}");
    assert!(auc(&summary[3]) < auc(&summary[1]) - 0.1, "{summary:?}");
    // Four bands and all together; ten bins; a hundred and one thresholds.
    for (name, of_each) in [("bands", 5), ("reliability", 10), ("roc", 101)] {
        let rows = rows(&dir.path().join(format!("{name}.plan.csv")));
        assert_eq!(rows.len(), 1 + of_each * methods.len(), "{name}");
    }
    // All methods are scored on the same cells.
    let bands = rows(&dir.path().join("bands.plan.csv"));
    let cells: Vec<&String> =
        bands[1..].iter().filter(|row| row[2..4] == ["0", "20"]).map(|row| &row[4]).collect();
    assert!(cells.iter().all(|n| *n == cells[0]) && cells.len() == methods.len(), "{cells:?}");
}

#[test]
fn a_short_range_of_disparities_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let more = ["--method", "visibility", "--set", "stereo.matcher=exact", "--set", "stereo.disparities=12"];
    let output = run(dir.path(), &more);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stderr);
    assert!(
        said.contains("the largest, 11 px, is ") && said.contains("what is nearer stays unknown"),
        "{said}"
    );
}

#[test]
fn what_cannot_tell_road_from_obstacles_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], part: &str| {
        let output = run(dir.path(), more);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
        assert!(errors.len() == 1 && errors[0].contains(part), "{said}");
    };
    refused(
        &["--method", "ternary", "--set", "stereo.matcher=block"],
        "expected double-correlation or exact for `ternary`",
    );
    let with = |setting: &'static str| {
        ["--method", "visibility-filtered", "--set", "stereo.matcher=exact", "--set", setting]
    };
    refused(
        &with("visibility-filtered.velocities=4"),
        "velocities: expected an odd number from 1 to 41, found 4",
    );
    refused(&with("visibility-filtered.filter=kalman"), "visibility-filtered");
    refused(
        &with("visibility-filtered.velocity_step_mps=0.001"),
        "velocity_step_mps: expected at least 0.02 cells from frame to frame",
    );
}
