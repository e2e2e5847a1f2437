//! Where the errors of safety maps lie, and which hazards they hold, as tables.

use evigrid_metrics::{AreaTally, AreaView, PlaceCounts, SafetyCounts};

use crate::{RunInfo, RunResult};

/// Columns of a place, after those that name the map.
pub const PLACE_COLUMNS: [&str; 12] = [
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

/// Columns of a hazard or safe area, after those that name the map. `right` and `wrong` are shares of its cells
/// within the planning radius; distances are those of the robot from the nearest of its cells.
pub const HAZARD_COLUMNS: [&str; 10] = [
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

/// Columns that name the map.
const NAMES: [&str; 2] = ["dataset", "method"];

fn header(columns: &[&str]) -> Vec<String> {
    NAMES.iter().chain(columns).map(|column| (*column).to_owned()).collect()
}

/// The table of places: header, then one row per method and place. Sums over frames within the planning radius;
/// rates are empty where nothing was counted.
pub(crate) fn place_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![header(&PLACE_COLUMNS)];
    for (method, tally) in result.safety() {
        let places = tally.places.list(tally.cell_size_m);
        rows.extend(places.iter().map(|place| named(info, method, place_cells(place))));
    }
    rows
}

fn named(info: &RunInfo, method: &str, cells: Vec<String>) -> Vec<String> {
    [info.dataset.clone(), method.to_owned()].into_iter().chain(cells).collect()
}

/// The cells of [`PLACE_COLUMNS`]; rates are empty where nothing was counted.
pub fn place_cells(place: &PlaceCounts) -> Vec<String> {
    let counts = &place.counts;
    let mut row = vec![place.place.to_owned()];
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

/// The table of hazards and safe areas: header, then one row per method and area.
pub(crate) fn hazard_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![header(&HAZARD_COLUMNS)];
    for (method, tally) in result.safety() {
        rows.extend(tally.areas.iter().map(|area| named(info, method, hazard_cells(area))));
    }
    rows
}

/// The cells of [`HAZARD_COLUMNS`]; empty where the area was never within the planning radius, or never right.
pub fn hazard_cells(tally: &AreaTally) -> Vec<String> {
    let area = &tally.area;
    let distance = |view: &Option<AreaView>| view.map_or(String::new(), |v| format!("{:.3}", v.distance_m));
    let at_nearest = tally.nearest.map(|view| view.counts).unwrap_or_default();
    let mut row = vec![area.name.clone(), area.kind.clone()];
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
    let share = |value: f64| format!("{:.0} %", 100.0 * value);
    let mut text = share(tally.recall(&nearest.counts));
    let wrong = tally.wrong(&nearest.counts);
    if wrong >= 0.005 {
        text += &format!(", {} wrong", share(wrong));
    }
    if let Some(half) = tally.half {
        text += &format!(", from {:.1} m", half.distance_m);
    }
    text
}
