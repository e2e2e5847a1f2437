//! Where the errors of safety maps lie, and which hazards they hold, as tables.

use evigrid_metrics::{AreaTally, AreaView, PlaceCounts, SafetyCounts};

use crate::{RunInfo, RunResult};

const PLACES_HEADER: [&str; 14] = [
    "dataset",
    "method",
    "place",
    "from_m",
    "to_m",
    "true_positives",
    "false_positives",
    "true_negatives",
    "false_negatives",
    "unclassified_safe",
    "unclassified_unsafe",
    "fn_rate",
    "fp_rate",
    "unclassified",
];

const HAZARDS_HEADER: [&str; 12] = [
    "dataset",
    "method",
    "area",
    "kind",
    "cells",
    "nearest_m",
    "right_at_nearest",
    "wrong_at_nearest",
    "right",
    "wrong",
    "first_m",
    "half_m",
];

/// The table of places: header, then one row per method and place. Sums over frames within the planning radius;
/// rates are empty where nothing was counted.
pub(crate) fn place_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![PLACES_HEADER.map(str::to_owned).to_vec()];
    for (method, tally) in result.safety() {
        let places = tally.places.list(tally.cell_size_m);
        rows.extend(places.iter().map(|place| place_row(info, method, place)));
    }
    rows
}

fn place_row(info: &RunInfo, method: &str, place: &PlaceCounts) -> Vec<String> {
    let counts = &place.counts;
    let mut row = vec![info.dataset.clone(), method.to_owned(), place.place.to_owned()];
    row.extend(place.range_m.map(|limit| limit.map_or(String::new(), |m| format!("{m:.3}"))));
    row.extend(numbers(counts).map(|n| n.to_string()));
    let rates = [counts.false_negative_rate(), counts.false_positive_rate(), counts.unclassified_rate()];
    row.extend(rates.map(rate));
    row
}

fn numbers(counts: &SafetyCounts) -> [usize; 6] {
    [
        counts.true_positives,
        counts.false_positives,
        counts.true_negatives,
        counts.false_negatives,
        counts.unclassified_safe,
        counts.unclassified_unsafe,
    ]
}

/// The table of hazards and safe areas: header, then one row per method and area. `right` and `wrong` are shares
/// of its cells within the planning radius; distances are those of the robot from the nearest of its cells.
pub(crate) fn hazard_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![HAZARDS_HEADER.map(str::to_owned).to_vec()];
    for (method, tally) in result.safety() {
        rows.extend(tally.areas.iter().map(|area| hazard_row(info, method, area)));
    }
    rows
}

fn hazard_row(info: &RunInfo, method: &str, tally: &AreaTally) -> Vec<String> {
    let area = &tally.area;
    let distance = |view: &Option<AreaView>| view.map_or(String::new(), |v| format!("{:.3}", v.distance_m));
    let at_nearest = tally.nearest.map(|view| view.counts).unwrap_or_default();
    let mut row = vec![info.dataset.clone(), method.to_owned(), area.name.clone(), area.kind.clone()];
    row.extend([area.cells.len().to_string(), distance(&tally.nearest)]);
    row.extend([tally.recall(&at_nearest), tally.wrong(&at_nearest)].map(rate));
    row.extend([tally.recall(&tally.counts), tally.wrong(&tally.counts)].map(rate));
    row.extend([distance(&tally.first), distance(&tally.half)]);
    row
}

fn rate(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.6}") }
}

/// The hazards as a table that a person reads: a row per area, a column per method with what the map says when
/// the robot is nearest, and from how far half of the area was right for the first time. Empty without areas.
pub(crate) fn hazards_page(result: &RunResult) -> Vec<Vec<String>> {
    let methods: Vec<_> = result.safety().collect();
    let Some((_, first)) = methods.first().filter(|(_, tally)| !tally.areas.is_empty()) else {
        return Vec::new();
    };
    let names = methods.iter().map(|(name, _)| (*name).to_owned());
    let mut rows = vec![["area", "kind"].map(str::to_owned).into_iter().chain(names).collect()];
    for (n, area) in first.areas.iter().enumerate().filter(|(_, area)| area.nearest.is_some()) {
        let cells = methods.iter().map(|(_, tally)| hazard_cell(&tally.areas[n]));
        rows.push([area.area.name.clone(), area.area.kind.clone()].into_iter().chain(cells).collect());
    }
    rows
}

fn hazard_cell(tally: &AreaTally) -> String {
    let Some(nearest) = tally.nearest else { return String::new() };
    let right = 100.0 * tally.recall(&nearest.counts);
    match tally.half {
        Some(half) => format!("{right:.0} %, from {:.1} m", half.distance_m),
        None => format!("{right:.0} %"),
    }
}
