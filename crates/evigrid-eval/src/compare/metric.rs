//! Every score that two runs are compared by: which way is better, and from what change on it counts.

/// Which way a metric gets better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Better {
    Higher,
    Lower,
    /// Neither is better.
    Neither,
}

/// How a metric is written, and which tolerance without a name is meant for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// 0..1.
    Rate,
    /// Whole cells.
    Count,
    /// Milliseconds per frame or MiB: differs between machines and from run to run.
    Cost,
}

/// The largest change that counts as none: the larger of an amount, in the metric's unit, and a share of the
/// baseline's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tolerance {
    pub(super) amount: f64,
    pub(super) share: f64,
}

impl Tolerance {
    /// The largest change from `base` that counts as none.
    pub(super) fn limit(self, base: f64) -> f64 {
        self.amount.max(self.share * base.abs())
    }
}

/// What is known of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Metric {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) better: Better,
    pub(super) tolerance: Tolerance,
    /// Whether a change beyond the tolerance is a verdict, unless the user says otherwise.
    pub(super) judged: bool,
}

impl Metric {
    /// Runs repeat to the last digit, so the tolerance is not for noise: 0.002 is what is too little to care about.
    const fn rate(name: &'static str) -> Self {
        let tolerance = Tolerance { amount: 0.002, share: 0.0 };
        Self { name, kind: Kind::Rate, better: Better::Higher, tolerance, judged: true }
    }

    const fn count(name: &'static str, better: Better, judged: bool) -> Self {
        let tolerance = Tolerance { amount: 0.0, share: 0.01 };
        Self { name, kind: Kind::Count, better, tolerance, judged }
    }

    /// `least` is what a clock or an allocator is off by on its own.
    const fn cost(name: &'static str, least: f64) -> Self {
        let tolerance = Tolerance { amount: least, share: 0.2 };
        Self { name, kind: Kind::Cost, better: Better::Lower, tolerance, judged: false }
    }
}

/// The metrics of summary.csv, then those of timing.csv. Counts say again what the rates say, so only the mistakes
/// that the laser can refute are judged.
pub(super) const METRICS: [Metric; 22] = [
    Metric::count("hits", Better::Higher, false),
    Metric::count("mistakes", Better::Lower, false),
    Metric::count("mistakes_observed", Better::Lower, true),
    Metric::count("missed", Better::Lower, false),
    Metric::rate("precision"),
    Metric::rate("recall"),
    Metric::rate("f1"),
    Metric::count("missed_unknown", Better::Lower, false),
    Metric::count("touched", Better::Neither, false),
    Metric::rate("precision_observed"),
    Metric::rate("f1_observed"),
    Metric::rate("accuracy"),
    Metric::rate("completeness"),
    Metric::rate("f_score"),
    Metric::rate("curve_area"),
    Metric::rate("average_precision"),
    Metric::cost("read_ms", 0.5),
    Metric::cost("match_ms", 0.5),
    Metric::cost("integrate_ms", 0.5),
    Metric::cost("truth_ms", 0.5),
    Metric::cost("score_ms", 0.5),
    Metric::cost("peak_memory_mib", 4.0),
];

/// Columns of summary.csv that are no metrics: they name a row, or say what the maps are measured against.
pub(super) const OTHER_COLUMNS: [&str; 6] =
    ["dataset", "method", "frames", "true_cells", "observed_cells", "frames_without_laser"];

/// The metric of a column. Scores within a tolerance (`f_score_0.2m`) go by the name without the distance.
pub(super) fn metric_of(column: &str) -> Option<Metric> {
    let name = family(column);
    METRICS.into_iter().find(|m| m.name == name)
}

/// The column's name without a distance at its end.
pub(super) fn family(column: &str) -> &str {
    let is_distance = |end: &str| end.strip_suffix('m').is_some_and(|metres| metres.parse::<f64>().is_ok());
    match column.rsplit_once('_') {
        Some((name, end)) if is_distance(end) => name,
        _ => column,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::tables::summary_header;
    use crate::{Config, RunInfo};
    use evigrid_grid::GridSpec;

    #[test]
    fn every_column_of_the_summary_is_known() {
        let config = Config::default();
        let spec = GridSpec::new(&config.grid).unwrap();
        let (dataset, layout) = ("d".to_owned(), "l".to_owned());
        let info = RunInfo { dataset, layout, frames: vec![0], methods: Vec::new(), spec, config };
        for column in summary_header(&info) {
            let known = metric_of(&column).is_some() || OTHER_COLUMNS.contains(&&column[..]);
            assert!(known, "add `{column}` to METRICS or OTHER_COLUMNS, and to docs/metrics.md");
        }
    }

    #[test]
    fn the_documented_tolerances_are_these() {
        let page = include_str!("../../../../docs/metrics.md");
        let (_, section) = page.split_once("## Comparing two runs").unwrap();
        for metric in METRICS {
            let row =
                section.lines().find(|l| l.starts_with('|') && l.contains(&format!("`{}`", metric.name)));
            let cells: Vec<_> =
                row.unwrap_or_else(|| panic!("no row for {}", metric.name)).split('|').collect();
            let better = match metric.better {
                Better::Higher => "higher",
                Better::Lower => "lower",
                Better::Neither => "–",
            };
            assert_eq!(cells[2].trim(), better, "{}", metric.name);
            let Tolerance { amount, share } = metric.tolerance;
            let numbers: Vec<_> = [(amount, String::new()), (share * 100.0, " %".to_owned())]
                .into_iter()
                .filter(|(value, _)| *value > 0.0)
                .map(|(value, unit)| format!("{value}{unit}"))
                .collect();
            for number in numbers {
                assert!(cells[3].contains(&number), "{}: {number} is not in {}", metric.name, cells[3]);
            }
            let judged = match (metric.kind, metric.judged) {
                (_, true) => "yes",
                (Kind::Cost, false) => "with `--timing`",
                _ => "no",
            };
            assert_eq!(cells[4].trim(), judged, "{}", metric.name);
        }
    }

    #[test]
    fn a_distance_does_not_change_the_metric() {
        assert_eq!(family("f_score_0.2m"), "f_score");
        assert_eq!(family("f_score"), "f_score");
        assert_eq!(family("curve_area"), "curve_area");
        assert!(metric_of("f_score_farm").is_none());
    }
}
