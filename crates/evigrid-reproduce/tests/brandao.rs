//! The items of `brandao`, from end to end; those on real data where `$EVIGRID_DATA` holds them.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use evigrid_eval::RealClock;
use evigrid_reproduce::{Folders, Tools, reproduce};

type Row = HashMap<String, String>;

/// Makes an item; returned are the rows of its table.
fn make(item: &str, data: &Path) -> anyhow::Result<Vec<Row>> {
    let out = tempfile::tempdir()?;
    let folders = Folders { data: data.to_owned(), out: out.path().to_owned() };
    let clock = RealClock::default();
    let mut tools = Tools { report: &mut |_| {}, clock: &clock, recorder: &|_| Ok(None) };
    let files = reproduce(&format!("brandao/{item}"), &folders, &mut tools)?;
    for ending in ["csv", "svg"] {
        let path = out.path().join(format!("brandao/{item}.{ending}"));
        assert!(files.contains(&path), "{files:?}");
    }
    let svg = std::fs::read_to_string(out.path().join(format!("brandao/{item}.svg")))?;
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    let mut table = csv::Reader::from_path(out.path().join(format!("brandao/{item}.csv")))?;
    Ok(table.deserialize().collect::<Result<_, _>>()?)
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// The root of the real data, if they are there.
fn real_data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("EVIGRID_DATA").map_or(beside, PathBuf::from);
    let found = root.join("middlebury/cones").is_dir() && root.join("kitti_raw").is_dir();
    if !found {
        // Not `println`, which a passing test swallows.
        let _ = writeln!(std::io::stderr(), "skipped: no real data at {} (set EVIGRID_DATA)", root.display());
    }
    found.then_some(root)
}

const NOWHERE: &str = "/nonexistent";

/// Values computed independently from the closed form.
#[test]
fn fig1_has_the_known_values() {
    let rows = make("fig1", Path::new(NOWHERE)).unwrap();
    assert_eq!(rows.len(), 40);
    assert!(rows.iter().all(|row| row.len() == 2));
    let p = |cell: usize| {
        assert_eq!(number(&rows[cell - 1], "cell"), cell as f64);
        number(&rows[cell - 1], "p")
    };
    // In front of the measurement, at it, and behind it; evigrid-cost-curve's tests hold the cells between.
    for (cell, value) in [(12, 0.028629), (17, 0.421502), (20, 0.508414), (22, 0.502713)] {
        assert!((p(cell) - value).abs() < 1e-6, "cell {cell}: {}", p(cell));
    }
    assert!((1..=40).all(|cell| p(cell) <= p(20)) && p(1) < 1e-6 && (p(40) - 0.5).abs() < 1e-6);
}

/// Eqs 4 and 5 from the likelihoods in the table, by the identities that follow from them.
#[test]
fn fig2_follows_from_the_costs_that_it_carries() {
    let rows = make("fig2", Path::new(NOWHERE)).unwrap();
    assert_eq!(rows.len(), 3 * 60);
    for curve in rows.chunks(60) {
        let sum: f64 = curve.iter().map(|row| (-number(row, "cost") / 4.0).exp()).sum();
        let mut visible = 1.0;
        for row in curve {
            let p = (-number(row, "cost") / 4.0).exp() / sum;
            assert!((number(row, "likelihood") - p).abs() < 1e-8);
            assert!((number(row, "visibility") - visible).abs() < 1e-8);
            assert!((number(row, "whole_curve") - 0.5 - visible * (p - 0.5)).abs() < 1e-8);
            visible *= 1.0 - p;
        }
    }
}

#[test]
fn fig4_falls_back_to_a_synthetic_world() {
    let rows = make("fig4", Path::new(NOWHERE)).unwrap();
    assert_eq!(rows.len(), 3 * 128);
    for curve in rows.chunks(128) {
        let total: f64 = curve.iter().map(|row| number(row, "likelihood")).sum();
        assert!((total - 1.0).abs() < 1e-6);
        // In the world `bars` a disparity of 125 px is 1 m.
        assert!(curve.iter().all(|row| {
            let d = number(row, "disparity_px");
            d == 0.0 || (number(row, "depth_m") - 125.0 / d).abs() < 1e-3
        }));
    }
}

#[test]
fn what_data_are_missing_is_said() {
    for (item, id) in [
        ("fig3", "middlebury-cones"),
        ("fig8", "2011_09_26_drive_0013"),
        ("fig9", "2011_09_26_drive_0013"),
        ("fig10", "2011_09_26_drive_0013"),
    ] {
        let error = make(item, Path::new(NOWHERE)).unwrap_err().to_string();
        let command = format!("scripts/download_datasets.sh {id}");
        assert!(error.contains(&format!("brandao/{item}")) && error.contains(&command), "{error}");
    }
}

/// Against a histogram by brute force: every window's 49 differences summed up by themselves.
#[test]
fn fig3_on_cones() {
    let Some(data) = real_data() else { return };
    let rows = make("fig3", &data).unwrap();
    let dir = data.join("middlebury/cones");
    let frame = evigrid_replay::open(&dir).unwrap().frame(0, &evigrid_core::Pose::identity()).unwrap();
    let truth = evigrid_replay::middlebury_truth(&dir).unwrap();
    let (width, height) = (truth.width(), truth.height());
    let sad = |x: usize, y: usize, d: usize| -> usize {
        let window = (0..49).map(|n| (x + n % 7 - 3, y + n / 7 - 3));
        let difference =
            |(x, y): (usize, usize)| frame.left().row(y)[x].abs_diff(frame.right().row(y)[x - d]);
        window.map(|at| usize::from(difference(at))).sum()
    };
    let mut counts = [vec![0.0; rows.len()], vec![0.0; rows.len()]];
    for (x, y) in (3..height - 3).flat_map(|y| (3..width - 3).map(move |x| (x, y))) {
        // Whole pixels; NaN is unknown.
        let d_true = truth.row(y)[x];
        for d in (0..64).filter(|d| x >= d + 3 && d_true <= *d as f32) {
            counts[usize::from(d_true == d as f32)][sad(x, y, d) / 150] += 1.0;
        }
    }
    for (counts, column) in counts.iter().zip(["free_space_share", "true_position_share"]) {
        let all: f64 = counts.iter().sum();
        for (row, count) in rows.iter().zip(counts) {
            assert!((number(row, column) - count / all).abs() < 1e-6, "{column} from {}", row["cost_from"]);
        }
    }
}

#[test]
fn fig9_on_a_drive() {
    let Some(data) = real_data() else { return };
    let rows = make("fig9", &data).unwrap();
    let [row] = &rows[..] else { panic!("{rows:?}") };
    let [hits, mistakes, missed] = ["hits", "mistakes", "missed"].map(|c| number(row, c));
    assert!((number(row, "precision") - hits / (hits + mistakes)).abs() < 1e-4);
    assert!((number(row, "f1") - 2.0 * hits / (2.0 * hits + mistakes + missed)).abs() < 1e-4);
    // The laser's occupied cells, counted independently: 29216.
    assert!(row["dataset"] != "2011_09_26_drive_0013" || ((hits + missed) / 29216.0 - 1.0).abs() < 0.01);
}
