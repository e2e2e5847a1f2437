use evigrid_grid::{LayerKind, PlanGrid};

use crate::{
    Curve, Kind, METRICS, Metric, Of, PlanCase, PlanReference, PlanTally, SafetyCase, Show, VoxelCase,
    VoxelReference, curve, within_tolerance,
};

/// The value of one metric.
#[derive(Debug, Clone, Copy)]
pub struct Score {
    /// Its row in the table.
    pub metric: &'static Metric,
    /// Distance of a tolerant score, metres.
    pub within_m: Option<f64>,
    /// The value; NaN for a rate that is undefined (0 / 0).
    pub value: f64,
}

impl Score {
    /// Name of its column.
    pub fn column(&self) -> String {
        column(self.metric, self.within_m)
    }

    /// The value as a cell of a table: rates with six digits and empty if undefined, counts whole.
    pub fn cell(&self) -> String {
        match self.metric.kind {
            _ if self.value.is_nan() => String::new(),
            Kind::Rate => format!("{:.6}", self.value),
            Kind::Count | Kind::Reference => format!("{:.0}", self.value),
            Kind::Cost => format!("{:.3}", self.value),
        }
    }

    /// Heading of its column where people read it; `None` if it is not shown there.
    pub fn heading(&self) -> Option<String> {
        let within = self.within_m.map_or(String::new(), |t| t.to_string());
        Some(self.metric.heading()?.replace("{}", &within))
    }

    /// The value where people read it: rates with three digits, counts whole.
    pub fn shown(&self) -> String {
        self.metric.shown(self.value)
    }

    fn is_in(&self, name: &str) -> bool {
        match self.within_m {
            None => name == self.metric.name,
            Some(_) => name.starts_with(self.metric.name) && name == self.column(),
        }
    }
}

/// All scores of one layer at one moment, in the order of the columns.
#[derive(Debug, Clone)]
pub struct Scores {
    /// The kind of the layer.
    pub kind: LayerKind,
    /// One entry per column.
    pub list: Vec<Score>,
    /// Hits against mistakes over the threshold, for voxels at the end of a run.
    pub curve: Option<Curve>,
}

impl Scores {
    /// Scores voxels after a frame, given as log-odds by flat index (NaN = never touched).
    pub fn voxels(log_odds: &[f32], reference: &VoxelReference<'_>, tolerances_m: &[f64]) -> Self {
        Self::of_voxels(&VoxelCase::new(log_odds, reference), tolerances_m)
    }

    /// Scores voxels at the end of a run: those of [`Self::voxels`], the curve, and the scores that need it.
    pub fn voxels_at_end(log_odds: &[f32], reference: &VoxelReference<'_>, tolerances_m: &[f64]) -> Self {
        let case = VoxelCase::new(log_odds, reference);
        let mut scored = Self::of_voxels(&case, tolerances_m);
        let curve = curve(log_odds, reference);
        scored.list.extend(scores(None, |of| match of {
            Of::VoxelsAtEnd(f) => Some(f(&case, &curve)),
            _ => None,
        }));
        Self { curve: Some(curve), ..scored }
    }

    fn of_voxels(case: &VoxelCase<'_>, tolerances_m: &[f64]) -> Self {
        let mut list = scores(None, |of| match of {
            Of::Voxels(f) => Some(f(case)),
            _ => None,
        });
        for &tolerance_m in tolerances_m {
            let tolerant = within_tolerance(case.log_odds, case.reference, tolerance_m);
            list.extend(scores(Some(tolerance_m), |of| match of {
                Of::VoxelsWithin(f) => Some(f(&tolerant)),
                _ => None,
            }));
        }
        Self { kind: LayerKind::Voxels, list, curve: None }
    }

    /// Scores a ground plan. Its cells are looked up in the reference by their centres in the map frame, so
    /// it may move; only cells that the reference knows are scored.
    pub fn plan(plan: &PlanGrid, reference: &PlanReference) -> Self {
        let case = PlanCase::new(plan, reference);
        Self::of_case(LayerKind::Plan, |of| match of {
            Of::Plan(f) => Some(f(&case)),
            _ => None,
        })
    }

    /// Adds what was counted frame by frame to the scores of a plan.
    pub fn add_frames(&mut self, tally: &PlanTally) {
        self.list.extend(scores(None, |of| match of {
            Of::PlanFrames(f) => Some(f(tally)),
            _ => None,
        }));
    }

    /// Scores of a safety map that was counted against the true one, after a frame or over all of them.
    pub fn safety(case: &SafetyCase) -> Self {
        Self::of_case(LayerKind::Safety, |of| match of {
            Of::Safety(f) => Some(f(case)),
            _ => None,
        })
    }

    /// The scores of the metrics that have a value.
    fn of_case(kind: LayerKind, value: impl Fn(&Of) -> Option<f64>) -> Self {
        Self { kind, list: scores(None, value), curve: None }
    }

    /// The score in a column.
    pub fn score(&self, column: &str) -> Option<&Score> {
        self.list.iter().find(|score| score.is_in(column))
    }

    /// The value in a column: NaN for a rate that is undefined, `None` if there is no such column.
    pub fn get(&self, column: &str) -> Option<f64> {
        self.score(column).map(|score| score.value)
    }

    /// The score that stands for the whole layer.
    pub fn main(&self) -> Option<&Score> {
        self.list.iter().find(|score| matches!(score.metric.show, Show::Main(_)))
    }

    /// The columns of a kind of layer, after a frame or at the end of a run.
    pub fn columns(kind: LayerKind, tolerances_m: &[f64], at_end: bool) -> Vec<String> {
        let names = |within_m: Option<f64>, holds: fn(&Of) -> bool| {
            METRICS.iter().filter(move |m| holds(&m.of)).map(move |m| column(m, within_m))
        };
        match kind {
            LayerKind::Plan => names(None, |of| matches!(of, Of::Plan(_)))
                .chain(names(None, |of| matches!(of, Of::PlanFrames(_))).filter(|_| at_end))
                .collect(),
            LayerKind::Safety => names(None, |of| matches!(of, Of::Safety(_))).collect(),
            LayerKind::Voxels => {
                let within = |&t: &f64| names(Some(t), |of| matches!(of, Of::VoxelsWithin(_)));
                names(None, |of| matches!(of, Of::Voxels(_)))
                    .chain(tolerances_m.iter().flat_map(within))
                    .chain(names(None, |of| matches!(of, Of::VoxelsAtEnd(_))).filter(|_| at_end))
                    .collect()
            }
        }
    }
}

/// The scores of all metrics for which `value` gives a number.
fn scores(within_m: Option<f64>, value: impl Fn(&Of) -> Option<f64>) -> Vec<Score> {
    let score = |metric: &'static Metric| Some(Score { metric, within_m, value: value(&metric.of)? });
    METRICS.iter().filter_map(score).collect()
}

fn column(metric: &Metric, within_m: Option<f64>) -> String {
    match within_m {
        Some(within_m) => format!("{}_{within_m}m", metric.name),
        None => metric.name.to_owned(),
    }
}
