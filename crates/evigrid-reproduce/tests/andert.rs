//! The items of `andert` that need no data, from end to end.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{make, number};

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found}, expected {expected}");
}

/// Values computed independently from eqs 9 and 10.
#[test]
fn fig1_has_the_known_values() {
    let item = make("andert/fig1", &["points"]).unwrap();
    assert_eq!(item.header, ["measured_m", "l_m", "p", "log_odds"]);
    for (point, [measured, deviation, peak]) in item.more["points"].iter().zip([
        [10.0, 0.238095, 0.667556],
        [20.0, 0.952381, 0.541889],
        [40.0, 3.809524, 0.510472],
    ]) {
        assert_eq!(number(point, "measured_m"), measured);
        near(number(point, "deviation_m"), deviation, 5e-7);
        near(number(point, "peak_p"), peak, 5e-7);
        near(number(point, "free_p"), 0.35, 5e-7);
        // 0.5 = 0.35 + (peak - 0.35) exp(-t^2 / 2).
        let t = (2.0 * ((number(point, "peak_p") - 0.35) / 0.15).ln()).sqrt();
        near(number(point, "crossing_m"), measured - t * number(point, "deviation_m"), 1e-6);
        let row =
            item.rows.iter().find(|r| number(r, "measured_m") == measured && number(r, "l_m") == measured);
        near(number(row.unwrap(), "p"), peak, 5e-7);
    }
    for row in &item.rows {
        let p = number(row, "p");
        near(number(row, "log_odds"), (p / (1.0 - p)).ln(), 1e-7);
    }
}

#[test]
fn fig3_has_the_layers_of_the_equation() {
    let item = make("andert/fig3", &["edges"]).unwrap();
    let edges: Vec<f64> = item.more["edges"].iter().map(|row| number(row, "first_disparity_px")).collect();
    for (edge, expected) in edges.iter().zip([0.6, 1.2, 2.4, 4.8, 9.6, 19.2, 38.4]) {
        near(*edge, expected, 5e-7);
    }
    for row in &item.rows {
        let size = number(row, "layer_pixel_m");
        assert!(size > 0.25 - 1e-6 && size <= 0.5 + 1e-6, "{row:?}");
        near(number(row, "one_pixel_m"), 0.3 / number(row, "disparity_px"), 1e-6);
    }
}

#[test]
fn fig4_follows_the_equation() {
    let item = make("andert/fig4", &[]).unwrap();
    assert_eq!(item.rows.len(), 200 * 200);
    for row in item.rows.iter().step_by(97) {
        let distance = number(row, "x_m").hypot(number(row, "y_m"));
        let sigma = 0.2_f64.hypot(distance * 2.0_f64.to_radians());
        near(number(row, "sigma_m"), sigma, 1e-4);
        assert_eq!(number(row, "kernel_cells"), 6.0 * (sigma / 0.25).round() + 1.0);
    }
}

#[test]
fn fig5_blurs_more_and_more_cells() {
    let item = make("andert/fig5", &["cells"]).unwrap();
    let touched: Vec<f64> = item.more["cells"].iter().map(|row| number(row, "touched_cells")).collect();
    assert!(touched[0] < touched[1] && touched[1] < touched[2], "{touched:?}");
}

#[test]
fn table1_has_all_rows_with_the_published_numbers_beside() {
    let item = make("andert/table1", &["claims"]).unwrap();
    assert_eq!(item.rows.len(), 2 * 3 * 5);
    assert!(item.rows.iter().all(|row| row["identities"] == "met"));
    let row = |image: &str, c: &str, algorithm: &str| {
        let is = |row: &&common::Row| {
            row["image"] == image && row["cell_size_m"] == c && row["algorithm"] == algorithm
        };
        item.rows.iter().find(is).unwrap()
    };
    assert_eq!(row("exact", "0.25", "ray")["cells_drawn"], "650440");
    assert_eq!(row("exact", "0.25", "ray-pyramid")["used_pixels"], (4 * 215_320).to_string());
    assert_eq!(row("exact", "0.25", "ray, windows of 1 m")["used_pixels"], "633191047");
    assert_eq!(row("exact", "0.5", "line-pyramid")["paper_cells_drawn"], "27942");
    let drawn = |algorithm| number(row("exact", "1", algorithm), "cells_drawn");
    assert!(drawn("line") > 100.0 * drawn("line-pyramid"));
    // Of what is matched, as the published picture was.
    for c in ["1", "0.5", "0.25"] {
        let different = |algorithm| number(row("matched", c, algorithm), "different_cells");
        near(different("line-pyramid") / different("line"), 1.0, 0.1);
    }
}
