//! Ground plans counted frame by frame, as tables.

use evigrid_metrics::PlanBandCounts;

use crate::{RunInfo, RunResult};

/// Columns of a band of distances, after those that name the map.
const BAND_COLUMNS: [&str; 11] = [
    "from_m",
    "to_m",
    "cells",
    "occupied_cells",
    "auc",
    "auc_off_borders",
    "average_precision",
    "best_f1",
    "best_threshold",
    "log_loss",
    "brier",
];
/// Columns of a bin of the reliability diagram.
const RELIABILITY_COLUMNS: [&str; 5] = ["p_from", "p_to", "cells", "p_mean", "occupied"];
/// Columns of a point of the receiver operating characteristic.
const ROC_COLUMNS: [&str; 4] = ["threshold", "false_positive_rate", "recall", "precision"];

fn header(columns: &[&str]) -> Vec<String> {
    ["dataset", "method"].iter().chain(columns).map(|column| (*column).to_owned()).collect()
}

/// One row per method and band of distances, and one for all of them.
pub(crate) fn band_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![header(&BAND_COLUMNS)];
    for (method, tally) in result.plans() {
        let ends = |[from, to]: [f64; 2]| [format!("{from:.0}"), format!("{to:.0}")];
        rows.extend(tally.bands().map(|(range, band)| named(info, method, ends(range), &band_cells(band))));
        let last = tally.bands().last().map_or(0.0, |(range, _)| range[1]);
        rows.push(named(info, method, ends([0.0, last]), &band_cells(&tally.all())));
    }
    rows
}

/// The cells of [`BAND_COLUMNS`] from the third on; empty where a rate is undefined.
fn band_cells(band: &PlanBandCounts) -> Vec<String> {
    let [f1, threshold] = band.best_f1();
    let counts = [band.cells(), band.occupied_cells()].map(|n| n.to_string());
    let rates = [
        band.auc(),
        band.auc_off_borders(),
        band.average_precision(),
        f1,
        threshold,
        band.log_loss(),
        band.brier(),
    ];
    counts.into_iter().chain(rates.map(rate)).collect()
}

/// One row per method and tenth of probability.
pub(crate) fn reliability_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![header(&RELIABILITY_COLUMNS)];
    for (method, tally) in result.plans() {
        rows.extend(tally.all().reliability().into_iter().map(|bin| {
            let ends = bin.range.map(|p| format!("{p:.1}"));
            named(info, method, ends, &[bin.cells.to_string(), rate(bin.mean), rate(bin.occupied)])
        }));
    }
    rows
}

/// One row per method and hundredth of probability.
pub(crate) fn roc_rows(info: &RunInfo, result: &RunResult) -> Vec<Vec<String>> {
    let mut rows = vec![header(&ROC_COLUMNS)];
    for (method, tally) in result.plans() {
        rows.extend(tally.all().roc().into_iter().map(|point| {
            let first = [format!("{:.2}", point.threshold), rate(point.false_positive_rate)];
            named(info, method, first, &[rate(point.recall), rate(point.precision)])
        }));
    }
    rows
}

fn named(info: &RunInfo, method: &str, first: [String; 2], rest: &[String]) -> Vec<String> {
    let names = [info.dataset.clone(), method.to_owned()];
    names.into_iter().chain(first).chain(rest.iter().cloned()).collect()
}

fn rate(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.6}") }
}
