//! Table II and section VII-C: rates of the safety maps over five data sets, for three decrements, and the errors
//! of their planes. Beside the paper's method stands the project's own variant, beside the paper's kind of matcher
//! block matching at one scale and the exact disparities.

use anyhow::Result;
use evigrid_metrics::Scores;

use super::published::{PLANES, TABLE_2};
use super::worlds::{Entry, MATCHERS, WORLDS, mean_and_deviation, scores};
use crate::chart::{
    Axis, BLUE, Corner, GREEN, Marks, ORANGE, PINK, Panel, Point, SKY, Series, Sheet, YELLOW,
};
use crate::job::Job;
use crate::table::rounded;

/// Columns of the table: name, score, and factor to percent or to the unit.
const COLUMNS: [(&str, &str, f64); 10] = [
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
            entries.extend(TABLE_2.iter().map(|column| {
                let sets = vec![format!("decrement={}", column.decrement)];
                Entry { matcher, method, sets }
            }));
        }
    }
    entries
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let entries = entries();
    let mut found = Vec::new();
    for world in WORLDS {
        found.push(scores(job, world, &entries)?);
    }
    let mut rows: Vec<Vec<String>> = TABLE_2
        .iter()
        .map(|column| {
            let mut row =
                vec!["paper".into(), "safety-map".into(), column.decrement.to_string(), "mean".into()];
            row.extend([column.false_negative[0], column.false_positive[0]].map(|v| rounded(v, 2)));
            row.extend(["", "", "", "", ""].map(String::from));
            let planes = if column.decrement == 1 {
                PLANES.map(|v| rounded(v, 2))
            } else {
                [String::new(), String::new()]
            };
            row.extend(planes);
            row.push(String::new());
            row
        })
        .collect();
    let mut series = vec![published()];
    for (n, entry) in entries.iter().enumerate() {
        let of_worlds: Vec<&Scores> = found.iter().map(|world| &world[n]).collect();
        rows.extend(entry_rows(entry, &of_worlds));
        add_point(&mut series, entry, &of_worlds);
    }
    let header: Vec<&str> =
        ["matcher", "method", "decrement", "world"].into_iter().chain(COLUMNS.map(|c| c.0)).collect();
    job.write_table(&header, rows)?;
    job.write_picture(&sheet(series))
}

/// A row per world, then mean and deviation over the worlds that have a value.
fn entry_rows(entry: &Entry, of_worlds: &[&Scores]) -> Vec<Vec<String>> {
    let decrement = entry.sets[0].trim_start_matches("decrement=");
    let row = |world: &str, values: Vec<f64>| {
        let known = [entry.matcher, entry.method, decrement, world].map(str::to_owned);
        known.into_iter().chain(values.into_iter().map(|v| rounded(v, 2))).collect::<Vec<String>>()
    };
    let values: Vec<Vec<f64>> = of_worlds.iter().map(|scores| values(scores)).collect();
    let summary = |which: usize| {
        let column = |n: usize| {
            let known: Vec<f64> = values.iter().map(|row| row[n]).filter(|v| !v.is_nan()).collect();
            mean_and_deviation(&known)[which]
        };
        (0..COLUMNS.len()).map(column).collect::<Vec<f64>>()
    };
    let mut rows: Vec<Vec<String>> =
        WORLDS.iter().zip(&values).map(|(world, values)| row(world, values.clone())).collect();
    rows.extend([row("mean", summary(0)), row("deviation", summary(1))]);
    rows
}

fn values(scores: &Scores) -> Vec<f64> {
    COLUMNS.iter().map(|(_, name, factor)| factor * scores.get(name).unwrap_or(f64::NAN)).collect()
}

/// A line of Fig. 6(a): true over false positives, one point per decrement.
struct Line {
    name: String,
    points: Vec<Point>,
}

fn published() -> Line {
    let point = |c: &super::published::Column| (c.false_positive[0], 100.0 - c.false_negative[0]);
    Line { name: "the paper, its own data".into(), points: TABLE_2.iter().map(point).collect() }
}

fn add_point(lines: &mut Vec<Line>, entry: &Entry, of_worlds: &[&Scores]) {
    let mean = |n: usize| {
        let values: Vec<f64> = of_worlds.iter().map(|scores| values(scores)[n]).collect();
        mean_and_deviation(&values)[0]
    };
    let (name, point) = (format!("{}, {}", entry.method, entry.matcher), (mean(1), 100.0 - mean(0)));
    match lines.iter_mut().find(|line| line.name == name) {
        Some(line) => line.points.push(point),
        None => lines.push(Line { name, points: vec![point] }),
    }
}

fn sheet(lines: Vec<Line>) -> Sheet {
    let colours = [crate::chart::DARK, BLUE, GREEN, ORANGE, PINK, YELLOW, SKY];
    let series = lines.into_iter().zip(colours).flat_map(|(line, colour)| {
        let dots = Series::new("", colour, Marks::Dots(line.points.clone(), 4));
        [Series::new(line.name, colour, Marks::Line(line.points)), dots]
    });
    Sheet {
        title: "Unsafe cells found, and safe cells called unsafe (Murarka and Kuipers 2009, Table II)".into(),
        notes: vec![
            "up and left is better; of the cells that map and truth classify, mean over five worlds".into(),
            "along a line: decr 1, 3, 5".into(),
        ],
        columns: 1,
        panel: (700, 460),
        panels: vec![Panel {
            title: String::new(),
            x: Axis::new("false positives (%)", 0.0, 12.0),
            y: Axis::new("true positives (%)", 60.0, 100.0),
            series: series.collect(),
            legend: Some(Corner::LowerRight),
        }],
    }
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
