//! Fig. 6(a): unsafe cells found over safe cells called unsafe, along decr as in the paper, and along the evidence
//! at which a voxel is occupied (occ_t), which the paper keeps at 100.

use anyhow::Result;

use super::published::{Column, TABLE_2};
use super::runs::{Runs, Score, summary};
use super::worlds::{Entry, MATCHERS};
use crate::chart::{
    Axis, BLUE, Corner, DARK, GREEN, Marks, ORANGE, PINK, Panel, Point, SKY, Series, Sheet, YELLOW,
};
use crate::job::Job;
use crate::table::rounded;

/// Values of occ_t; 100 is the paper's. A voxel gets 10 for a hit, and 4 for one in front of it or behind.
const OCCUPIED_AT: [i32; 5] = [25, 50, 100, 200, 400];

const METHODS: [&str; 2] = ["safety-map", "safety-map-plus"];

const SCORES: [Score; 4] = [
    ("fn_percent", "safety_fn_rate", 100.0),
    ("fp_percent", "safety_fp_rate", 100.0),
    ("unclassified_percent", "safety_unclassified", 100.0),
    ("unsafe_found_percent", "safety_unsafe_found", 100.0),
];

/// A curve: what is varied, and the map at each value.
struct Curve {
    parameter: &'static str,
    matcher: &'static str,
    method: &'static str,
    points: Vec<(i32, Entry)>,
}

fn curves() -> Vec<Curve> {
    let mut curves = Vec::new();
    for (matcher, _) in MATCHERS {
        for method in METHODS {
            let entry = |c: &Column| {
                (c.decrement, Entry::new(matcher, method, vec![format!("decrement={}", c.decrement)]))
            };
            let points = TABLE_2.iter().map(entry).collect();
            curves.push(Curve { parameter: "decr", matcher, method, points });
        }
    }
    for matcher in ["multi-scale", "exact"] {
        for method in METHODS {
            let points = OCCUPIED_AT.map(|at| (at, occupied_at(matcher, method, at))).to_vec();
            curves.push(Curve { parameter: "occ_t", matcher, method, points });
        }
    }
    curves
}

fn occupied_at(matcher: &'static str, method: &'static str, at: i32) -> Entry {
    let mut entry = Entry::plain(matcher, method);
    if at != 100 {
        entry.sets.push(format!("occupied_at={at}"));
    }
    entry
}

/// The maps that are made of every world.
pub fn entries() -> Vec<Entry> {
    curves().into_iter().flat_map(|curve| curve.points).map(|(_, entry)| entry).collect()
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    for parameter in ["decr", "occ_t"] {
        let mut lines = vec![];
        if parameter == "decr" {
            let point = |c: &Column| (c.false_positive[0], 100.0 - c.false_negative[0]);
            lines.push(("the paper, its own data".to_owned(), TABLE_2.iter().map(point).collect()));
        }
        for curve in curves().into_iter().filter(|curve| curve.parameter == parameter) {
            let mut points = Vec::new();
            for (value, entry) in &curve.points {
                let means: Vec<f64> =
                    summary(&runs.values(entry, &SCORES)?).into_iter().map(|column| column[0]).collect();
                points.push((means[1], 100.0 - means[0]));
                let names = [curve.parameter, curve.matcher, curve.method].map(str::to_owned);
                let means = means.into_iter().map(|v| rounded(v, 2));
                rows.push(names.into_iter().chain([value.to_string()]).chain(means).collect::<Vec<_>>());
            }
            lines.push((format!("{}, {}", curve.method, curve.matcher), points));
        }
        panels.push(panel(parameter, lines));
    }
    let names = ["parameter", "matcher", "method", "value"];
    let header: Vec<&str> = names.into_iter().chain(SCORES.map(|score| score.0)).collect();
    job.write_table(&header, rows)?;
    job.write_picture(&sheet(panels))
}

fn panel(parameter: &str, lines: Vec<(String, Vec<Point>)>) -> Panel {
    let (title, colours): (&str, &[_]) = match parameter {
        "decr" => {
            ("decr 1, 3, 5 along each line (occ_t 100)", &[DARK, BLUE, GREEN, ORANGE, PINK, YELLOW, SKY])
        }
        _ => ("occ_t 25, 50, 100, 200, 400 along each line (decr 1)", &[BLUE, GREEN, YELLOW, SKY]),
    };
    let largest = lines.iter().flat_map(|line| &line.1).map(|point| point.0).fold(12.0, f64::max);
    let series = lines.into_iter().zip(colours).flat_map(|((name, points), &colour)| {
        let dots = Series::new("", colour, Marks::Dots(points.clone(), 4));
        [Series::new(name, colour, Marks::Line(points)), dots]
    });
    Panel {
        title: title.into(),
        x: Axis::new("false positives (%)", 0.0, largest.ceil()),
        y: Axis::new("true positives (%)", 60.0, 100.0),
        series: series.collect(),
        legend: Some(Corner::LowerRight),
    }
}

fn sheet(panels: Vec<Panel>) -> Sheet {
    Sheet {
        title: "Unsafe cells found, and safe cells called unsafe (Murarka and Kuipers 2009, Fig. 6 a)".into(),
        notes: vec![
            "up and left is better; of the cells that map and truth classify, mean over five worlds".into(),
        ],
        columns: 2,
        panel: (620, 460),
        panels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_meet_at_the_settings_of_the_paper() {
        let all = curves();
        for curve in &all {
            let at = if curve.parameter == "decr" { 1 } else { 100 };
            let entry = curve.points.iter().find(|(value, _)| *value == at).unwrap();
            assert_eq!(entry.1, Entry::plain(curve.matcher, curve.method));
        }
        assert_eq!(all.len(), 3 * 2 + 2 * 2);
    }
}
