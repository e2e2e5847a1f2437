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
    let mut findings = Findings { options, rows: Vec::new(), notes: notes(&base, &new, defaults) };
    findings.compare_scores(&base, &new)?;
    findings.compare_costs(&base, &new)?;
    options.check_names(&findings.rows.iter().map(|r| r.metric.as_str()).collect::<Vec<_>>())?;
    findings.rows.sort_by(|a, b| a.verdict.cmp(&b.verdict).then(b.excess.total_cmp(&a.excess)));
    let lacks = |folder: &RunFolder, name: &&String| !folder.run.methods.contains(name);
    let missing_methods = base.run.methods.iter().filter(|m| lacks(&new, m)).cloned().collect();
    for method in new.run.methods.iter().filter(|m| lacks(&base, m)) {
        findings.note_new("method", method);
    }
    Ok(Comparison { missing_methods, rows: findings.rows, notes: findings.notes })
}

/// What is found while two runs are compared.
struct Findings<'a> {
    options: &'a CompareOptions,
    rows: Vec<Row>,
    notes: Vec<String>,
}

impl Findings<'_> {
    fn compare_scores(&mut self, base: &RunFolder, new: &RunFolder) -> Result<()> {
        for before in &base.tables {
            let Some(after) = new.table(before.kind) else {
                let name = files::summary(before.kind);
                bail!("expected {name} as in BASE, found none: {}", new.dir.display());
            };
            self.compare_tables(before, after)?;
        }
        for table in new.tables.iter().filter(|t| base.table(t.kind).is_none()) {
            self.note_new("table", files::summary(table.kind));
        }
        Ok(())
    }

    fn compare_tables(&mut self, base: &SummaryTable, new: &SummaryTable) -> Result<()> {
        for column in base.score_columns() {
            new.require_column(column)?;
            let Some(metric) = metric_of(column) else {
                self.notes.push(format!("column {column} is unknown to this version and not compared"));
                continue;
            };
            if metric.kind == Kind::Reference {
                continue;
            }
            let metric = self.options.apply(column, metric);
            for before in &base.methods {
                let Some(after) = new.method(&before.method) else { continue };
                if before.has_scores() || after.has_scores() {
                    let (base, new) = (before.values[column], after.values[column]);
                    self.rows.push(judge(&metric, &before.method, column, base, new));
                }
            }
        }
        for column in new.score_columns().filter(|c| !base.has_column(c)) {
            self.note_new("column", column);
        }
        Ok(())
    }

    fn compare_costs(&mut self, base: &RunFolder, new: &RunFolder) -> Result<()> {
        let (before, after) = (Costs::read(&base.dir)?, Costs::read(&new.dir)?);
        let (Some(before), Some(after)) = (&before, &after) else {
            let lacking = if before.is_none() { base } else { new };
            if self.options.judges_costs() {
                bail!("expected timing.csv in both runs, found none: {}", lacking.dir.display());
            }
            self.notes.push(format!("no time and memory: {} has no timing.csv", lacking.dir.display()));
            return Ok(());
        };
        for (method, name, value) in &before.0 {
            let (Some(metric), Some(after)) = (metric_of(name), after.get(method, name)) else { continue };
            let metric = self.options.apply(name, metric);
            self.rows.push(judge(&metric, method, name, Some(*value), Some(after)));
        }
        Ok(())
    }

    /// Notes a thing that the baseline lacks.
    fn note_new(&mut self, what: &str, name: &str) {
        self.notes.push(format!("{what} {name} is new; there is nothing to compare it with"));
    }
}
