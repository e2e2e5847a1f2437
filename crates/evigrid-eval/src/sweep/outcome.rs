use evigrid_grid::LayerKind;

use super::point::{Point, text};

/// A point with its scores.
#[derive(Debug)]
pub(super) struct Outcome<'a> {
    /// The point.
    pub point: &'a Point,
    /// Columns and cells of the summaries of all kinds of layers that the method makes.
    pub row: Vec<(String, String)>,
}

impl Outcome<'_> {
    /// The cell of a column; empty where there is none.
    pub fn cell(&self, column: &str) -> &str {
        self.row.iter().find(|(name, _)| name == column).map_or("", |(_, cell)| cell)
    }

    /// The values of the swept keys as cells; empty where the method does not have the key.
    pub fn values(&self) -> Vec<String> {
        self.point.values.iter().map(|value| value.as_ref().map(text).unwrap_or_default()).collect()
    }

    /// The kinds of layers that the method makes.
    pub fn layers(&self) -> &[LayerKind] {
        let job = &self.point.job;
        job.methods[0].layers
    }

    /// The number in a column, if there is one.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.cell(column).parse().ok()
    }
}
