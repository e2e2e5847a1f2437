//! Tolerances that the user gives.

use std::str::FromStr;

use anyhow::{Result, bail};
use evigrid_core::name_hint;
use evigrid_metrics::{Better, Kind, METRICS, Metric, Tolerance, family, metric_of};

/// A tolerance in place of a default one: `0.005` (all rates), `2%` (all counts), `METRIC=0.005`, `METRIC=2%`
/// or `METRIC=off`. A named metric is judged, one that is off is not.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceRule {
    metric: Option<String>,
    limit: Limit,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Limit {
    Amount(f64),
    Share(f64),
    Off,
}

impl FromStr for ToleranceRule {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((name, limit)) = text.split_once('=') else {
            return match parse_limit(text)? {
                Limit::Off => bail!("expected METRIC=off, found no metric"),
                limit => Ok(Self { metric: None, limit }),
            };
        };
        let name = name.trim();
        match metric_of(name) {
            Some(Metric { better: Better::Neither, .. }) => {
                bail!("expected a metric that can be better or worse, found `{name}`")
            }
            Some(_) => Ok(Self { metric: Some(name.to_owned()), limit: parse_limit(limit)? }),
            None => bail!("unknown metric `{name}`{}", name_hint(name, METRICS.iter().map(|m| m.name))),
        }
    }
}

fn parse_limit(text: &str) -> Result<Limit> {
    let text = text.trim();
    if text == "off" {
        return Ok(Limit::Off);
    }
    match text.strip_suffix('%') {
        Some(percent) => Ok(Limit::Share(not_negative(percent, text)? / 100.0)),
        None => Ok(Limit::Amount(not_negative(text, text)?)),
    }
}

fn not_negative(number: &str, text: &str) -> Result<f64> {
    match number.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => bail!("expected a number or a percentage, at least 0, found `{text}`"),
    }
}

/// A percentage, with or without its sign, as a share: `20%` is 0.2.
///
/// # Errors
/// If it is no number or negative.
pub fn parse_percent(text: &str) -> Result<f64> {
    Ok(not_negative(text.trim().trim_end_matches('%'), text)? / 100.0)
}

/// Options of a comparison.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompareOptions {
    /// Tolerances in place of the defaults; those with a name win over those without, later ones over earlier
    /// ones.
    pub rules: Vec<ToleranceRule>,
    /// Judge time and memory too, with this share of the baseline's value as tolerance.
    pub timing: Option<f64>,
}

impl CompareOptions {
    /// The metric of a column as this comparison judges it.
    pub(super) fn apply(&self, column: &str, metric: &Metric) -> Metric {
        let mut metric = *metric;
        if let (Kind::Cost, Some(share)) = (metric.kind, self.timing) {
            metric.tolerance.share = share;
            metric.judged = true;
        }
        let general = self.rules.iter().filter(|r| r.metric.is_none());
        for rule in general.chain(self.rules.iter().filter(|r| r.names(column))) {
            rule.apply(&mut metric);
        }
        metric
    }

    /// Whether a verdict on time or memory is asked for.
    pub(super) fn judges_costs(&self) -> bool {
        let named = |m: &Metric| m.kind == Kind::Cost && self.apply(m.name, m).judged;
        METRICS.iter().any(named)
    }

    /// Nothing, if every rule's metric is among the compared columns.
    ///
    /// # Errors
    /// If one is not.
    pub(super) fn check_names(&self, columns: &[&str]) -> Result<()> {
        for rule in &self.rules {
            if let Some(name) = &rule.metric
                && !columns.iter().any(|c| rule.names(c))
            {
                bail!("--tolerance {name}: expected a metric of both runs{}", name_hint(name, columns));
            }
        }
        Ok(())
    }
}

impl ToleranceRule {
    fn names(&self, column: &str) -> bool {
        self.metric.as_ref().is_some_and(|name| name == column || name == family(column))
    }

    fn apply(&self, metric: &mut Metric) {
        let named = self.metric.is_some();
        match self.limit {
            Limit::Off => metric.judged = false,
            Limit::Amount(amount) if named || metric.kind == Kind::Rate => {
                metric.tolerance = Tolerance { amount, share: 0.0 };
                metric.judged |= named;
            }
            Limit::Share(share) if named || metric.kind == Kind::Count => {
                metric.tolerance = Tolerance { amount: 0.0, share };
                metric.judged |= named;
            }
            Limit::Amount(_) | Limit::Share(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Limit at a baseline's value of 100, and whether the column is judged.
    fn judged(rules: &[&str], column: &str) -> (f64, bool) {
        let rules = rules.iter().map(|r| r.parse().unwrap()).collect();
        let options = CompareOptions { rules, timing: None };
        let metric = options.apply(column, metric_of(column).unwrap());
        (metric.tolerance.limit(100.0), metric.judged)
    }

    #[test]
    fn rules_replace_the_defaults() {
        assert_eq!(judged(&[], "f1"), (0.002, true));
        assert_eq!(judged(&["0.01"], "f1"), (0.01, true));
        assert_eq!(judged(&["5%"], "f1"), (0.002, true), "a bare percentage is for counts");
        assert_eq!(judged(&["5%"], "mistakes_observed"), (5.0, true));
        assert_eq!(judged(&["5%"], "hits"), (5.0, false));
        assert_eq!(judged(&["hits=5%"], "hits"), (5.0, true), "what is named is judged");
        assert_eq!(judged(&["f1=0.1", "0.01"], "f1"), (0.1, true), "a name wins");
        assert_eq!(judged(&["f_score=0.1", "f_score_0.2m=0.3"], "f_score_0.2m"), (0.3, true));
        assert_eq!(judged(&["f_score=0.1", "f_score_0.2m=0.3"], "f_score_0.4m"), (0.1, true));
        assert_eq!(judged(&["f1=off"], "f1"), (0.002, false));
        assert_eq!(judged(&["0.01"], "match_ms"), (20.0, false));
        assert_eq!(judged(&["match_ms=3"], "match_ms"), (3.0, true));
    }

    #[test]
    fn wrong_rules_are_refused() {
        for (text, part) in [
            ("recal=0.1", "did you mean `recall`?"),
            ("touched=1", "better or worse"),
            ("f1=-1", "at least 0"),
            ("f1=NaN", "found `NaN`"),
            ("inf", "found `inf`"),
            ("f1=", "found ``"),
            ("1%%", "found `1%%`"),
            ("off", "METRIC=off"),
            ("", "found ``"),
        ] {
            let message = text.parse::<ToleranceRule>().unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
        assert_eq!(parse_percent("30%").unwrap(), parse_percent("30").unwrap());
        assert!(parse_percent("-1").is_err());
    }
}
