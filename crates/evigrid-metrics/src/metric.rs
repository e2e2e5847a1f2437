use evigrid_grid::LayerKind;

use crate::{Curve, METRICS, PlanCase, PlanTally, SafetyCase, Tolerant, VoxelCase};

/// Direction in which a metric gets better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// More is better.
    Higher,
    /// Less is better.
    Lower,
    /// Neither is better.
    Neither,
}

/// Way in which a metric is written, and in which tolerances without a name apply to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A share, 0..1, or a mean.
    Rate,
    /// Whole cells.
    Count,
    /// Whole cells of the reference that maps are measured against. Never judged: two runs must agree on it.
    Reference,
    /// Milliseconds per frame or MiB: differs between machines and from run to run.
    Cost,
}

/// The largest change that counts as none: the larger of an amount, in the metric's unit, and a share of the
/// baseline's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Absolute part, in the metric's unit.
    pub amount: f64,
    /// Relative part, as a share of the baseline's value.
    pub share: f64,
}

impl Tolerance {
    /// The largest change from `base` that counts as none.
    pub fn limit(self, base: f64) -> f64 {
        self.amount.max(self.share * base.abs())
    }
}

/// Place of a metric in what a person reads. In a heading, `{}` stands for the distance of a tolerant score,
/// metres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Show {
    /// In the CSV tables alone.
    No,
    /// In summary.md and on the terminal too, under this heading.
    Table(&'static str),
    /// Also in the page and the curves of a sweep.
    Sweep(&'static str),
    /// Also in the progress line, and sweeps rank by it. Every kind of layer has exactly one.
    Main(&'static str),
}

/// Function that computes a metric, by what it needs to know.
#[derive(Debug, Clone, Copy)]
pub enum Of {
    /// From voxels, after every frame and at the end.
    Voxels(fn(&VoxelCase<'_>) -> f64),
    /// From voxels, for each distance of `score.tolerances_m`.
    VoxelsWithin(fn(&Tolerant) -> f64),
    /// From voxels, at the end of a run only.
    VoxelsAtEnd(fn(&VoxelCase<'_>, &Curve) -> f64),
    /// From a ground plan.
    Plan(fn(&PlanCase<'_>) -> f64),
    /// From the plans of all frames, each against the laser of its frame, at the end of a run.
    PlanFrames(fn(&PlanTally) -> f64),
    /// From a safety map after a frame, and from the sums over all frames at the end of a run.
    Safety(fn(&SafetyCase) -> f64),
    /// Measured by the loop of a run.
    Run,
}

impl Of {
    /// The kind of layer that is scored; `None` for what the loop measures.
    pub fn layer(&self) -> Option<LayerKind> {
        match self {
            Self::Voxels(_) | Self::VoxelsWithin(_) | Self::VoxelsAtEnd(_) => Some(LayerKind::Voxels),
            Self::Plan(_) | Self::PlanFrames(_) => Some(LayerKind::Plan),
            Self::Safety(_) => Some(LayerKind::Safety),
            Self::Run => None,
        }
    }
}

/// One metric: everything that the program knows of it.
#[derive(Debug, Clone, Copy)]
pub struct Metric {
    /// The column in tables; for a tolerant score without the distance.
    pub name: &'static str,
    /// Way in which it is written.
    pub kind: Kind,
    /// Unit, for the documentation.
    pub unit: &'static str,
    /// Direction in which it gets better.
    pub better: Better,
    /// The largest change that counts as none when two runs are compared.
    pub tolerance: Tolerance,
    /// Whether a change beyond the tolerance is a verdict, unless the user says otherwise.
    pub judged: bool,
    /// Definition in words, for the documentation.
    pub formula: &'static str,
    /// Place in what a person reads.
    pub show: Show,
    /// Function that computes it.
    pub of: Of,
}

impl Metric {
    /// Heading of its column where people read it; `None` if it is not shown there.
    pub fn heading(&self) -> Option<&'static str> {
        match self.show {
            Show::No => None,
            Show::Table(heading) | Show::Sweep(heading) | Show::Main(heading) => Some(heading),
        }
    }

    /// Whether sweeps show it.
    pub fn is_in_sweeps(&self) -> bool {
        matches!(self.show, Show::Sweep(_) | Show::Main(_))
    }

    /// A value where people read it: rates with three digits, counts whole, a dash where there is none.
    pub fn shown(&self, value: f64) -> String {
        match self.kind {
            _ if value.is_nan() => "-".into(),
            Kind::Rate => format!("{value:.3}"),
            Kind::Count | Kind::Reference | Kind::Cost => format!("{value:.0}"),
        }
    }
}

/// The metric of a column. Scores within a tolerance (`f_score_0.2m`) go by the name without the distance.
pub fn metric_of(column: &str) -> Option<&'static Metric> {
    let name = family(column);
    METRICS.iter().find(|m| m.name == name)
}

/// The column's name without a distance at its end.
pub fn family(column: &str) -> &str {
    let is_distance = |end: &str| end.strip_suffix('m').is_some_and(|metres| metres.parse::<f64>().is_ok());
    match column.rsplit_once('_') {
        Some((name, end)) if is_distance(end) => name,
        _ => column,
    }
}

/// The metric that stands for a whole layer, in the progress line and in the ranking of sweeps.
pub fn main_metric(kind: LayerKind) -> Option<&'static Metric> {
    METRICS.iter().find(|m| matches!(m.show, Show::Main(_)) && m.of.layer() == Some(kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_does_not_change_the_metric() {
        assert_eq!(family("f_score_0.2m"), "f_score");
        assert_eq!(family("f_score"), "f_score");
        assert_eq!(family("curve_area"), "curve_area");
        assert!(metric_of("f_score_farm").is_none());
        assert_eq!(metric_of("f_score_0.2m").map(|m| m.name), Some("f_score"));
    }

    #[test]
    fn every_kind_of_layer_has_one_main_metric() {
        for kind in LayerKind::ALL {
            let is_main = |m: &&Metric| matches!(m.show, Show::Main(_)) && m.of.layer() == Some(kind);
            assert_eq!(METRICS.iter().filter(is_main).count(), 1, "{kind:?}");
            assert!(main_metric(kind).is_some_and(|m| m.better != Better::Neither));
        }
    }

    #[test]
    fn names_are_told_apart_and_no_reference_is_judged() {
        for (i, metric) in METRICS.iter().enumerate() {
            assert!(METRICS[..i].iter().all(|m| m.name != metric.name), "{} twice", metric.name);
            assert_eq!(family(metric.name), metric.name);
            assert!(!metric.judged || metric.better != Better::Neither, "{}", metric.name);
            assert!(!metric.judged || metric.kind != Kind::Reference, "{}", metric.name);
        }
    }
}
