//! A comparison as text.

use std::fmt::Write as _;

use evigrid_metrics::Kind;

use super::Comparison;
use super::judge::{Row, Verdict};

impl Comparison {
    /// The comparison as a person reads it: what changed (`all`: everything), worst first, notes, and one
    /// line of verdict.
    pub fn to_text(&self, all: bool) -> String {
        let shown: Vec<&Row> = self.rows.iter().filter(|r| all || r.verdict != Verdict::Unchanged).collect();
        let gone = |method: &String| [method, "(all)", "there", "missing", "", "worse"].map(str::to_owned);
        let mut lines: Vec<[String; 6]> = self.missing_methods.iter().map(gone).collect();
        lines.extend(shown.iter().map(|row| cells(row)));
        let mut text = String::new();
        if !lines.is_empty() {
            lines.insert(0, ["method", "metric", "base", "new", "change", "verdict"].map(str::to_owned));
            text = format!("{}\n", table(&lines));
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        text + &self.verdict()
    }

    fn verdict(&self) -> String {
        let count = |verdict| self.rows.iter().filter(|r| r.verdict == verdict).count();
        let worse = count(Verdict::Worse) + self.missing_methods.len();
        let better = count(Verdict::Better);
        let word = match (worse, better) {
            (0, 0) => "unchanged",
            (0, _) => "better",
            _ => "worse",
        };
        let not_judged = count(Verdict::NotJudged);
        let unchanged = count(Verdict::Unchanged);
        format!(
            "Verdict: {word} ({worse} worse, {better} better, {unchanged} unchanged, \
             {not_judged} changed but not judged)\n"
        )
    }
}

/// Columns side by side: names to the left, numbers to the right.
fn table(lines: &[[String; 6]]) -> String {
    let width = |column: usize| lines.iter().map(|l| l[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let mut text = String::new();
    for line in lines {
        let mut cells = line.iter().zip(widths).enumerate().map(|(column, (cell, width))| match column {
            2..=4 => format!("{cell:>width$}"),
            _ => format!("{cell:<width$}"),
        });
        let joined = cells.by_ref().collect::<Vec<_>>().join("  ");
        let _ = writeln!(text, "{}", joined.trim_end());
    }
    text
}

fn cells(row: &Row) -> [String; 6] {
    let method = if row.method.is_empty() { "-" } else { &row.method };
    let verdict = match row.verdict {
        Verdict::Worse => "worse",
        Verdict::Better => "better",
        Verdict::NotJudged => "not judged",
        Verdict::Unchanged => "unchanged",
    };
    let value = |value: Option<f64>| value.map_or("undefined".to_owned(), |v| number(row.kind, v));
    let (base, new) = (value(row.base), value(row.new));
    [method.to_owned(), row.metric.clone(), base, new, change(row), verdict.to_owned()]
}

fn number(kind: Kind, value: f64) -> String {
    match kind {
        Kind::Rate => format!("{value:.6}"),
        Kind::Count | Kind::Reference => value.to_string(),
        Kind::Cost => format!("{value:.2}"),
    }
}

/// Rates by their difference, all others by their share of the baseline.
fn change(row: &Row) -> String {
    match (row.base, row.new, row.kind) {
        (Some(base), Some(new), Kind::Rate) => format!("{:+.6}", new - base),
        (Some(base), Some(new), _) if base > 0.0 => format!("{:+.2} %", 100.0 * (new - base) / base),
        (Some(base), Some(new), _) => format!("{:+}", new - base),
        _ => String::new(),
    }
}
