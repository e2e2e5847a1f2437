//! Which hazards of the worlds are found, and from how far: each drop-off, step, railing, table, wedge and pit, and
//! whether ramps stay safe.

use anyhow::Result;
use evigrid_metrics::AreaTally;
use evigrid_results::{HAZARD_COLUMNS, hazard_cells};

use super::runs::Runs;
use super::worlds::{Entry, MATCHERS, WORLDS, mean_and_deviation};
use crate::chart::{Axis, BLUE, Corner, Marks, ORANGE, Panel, Point, Series, Sheet};
use crate::job::Job;
use crate::table::rounded;

const METHODS: [&str; 2] = ["safety-map", "safety-map-plus"];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let (mut rows, mut kinds, mut panels) = (Vec::new(), Vec::new(), Vec::new());
    for (matcher, _) in MATCHERS {
        let mut of_methods = Vec::new();
        for method in METHODS {
            let tallies = runs.tallies(&Entry::plain(matcher, method))?;
            for (world, tally) in WORLDS.into_iter().zip(&tallies) {
                let names = [matcher, method, world].map(str::to_owned);
                let row = |area| names.iter().cloned().chain(hazard_cells(area)).collect::<Vec<_>>();
                rows.extend(tally.areas.iter().map(row));
            }
            let areas: Vec<&AreaTally> = tallies.iter().flat_map(|tally| &tally.areas).collect();
            kinds.extend(kind_rows([matcher, method], &areas));
            of_methods.push(areas);
        }
        panels.push(panel(matcher, &of_methods));
    }
    let names = ["matcher", "method", "world"];
    let header: Vec<&str> = names.into_iter().chain(HAZARD_COLUMNS).collect();
    job.write_table(&header, rows)?;
    job.write_more("kinds", &KIND_COLUMNS, kinds)?;
    job.write_picture(&sheet(panels))
}

const KIND_COLUMNS: [&str; 9] = [
    "matcher",
    "method",
    "kind",
    "areas",
    "half_found",
    "right_at_nearest_percent",
    "wrong_at_nearest_percent",
    "worst_right_percent",
    "half_m",
];

/// The kinds in the order in which they first occur.
fn kinds_of<'a>(areas: &[&'a AreaTally]) -> Vec<&'a str> {
    let mut kinds: Vec<&str> = Vec::new();
    for tally in areas {
        if !kinds.contains(&tally.area.kind.as_str()) {
            kinds.push(&tally.area.kind);
        }
    }
    kinds
}

/// The areas of a kind that came within the planning radius.
fn seen<'a>(areas: &[&'a AreaTally], kind: &str) -> Vec<&'a AreaTally> {
    areas.iter().copied().filter(|tally| tally.area.kind == kind && tally.nearest.is_some()).collect()
}

/// Shares of right and wrong cells when the robot is nearest, percent.
fn at_nearest(tally: &AreaTally) -> [f64; 2] {
    let counts = tally.nearest.map(|view| view.counts).unwrap_or_default();
    [100.0 * tally.recall(&counts), 100.0 * tally.wrong(&counts)]
}

/// A row per kind of hazard: how many there are, in how many half of the cells was right at some time, means of
/// what is right and wrong at the nearest place, the least that is right, and the mean distance from which half
/// was right.
fn kind_rows(names: [&str; 2], areas: &[&AreaTally]) -> Vec<Vec<String>> {
    let row = |kind: &str| {
        let seen = seen(areas, kind);
        let shares: Vec<[f64; 2]> = seen.iter().map(|tally| at_nearest(tally)).collect();
        let mean = |n: usize| mean_and_deviation(&shares.iter().map(|s| s[n]).collect::<Vec<_>>())[0];
        let worst = shares.iter().map(|s| s[0]).fold(f64::NAN, f64::min);
        let half: Vec<f64> = seen.iter().filter_map(|tally| Some(tally.half?.distance_m)).collect();
        let counts = [seen.len(), half.len()].map(|n| n.to_string());
        let shares = [mean(0), mean(1), worst].map(|v| rounded(v, 0));
        let half = [rounded(mean_and_deviation(&half)[0], 1)];
        let names = names.iter().map(|name| (*name).to_owned()).chain([kind.to_owned()]);
        names.chain(counts).chain(shares).chain(half).collect()
    };
    kinds_of(areas).into_iter().map(row).collect()
}

/// A dot per hazard over its kind.
fn panel(matcher: &str, of_methods: &[Vec<&AreaTally>]) -> Panel {
    let kinds = of_methods.first().map(|areas| kinds_of(areas)).unwrap_or_default();
    let series = of_methods.iter().enumerate().map(|(n, areas)| {
        // The two methods beside each other.
        let offset = 0.15 * (1.0 - 2.0 * n as f64);
        let points = kinds.iter().enumerate().flat_map(|(place, kind)| {
            let point = move |tally: &AreaTally| -> Point { (at_nearest(tally)[0], place as f64 + offset) };
            seen(areas, kind).into_iter().map(point)
        });
        Series::new(METHODS[n], [BLUE, ORANGE][n], Marks::Dots(points.collect(), 4))
    });
    let series = series.collect();
    Panel {
        title: format!("{matcher} disparities"),
        x: Axis::new("cells that are right when the robot is nearest (%)", 0.0, 100.0),
        y: Axis {
            label: String::new(),
            // Room for the legend above the last kind.
            range: [-0.7, kinds.len() as f64 + 2.0],
            names: kinds.iter().map(|kind| (*kind).to_owned()).collect(),
        },
        series,
        legend: Some(Corner::UpperLeft),
    }
}

fn sheet(panels: Vec<Panel>) -> Sheet {
    Sheet {
        title: "Hazards that are found (unsafe in the map), and safe areas (safe in the map)".into(),
        notes: vec![
            "one dot per hazard of the five worlds; to the right is better".into(),
            "cells within the planning radius of 4 m, those that the camera has not seen included".into(),
        ],
        columns: 1,
        panel: (900, 420),
        panels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_metrics::{AreaView, NamedArea, SafetyCounts};

    fn tally(kind: &str, true_positives: usize, false_negatives: usize, half_m: Option<f64>) -> AreaTally {
        let area = NamedArea { name: String::new(), kind: kind.into(), is_safe: false, cells: vec![0] };
        let counts = SafetyCounts { true_positives, false_negatives, ..SafetyCounts::default() };
        let view = |distance_m| AreaView { distance_m, counts };
        AreaTally { nearest: Some(view(1.0)), half: half_m.map(view), ..AreaTally::new(area) }
    }

    #[test]
    fn kinds_are_means_over_their_hazards_in_reach() {
        let far = AreaTally { nearest: None, ..tally("step", 0, 9, None) };
        let areas =
            [tally("step", 3, 1, Some(2.0)), tally("pit", 0, 2, None), far, tally("step", 1, 1, Some(3.0))];
        let rows = kind_rows(["exact", "m"], &areas.iter().collect::<Vec<_>>());
        assert_eq!(rows[0], ["exact", "m", "step", "2", "2", "62", "38", "50", "2.5"]);
        assert_eq!(rows[1], ["exact", "m", "pit", "1", "0", "0", "100", "0", ""]);
    }
}
