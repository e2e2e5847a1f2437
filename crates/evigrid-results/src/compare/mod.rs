//! Compares two runs: what got better, what got worse, by more than a tolerance. Runs that were not made
//! under the same conditions are refused; docs/metrics.md lists the conditions.

mod conditions;
mod judge;
mod report;
mod rule;
mod run_folder;
mod table;
#[cfg(test)]
mod tests;
mod timing;

use std::path::Path;

use anyhow::{Result, bail};
use evigrid_metrics::{Kind, metric_of};
use serde_json::Value;

pub use rule::{CompareOptions, ToleranceRule, parse_percent};

use crate::files;
use conditions::{check_conditions, notes};
use judge::{Row, Verdict, judge};
use run_folder::{RunFolder, SummaryTable};
use timing::Costs;

/// Findings of a comparison of two runs.
#[derive(Debug)]
pub struct Comparison {
    /// Methods of the baseline that the new run lacks.
    missing_methods: Vec<String>,
    /// One entry per method and metric, worst first.
    rows: Vec<Row>,
    /// Facts that a reader should know beside the metrics.
    notes: Vec<String>,
}

impl Comparison {
    /// Whether anything got worse. A method that is gone has.
    pub fn is_worse(&self) -> bool {
        !self.missing_methods.is_empty() || self.rows.iter().any(|r| r.verdict == Verdict::Worse)
    }
}

/// Compares the run in the folder `new` with the run in the folder `base`. `defaults` are the defaults of all
/// settings: a setting that a run of an earlier version did not know has its default.
///
/// # Errors
/// If one of the folders holds no run, or one of another format, or a damaged one; if the runs were made
/// under different conditions; if an option names a metric that they do not have.
pub fn compare(base: &Path, new: &Path, options: &CompareOptions, defaults: &Value) -> Result<Comparison> {
    let (base, new) = (RunFolder::read(base)?, RunFolder::read(new)?);
    check_conditions(&base, &new, defaults)?;
    let (mut rows, mut notes) = (Vec::new(), notes(&base, &new, defaults));
    compare_scores(&base, &new, options, &mut rows, &mut notes)?;
    compare_costs(&base, &new, options, &mut rows, &mut notes)?;
    options.check_names(&rows.iter().map(|r| r.metric.as_str()).collect::<Vec<_>>())?;
    rows.sort_by(|a, b| a.verdict.cmp(&b.verdict).then(b.excess.total_cmp(&a.excess)));
    let lacks = |folder: &RunFolder, name: &&String| !folder.run.methods.contains(name);
    let missing_methods = base.run.methods.iter().filter(|m| lacks(&new, m)).cloned().collect();
    for method in new.run.methods.iter().filter(|m| lacks(&base, m)) {
        notes.push(format!("method {method} is new; there is nothing to compare it with"));
    }
    Ok(Comparison { missing_methods, rows, notes })
}

fn compare_scores(
    base: &RunFolder,
    new: &RunFolder,
    options: &CompareOptions,
    rows: &mut Vec<Row>,
    notes: &mut Vec<String>,
) -> Result<()> {
    for before in &base.tables {
        let Some(after) = new.table(before.kind) else {
            bail!("expected {} as in BASE, found none: {}", files::summary(before.kind), new.dir.display());
        };
        compare_tables(before, after, options, rows, notes)?;
    }
    for table in new.tables.iter().filter(|t| base.table(t.kind).is_none()) {
        let name = files::summary(table.kind);
        notes.push(format!("table {name} is new; there is nothing to compare it with"));
    }
    Ok(())
}

fn compare_tables(
    base: &SummaryTable,
    new: &SummaryTable,
    options: &CompareOptions,
    rows: &mut Vec<Row>,
    notes: &mut Vec<String>,
) -> Result<()> {
    for column in base.score_columns() {
        new.require_column(column)?;
        let Some(metric) = metric_of(column) else {
            notes.push(format!("column {column} is unknown to this version and not compared"));
            continue;
        };
        if metric.kind == Kind::Reference {
            continue;
        }
        let metric = options.apply(column, metric);
        for before in &base.methods {
            let Some(after) = new.method(&before.method) else { continue };
            if before.has_scores() || after.has_scores() {
                let (base, new) = (before.values[column], after.values[column]);
                rows.push(judge(&metric, &before.method, column, base, new));
            }
        }
    }
    for column in new.score_columns().filter(|c| !base.has_column(c)) {
        notes.push(format!("column {column} is new; there is nothing to compare it with"));
    }
    Ok(())
}

fn compare_costs(
    base: &RunFolder,
    new: &RunFolder,
    options: &CompareOptions,
    rows: &mut Vec<Row>,
    notes: &mut Vec<String>,
) -> Result<()> {
    let (before, after) = (Costs::read(&base.dir)?, Costs::read(&new.dir)?);
    let (Some(before), Some(after)) = (&before, &after) else {
        let lacking = if before.is_none() { base } else { new };
        if options.judges_costs() {
            bail!("expected timing.csv in both runs, found none: {}", lacking.dir.display());
        }
        notes.push(format!("no time and memory: {} has no timing.csv", lacking.dir.display()));
        return Ok(());
    };
    for (method, name, value) in &before.0 {
        let (Some(metric), Some(after)) = (metric_of(name), after.get(method, name)) else { continue };
        let metric = options.apply(name, metric);
        rows.push(judge(&metric, method, name, Some(*value), Some(after)));
    }
    Ok(())
}
