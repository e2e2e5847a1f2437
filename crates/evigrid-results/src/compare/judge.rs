//! Whether a value got better or worse.

use evigrid_metrics::{Better, Kind, Metric};

/// Judgement of a change, in the order in which changes are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Verdict {
    Worse,
    Better,
    /// Changed, but nobody asked for a verdict.
    NotJudged,
    Unchanged,
}

/// One metric of one method in both runs.
#[derive(Debug)]
pub(super) struct Row {
    /// Empty for what all methods share.
    pub(super) method: String,
    /// The column.
    pub(super) metric: String,
    pub(super) kind: Kind,
    /// `None` for a rate that is undefined (0 / 0).
    pub(super) base: Option<f64>,
    pub(super) new: Option<f64>,
    pub(super) verdict: Verdict,
    /// The change as a multiple of the tolerance.
    pub(super) excess: f64,
}

/// Far below the last digit of a table, far above what subtraction rounds off.
const ROUNDING: f64 = 1e-9;

/// Compares a metric. A rate that became undefined got worse, one that became defined got better.
pub(super) fn judge(metric: &Metric, method: &str, column: &str, base: Option<f64>, new: Option<f64>) -> Row {
    let (change, limit) = match (base, new) {
        (Some(base), Some(new)) => (new - base, metric.tolerance.limit(base) + ROUNDING),
        (Some(_), None) => (lost(metric.better), 0.0),
        (None, Some(_)) => (-lost(metric.better), 0.0),
        (None, None) => (0.0, ROUNDING),
    };
    let verdict = match metric.better {
        _ if change.abs() <= limit => Verdict::Unchanged,
        _ if !metric.judged => Verdict::NotJudged,
        Better::Neither => Verdict::NotJudged,
        Better::Higher if change > 0.0 => Verdict::Better,
        Better::Lower if change < 0.0 => Verdict::Better,
        Better::Higher | Better::Lower => Verdict::Worse,
    };
    let (method, metric_name) = (method.to_owned(), column.to_owned());
    Row { method, metric: metric_name, kind: metric.kind, base, new, verdict, excess: change.abs() / limit }
}

/// The change that a value that is gone counts as: an infinite step to the worse.
fn lost(better: Better) -> f64 {
    if better == Better::Lower { f64::INFINITY } else { f64::NEG_INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_metrics::metric_of;

    fn verdict(column: &str, base: Option<f64>, new: Option<f64>) -> Verdict {
        judge(metric_of(column).unwrap(), "m", column, base, new).verdict
    }

    #[test]
    fn direction_and_tolerance() {
        for (column, base, new, expected) in [
            ("f1", 0.5, 0.502, Verdict::Unchanged),
            ("f1", 0.5, 0.498, Verdict::Unchanged),
            ("f1", 0.5, 0.502001, Verdict::Better),
            ("f1", 0.5, 0.497999, Verdict::Worse),
            ("f_score_0.2m", 0.5, 0.4, Verdict::Worse),
            ("mistakes_observed", 1000.0, 1010.0, Verdict::Unchanged),
            ("mistakes_observed", 1000.0, 1011.0, Verdict::Worse),
            ("mistakes_observed", 1000.0, 989.0, Verdict::Better),
            ("mistakes_observed", 0.0, 1.0, Verdict::Worse),
            ("mistakes_observed", 0.0, 0.0, Verdict::Unchanged),
            ("safety_fn_rate", 0.1, 0.2, Verdict::Worse),
            ("plan_auc", 0.8, 0.9, Verdict::Better),
            ("hits", 1000.0, 900.0, Verdict::NotJudged),
            ("touched", 1000.0, 900.0, Verdict::NotJudged),
            ("match_ms", 10.0, 100.0, Verdict::NotJudged),
            ("match_ms", 0.1, 0.5, Verdict::Unchanged),
        ] {
            assert_eq!(verdict(column, Some(base), Some(new)), expected, "{column} {base} {new}");
        }
    }

    #[test]
    fn undefined_rates() {
        assert_eq!(verdict("precision", None, None), Verdict::Unchanged);
        assert_eq!(verdict("precision", Some(0.1), None), Verdict::Worse);
        assert_eq!(verdict("precision", None, Some(0.1)), Verdict::Better);
        assert_eq!(verdict("mistakes_observed", Some(0.1), None), Verdict::Worse);
    }
}
