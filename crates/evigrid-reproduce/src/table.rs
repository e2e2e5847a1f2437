//! Tables as CSV.

use anyhow::Result;
use evigrid_metrics::Counts;

/// A column of a table: its name, and its cell in a row.
pub type Column<T> = (&'static str, fn(&T) -> String);

/// The text of a table.
pub fn csv_text<R>(header: &[&str], rows: impl IntoIterator<Item = R>) -> Result<String>
where
    R: IntoIterator<Item = String>,
{
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for row in rows {
        writer.write_record(row)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A number as it stands in a table: nothing where there is none.
pub fn cell(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}

/// A number with so many digits behind the point; nothing where there is none.
pub fn rounded(value: f64, digits: usize) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.digits$}") }
}

/// Names of the columns of [`score_cells`].
pub const SCORE_COLUMNS: [&str; 6] = ["hits", "mistakes", "missed", "precision", "recall", "f1"];

/// The scores of a map as they stand in a table.
pub fn score_cells(counts: &Counts) -> [String; 6] {
    let [precision, recall, f1] = [counts.precision(), counts.recall(), counts.f1()].map(|v| rounded(v, 4));
    let (hits, mistakes, missed) = (counts.hits, counts.mistakes, counts.missed());
    [hits.to_string(), mistakes.to_string(), missed.to_string(), precision, recall, f1]
}
