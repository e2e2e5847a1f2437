use std::fmt::Write as _;

use evigrid_grid::LayerKind;
use evigrid_metrics::{Better, Metric, main_metric};

use super::outcome::Outcome;
use super::plan::Sweep;
use super::point::text;
use super::report::{keys, kinds, metrics_of, of_recording};

/// Rows of a table in sweep.md; the table of all is points.csv.
const MARKDOWN_ROWS: usize = 40;

/// The sweep as a page that a person reads.
pub(super) fn page(sweep: &Sweep, outcomes: &[Outcome<'_>]) -> String {
    let mut page = format!("# Sweep {}\n\n{} points.\n", sweep.name(), outcomes.len());
    for axis in &sweep.plan.axes {
        let (first, last) = (&axis.values[0], &axis.values[axis.values.len() - 1]);
        let (first, last) = (text(first), text(last));
        let _ = write!(page, "\n- `{}`: {} values, {first} to {last}", axis.key, axis.values.len());
    }
    page.push('\n');
    for recording in &sweep.recordings {
        let here = of_recording(outcomes, recording.id());
        let _ = writeln!(page, "\n## {}\n", recording.id());
        let scored: Vec<LayerKind> = kinds(&here).filter(|kind| best(&here, *kind).is_some()).collect();
        if scored.is_empty() {
            page.push_str("There is no truth for these maps: they are not scored.\n");
        }
        for (number, kind) in scored.into_iter().enumerate() {
            if number > 0 {
                page.push('\n');
            }
            table(&mut page, sweep, &here, kind);
        }
    }
    page
}

/// The main metric of a kind of layer with the point that is best in it, and its value there; of equal points
/// the first.
fn best<'a>(
    outcomes: &[&'a Outcome<'a>],
    kind: LayerKind,
) -> Option<(&'static Metric, &'a Outcome<'a>, f64)> {
    let metric = main_metric(kind)?;
    let mut best = None;
    for &outcome in outcomes {
        let Some(value) = outcome.number(metric.name) else { continue };
        let is_better = match (best, metric.better) {
            (None, _) => true,
            (Some((_, _, so_far)), Better::Lower) => value < so_far,
            (Some((_, _, so_far)), _) => value > so_far,
        };
        if is_better {
            best = Some((metric, outcome, value));
        }
    }
    best
}

/// The points with a kind of layer: the best one, then one row for each.
fn table(page: &mut String, sweep: &Sweep, outcomes: &[&Outcome<'_>], kind: LayerKind) {
    let Some((metric, point, value)) = best(outcomes, kind) else { return };
    let extreme = if metric.better == Better::Lower { "Lowest" } else { "Highest" };
    let (heading, label) = (heading(metric), point.point.label(&sweep.plan.axes));
    let _ = writeln!(page, "{extreme} {heading}: {label} ({}).\n", metric.shown(value));
    let shown: Vec<&Metric> = metrics_of(kind).collect();
    let mut header = vec!["method".to_owned()];
    header.extend(keys(sweep));
    header.extend(shown.iter().map(|metric| self::heading(metric).to_owned()));
    let _ = writeln!(page, "| {} |\n|{}", header.join(" | "), " --- |".repeat(header.len()));
    let points: Vec<_> = outcomes.iter().filter(|outcome| outcome.layers().contains(&kind)).collect();
    for outcome in points.iter().take(MARKDOWN_ROWS) {
        let mut cells = vec![outcome.point.method().to_owned()];
        cells.extend(outcome.values());
        let cell = |metric: &&Metric| outcome.number(metric.name).map_or(String::new(), |v| metric.shown(v));
        cells.extend(shown.iter().map(cell));
        let _ = writeln!(page, "| {} |", cells.join(" | "));
    }
    if points.len() > MARKDOWN_ROWS {
        let _ = writeln!(page, "\n{} more are in points.csv.", points.len() - MARKDOWN_ROWS);
    }
}

fn heading(metric: &Metric) -> &'static str {
    metric.heading().unwrap_or(metric.name)
}
