use evigrid_grid::{SafetyLabel, SafetyMap};

use crate::ratio;

/// A safety map with the true one, and the counts that its metrics are made of.
#[derive(Debug, Clone, Copy)]
pub struct SafetyCase<'a> {
    /// The map.
    pub found: &'a SafetyMap,
    /// The true map; its cells may be others.
    pub truth: &'a SafetyMap,
    /// Cells of the true map counted by what both say of them.
    pub counts: SafetyCounts,
}

/// Cells that the true map classifies, counted by what the found map says of them. Positive means unsafe
/// (Murarka and Kuipers 2009).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SafetyCounts {
    /// Unsafe in both.
    pub true_positives: usize,
    /// Safe in truth, unsafe in the map.
    pub false_positives: usize,
    /// Safe in both.
    pub true_negatives: usize,
    /// Unsafe in truth, safe in the map.
    pub false_negatives: usize,
    /// Safe in truth, not classified in the map.
    pub unclassified_safe: usize,
    /// Unsafe in truth, not classified in the map.
    pub unclassified_unsafe: usize,
}

impl<'a> SafetyCase<'a> {
    /// Looks up every cell of the true map in the found one by its centre.
    pub fn new(found: &'a SafetyMap, truth: &'a SafetyMap) -> Self {
        let mut counts = SafetyCounts::default();
        for (flat, label) in truth.labels().iter().enumerate() {
            let Some(safe) = label.is_safe() else { continue };
            let cell = found.spec().cell_of(truth.spec().centre_m(flat));
            let found = cell.map_or(SafetyLabel::Unknown, |cell| found.labels()[cell]);
            *counts.of(safe, found.is_safe()) += 1;
        }
        Self { found, truth, counts }
    }
}

impl SafetyCounts {
    /// The count of cells that are safe or not in truth, and in the map (`None`: not classified there).
    fn of(&mut self, safe: bool, found: Option<bool>) -> &mut usize {
        match (safe, found) {
            (false, Some(false)) => &mut self.true_positives,
            (true, Some(false)) => &mut self.false_positives,
            (true, Some(true)) => &mut self.true_negatives,
            (false, Some(true)) => &mut self.false_negatives,
            (true, None) => &mut self.unclassified_safe,
            (false, None) => &mut self.unclassified_unsafe,
        }
    }

    /// Number of cells that are unsafe in truth.
    pub fn truly_unsafe(&self) -> usize {
        self.true_positives + self.false_negatives + self.unclassified_unsafe
    }

    /// Number of cells that are safe in truth.
    pub fn truly_safe(&self) -> usize {
        self.true_negatives + self.false_positives + self.unclassified_safe
    }

    /// Number of cells that the map does not classify.
    pub fn unclassified(&self) -> usize {
        self.unclassified_safe + self.unclassified_unsafe
    }

    /// Share of the unsafe cells that the map classifies which it takes for safe; NaN if it classifies none.
    pub fn false_negative_rate(&self) -> f64 {
        ratio(self.false_negatives, self.false_negatives + self.true_positives)
    }

    /// Share of the safe cells that the map classifies which it takes for unsafe; NaN if it classifies none.
    pub fn false_positive_rate(&self) -> f64 {
        ratio(self.false_positives, self.false_positives + self.true_negatives)
    }

    /// Share of the true map's classified cells that the map does not classify; NaN if there are none.
    pub fn unclassified_rate(&self) -> f64 {
        ratio(self.unclassified(), self.truly_safe() + self.truly_unsafe())
    }

    /// Share of the true map's unsafe cells that are unsafe in the map too; NaN if there are none.
    pub fn unsafe_found(&self) -> f64 {
        ratio(self.true_positives, self.truly_unsafe())
    }
}
