//! Table II and section VII-C: rates of the safety maps over five data sets, for three decrements, and the errors
//! of their planes. Beside the paper's method stands the project's own variant, beside the paper's kind of matcher
//! block matching at one scale and the exact disparities.

use anyhow::Result;

use super::published::{Column, PLANES, TABLE_2};
use super::runs::{Runs, Score, summary};
use super::worlds::{Entry, MATCHERS, WORLDS};
use crate::job::Job;
use crate::table::rounded;

/// Columns of the table.
const COLUMNS: [Score; 10] = [
    ("fn_percent", "safety_fn_rate", 100.0),
    ("fp_percent", "safety_fp_rate", 100.0),
    ("fn_off_borders_percent", "safety_fn_rate_off_borders", 100.0),
    ("fp_off_borders_percent", "safety_fp_rate_off_borders", 100.0),
    ("unclassified_percent", "safety_unclassified", 100.0),
    ("unsafe_found_percent", "safety_unsafe_found", 100.0),
    ("inclined_found_percent", "safety_inclined_found", 100.0),
    ("plane_angle_deg", "safety_plane_angle_deg", 1.0),
    ("plane_distance_cm", "safety_plane_distance_cm", 1.0),
    ("inclined_plane_angle_deg", "safety_inclined_plane_angle_deg", 1.0),
];

/// The maps that are made of every world.
pub fn entries() -> Vec<Entry> {
    let mut entries = Vec::new();
    for (matcher, _) in MATCHERS {
        for method in ["safety-map", "safety-map-plus"] {
            let sets = |column: &Column| vec![format!("decrement={}", column.decrement)];
            entries.extend(TABLE_2.iter().map(|column| Entry::new(matcher, method, sets(column))));
        }
    }
    entries
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let mut rows: Vec<Vec<String>> = TABLE_2
        .iter()
        .map(|column| {
            let mut row =
                vec!["paper".into(), "safety-map".into(), column.decrement.to_string(), "mean".into()];
            row.extend([column.false_negative[0], column.false_positive[0]].map(|v| rounded(v, 2)));
            row.extend(["", "", "", "", ""].map(String::from));
            let planes = if column.decrement == 1 {
                PLANES.map(|[mean, _]| rounded(mean, 2))
            } else {
                [String::new(), String::new()]
            };
            row.extend(planes);
            row.push(String::new());
            row
        })
        .collect();
    for entry in entries() {
        rows.extend(entry_rows(&entry, &runs.values(&entry, &COLUMNS)?));
    }
    let header: Vec<&str> =
        ["matcher", "method", "decrement", "world"].into_iter().chain(COLUMNS.map(|c| c.0)).collect();
    job.write_table(&header, rows)
}

/// A row per world, then mean and deviation over the worlds that have a value.
fn entry_rows(entry: &Entry, values: &[Vec<f64>]) -> Vec<Vec<String>> {
    let decrement = entry.sets[0].trim_start_matches("decrement=");
    let row = |world: &str, values: Vec<f64>| {
        let known = [entry.matcher, entry.method, decrement, world].map(str::to_owned);
        known.into_iter().chain(values.into_iter().map(|v| rounded(v, 2))).collect::<Vec<String>>()
    };
    let summary = |which: usize| summary(values).into_iter().map(|column| column[which]).collect();
    let mut rows: Vec<Vec<String>> =
        WORLDS.iter().zip(values).map(|(world, values)| row(world, values.clone())).collect();
    rows.extend([row("mean", summary(0)), row("deviation", summary(1))]);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_matcher_method_and_decrement_is_there_once() {
        let names: std::collections::BTreeSet<String> =
            entries().iter().map(|e| format!("{} {} {}", e.matcher, e.method, e.sets[0])).collect();
        assert_eq!(names.len(), 3 * 2 * 3);
        assert!(names.contains("exact safety-map decrement=5"));
    }
}
