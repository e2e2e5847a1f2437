//! A CSV table with a header, whose errors name file, line and column.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail};

/// A table as text.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) path: PathBuf,
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Row>,
}

/// A row as text.
#[derive(Debug)]
pub(super) struct Row {
    /// In the file, from 1.
    line: u64,
    fields: csv::StringRecord,
}

impl Table {
    /// Reads a table that must have some columns.
    ///
    /// # Errors
    /// If it cannot be read, its rows are not all as long as its header, or a column is missing or there
    /// twice.
    pub(super) fn read(path: &Path, required: &[&str]) -> Result<Self> {
        let wrong = |e: csv::Error| anyhow!("cannot read the table: {e}: {}", path.display());
        let mut reader = csv::Reader::from_path(path).map_err(wrong)?;
        let columns: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
        check_columns(path, &columns, required)?;
        let row = |record: csv::Result<csv::StringRecord>| {
            let fields = record.map_err(wrong)?;
            Ok(Row { line: fields.position().map_or(0, csv::Position::line), fields })
        };
        let rows = reader.into_records().map(row).collect::<Result<_>>()?;
        Ok(Self { path: path.to_owned(), columns, rows })
    }

    /// Whether there is a column of this name.
    pub(super) fn has_column(&self, column: &str) -> bool {
        self.columns.iter().any(|c| c == column)
    }

    /// Nothing, if there is a column of this name.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn require_column(&self, column: &str) -> Result<()> {
        if self.has_column(column) { Ok(()) } else { Err(missing(&self.path, &self.columns, column)) }
    }

    /// A field.
    ///
    /// # Errors
    /// If there is no such column.
    pub(super) fn text<'a>(&self, row: &'a Row, column: &str) -> Result<&'a str> {
        let at = self.columns.iter().position(|c| c == column);
        let field = at.and_then(|at| row.fields.get(at));
        field.ok_or_else(|| missing(&self.path, &self.columns, column))
    }

    /// A field as a number; `None` if it is empty.
    ///
    /// # Errors
    /// If it is something else, or there is no such column.
    pub(super) fn number(&self, row: &Row, column: &str) -> Result<Option<f64>> {
        match self.text(row, column)? {
            "" => Ok(None),
            text => match text.parse::<f64>() {
                Ok(value) if value.is_finite() && value >= 0.0 => Ok(Some(value)),
                _ => Err(self.wrong(row, column, "a finite number, at least 0", text)),
            },
        }
    }

    /// Nothing, if a field is as expected.
    ///
    /// # Errors
    /// If it is not.
    pub(super) fn expect_text(&self, row: &Row, column: &str, expected: &str) -> Result<()> {
        match self.text(row, column)? {
            found if found == expected => Ok(()),
            found => Err(self.wrong(row, column, &format!("{expected} as in run.json"), found)),
        }
    }

    fn wrong(&self, row: &Row, column: &str, expected: &str, found: &str) -> anyhow::Error {
        let found: String = found.chars().take(40).collect();
        anyhow!(
            "column `{column}`: expected {expected}, found `{found}`: {} line {}",
            self.path.display(),
            row.line
        )
    }
}

fn check_columns(path: &Path, columns: &[String], required: &[&str]) -> Result<()> {
    if let Some(column) = required.iter().find(|r| !columns.iter().any(|c| c == *r)) {
        return Err(missing(path, columns, column));
    }
    if let Some((_, twice)) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)) {
        bail!("expected each column once, found `{twice}` twice: {}", path.display());
    }
    Ok(())
}

fn missing(path: &Path, columns: &[String], column: &str) -> anyhow::Error {
    let found: String = columns.join(", ").chars().take(300).collect();
    anyhow!("expected the column `{column}`, found {found}: {}", path.display())
}
