use super::point::Point;

/// A point with its row of summary.csv.
#[derive(Debug)]
pub(super) struct Outcome<'a> {
    /// The point.
    pub point: &'a Point,
    /// Columns and cells.
    pub row: Vec<(String, String)>,
}

impl Outcome<'_> {
    /// The cell of a column; empty where there is none.
    pub fn cell(&self, column: &str) -> &str {
        self.row.iter().find(|(name, _)| name == column).map_or("", |(_, cell)| cell)
    }

    /// The number in a column, if there is one.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.cell(column).parse().ok()
    }
}
