//! Compares two runs: what got better, what got worse, by more than a tolerance. Runs that were not made under the
//! same conditions are refused; what counts as a condition is written in docs/metrics.md.

mod conditions;
mod judge;
mod metric;
mod report;
mod rule;
mod run_folder;
mod table;
mod timing;

use std::path::Path;

use anyhow::{Result, bail};

pub use rule::{CompareOptions, ToleranceRule, parse_percent};

use conditions::{check_conditions, notes};
use judge::{Row, Verdict, judge};
use metric::metric_of;
use run_folder::RunFolder;
use timing::Costs;

/// What comparing two runs has found.
#[derive(Debug)]
pub struct Comparison {
    /// Methods of the baseline that the new run lacks.
    missing_methods: Vec<String>,
    /// One entry per method and metric, worst first.
    rows: Vec<Row>,
    /// What a reader should know beside the metrics.
    notes: Vec<String>,
}

impl Comparison {
    /// Whether anything got worse. A method that is gone has.
    pub fn is_worse(&self) -> bool {
        !self.missing_methods.is_empty() || self.rows.iter().any(|r| r.verdict == Verdict::Worse)
    }
}

/// Compares the run in the folder `new` with the run in the folder `base`.
///
/// # Errors
/// If one of the folders holds no run, or one of another format, or a damaged one; if the runs were made under
/// different conditions; if an option names a metric that they do not have.
pub fn compare(base: &Path, new: &Path, options: &CompareOptions) -> Result<Comparison> {
    let (base, new) = (RunFolder::read(base)?, RunFolder::read(new)?);
    check_conditions(&base, &new)?;
    let (mut rows, mut notes) = (Vec::new(), notes(&base, &new)?);
    compare_scores(&base, &new, options, &mut rows, &mut notes)?;
    compare_costs(&base, &new, options, &mut rows, &mut notes)?;
    options.check_names(&rows.iter().map(|r| r.metric.as_str()).collect::<Vec<_>>())?;
    rows.sort_by(|a, b| a.verdict.cmp(&b.verdict).then(b.excess.total_cmp(&a.excess)));
    let lacks = |folder: &RunFolder, name: &&String| folder.method(name).is_none();
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
    for column in base.score_columns() {
        if !new.columns.contains(column) {
            let (found, file) = (new.columns.join(", "), new.dir.join("summary.csv"));
            bail!("expected the column `{column}` as in BASE, found {found}: {}", file.display());
        }
        let Some(metric) = metric_of(column) else {
            notes.push(format!("column {column} is unknown to this version and not compared"));
            continue;
        };
        let metric = options.apply(column, metric);
        for before in &base.methods {
            let Some(after) = new.method(&before.method) else { continue };
            rows.push(judge(&metric, &before.method, column, before.values[column], after.values[column]));
        }
    }
    for column in new.score_columns().filter(|c| !base.columns.contains(c)) {
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
