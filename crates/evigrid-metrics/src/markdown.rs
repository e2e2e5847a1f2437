//! The table of metrics as text, for docs/metrics.md and `evigrid metrics`.

use std::fmt::Write as _;

use evigrid_grid::LayerKind;

use crate::{Better, Kind, METRICS, Metric, Of};

/// All metrics as Markdown: per kind of layer the columns with formula and unit, then how two runs are
/// compared.
pub fn metrics_markdown() -> String {
    let mut text = String::new();
    for (heading, layer) in [
        ("Voxels", Some(LayerKind::Voxels)),
        ("Ground plan", Some(LayerKind::Plan)),
        ("Safety", Some(LayerKind::Safety)),
        ("Time and memory", None),
    ] {
        let _ = writeln!(text, "### {heading}\n\n| column | formula | unit |\n| --- | --- | --- |");
        for metric in METRICS.iter().filter(|m| m.of.layer() == layer) {
            let _ = writeln!(text, "| `{}` | {} | {} |", column(metric), metric.formula, metric.unit);
        }
        text.push('\n');
    }
    text.push_str(
        "### Better or worse\n\n| metric | better | tolerance | judged |\n| --- | --- | --- | --- |\n",
    );
    for (judgement, names) in judgements() {
        let _ = writeln!(text, "| {} | {judgement} |", names.join(", "));
    }
    text
}

fn column(metric: &Metric) -> String {
    let distance = if matches!(metric.of, Of::VoxelsWithin(_)) { "_Tm" } else { "" };
    format!("{}{distance}", metric.name)
}

/// Metrics that are judged alike stand in one row.
fn judgements() -> Vec<(String, Vec<String>)> {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for metric in METRICS {
        let (judgement, name) = (judgement(metric), format!("`{}`", metric.name));
        match rows.iter_mut().find(|(known, _)| *known == judgement) {
            Some((_, names)) => names.push(name),
            None => rows.push((judgement, vec![name])),
        }
    }
    rows
}

fn judgement(metric: &Metric) -> String {
    let better = match metric.better {
        Better::Higher => "higher",
        Better::Lower => "lower",
        Better::Neither => "–",
    };
    let judged = match (metric.kind, metric.judged) {
        (Kind::Reference, _) => "a condition",
        (Kind::Cost, false) => "with `--timing`",
        (_, true) => "yes",
        (_, false) => "no",
    };
    format!("{better} | {} | {judged}", tolerance(metric))
}

fn tolerance(metric: &Metric) -> String {
    let (amount, percent) = (metric.tolerance.amount, 100.0 * metric.tolerance.share);
    match (amount > 0.0, percent > 0.0) {
        (true, true) => format!("{percent} %, at least {amount} {}", metric.unit),
        (false, true) => format!("{percent} %"),
        _ => amount.to_string(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_documented_table_is_this_one() {
        let page = include_str!("../../../docs/metrics.md");
        let (_, rest) = page.split_once("<!-- metrics: begin -->").unwrap();
        let (table, _) = rest.split_once("<!-- metrics: end -->").unwrap();
        let table = table.trim();
        assert!(table == metrics_markdown().trim(), "docs/metrics.md should say:\n{}", metrics_markdown());
    }
}
