use std::fmt::Write as _;

use super::outcome::Outcome;
use super::plan::Sweep;
use super::point::text;

/// Points of one method that differ in one key.
pub(super) struct Line<'a> {
    /// Method, and the values of the other keys.
    pub name: String,
    /// In the order of the key's values.
    pub outcomes: Vec<&'a Outcome<'a>>,
}

impl Line<'_> {
    /// Mistakes and hits of the points that were scored.
    pub fn scored(&self) -> Vec<(f64, f64)> {
        self.outcomes.iter().filter_map(|o| Some((o.number("mistakes")?, o.number("hits")?))).collect()
    }
}

/// The lines of one recording: along the key with the most values, one for each method and combination of the
/// others.
pub(super) fn lines<'a>(sweep: &Sweep, outcomes: &[&'a Outcome<'a>]) -> Vec<Line<'a>> {
    let axes = &sweep.plan.axes;
    let along = (0..axes.len()).rev().max_by_key(|&i| axes[i].values.len());
    let mut lines: Vec<Line<'a>> = Vec::new();
    for outcome in outcomes {
        let mut name = outcome.point.method().to_owned();
        for (i, (axis, value)) in axes.iter().zip(&outcome.point.values).enumerate() {
            if let (true, Some(value)) = (Some(i) != along, value) {
                let key = axis.key.rsplit('.').next().unwrap_or(&axis.key);
                let _ = write!(name, ", {key} {}", text(value));
            }
        }
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.outcomes.push(outcome),
            None => lines.push(Line { name, outcomes: vec![outcome] }),
        }
    }
    lines
}
