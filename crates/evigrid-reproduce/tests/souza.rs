//! The items of `souza` that need no data, from end to end.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{make, number};

/// Peaks computed independently from eqs 11 and 13.
#[test]
fn fig1_has_the_known_peaks() {
    let item = make("souza/fig1", &[]).unwrap();
    assert_eq!(item.header, ["eps_m", "measured_m", "l_m", "p", "log_odds"]);
    for (eps, peaks) in [
        (0.0, [0.667556, 0.541889, 0.510472]),
        (0.1, [0.617997, 0.537909, 0.510204]),
        (0.5, [0.554050, 0.527468, 0.509257]),
    ] {
        for (measured, peak) in [10.0, 20.0, 40.0].into_iter().zip(peaks) {
            let of = |row: &&common::Row| {
                let is = |column, value: f64| number(row, column) == value;
                is("eps_m", eps) && is("measured_m", measured) && is("l_m", measured)
            };
            let p = number(item.rows.iter().find(of).unwrap(), "p");
            assert!((p - peak).abs() < 5e-7, "{eps} {measured}: {p}");
        }
    }
}

/// Every occupied cell is in the table, at the centre of a cell.
#[test]
fn fig9_lists_the_occupied_cells() {
    let item = make("souza/fig9", &["scores"]).unwrap();
    let scores = &item.more["scores"];
    let counted: usize = scores.iter().map(|score| number(score, "occupied_cells") as usize).sum();
    assert_eq!(counted, item.rows.len());
    assert!(item.rows.iter().all(|row| number(row, "log_odds") >= 0.0));
    let off = |row: &common::Row| (number(row, "x_m") / 0.1).fract();
    assert!(item.rows.iter().all(|row| (off(row) - 0.5).abs() < 1e-6));
    for score in scores {
        let [right, all] = ["of_these_on_a_surface", "occupied_cells"].map(|column| number(score, column));
        assert!(right > 0.2 * all && right <= all, "{right} of {all}");
    }
}
