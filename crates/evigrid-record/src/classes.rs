use std::ops::Range;

use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};
use rerun::{AnnotationContext, Color};

/// A cell as map and truth see it together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum CellClass {
    /// Never touched by the map.
    Unknown,
    /// Free in the map, and not occupied in truth.
    Free,
    /// Occupied in the map, and there is no truth to judge it.
    Occupied,
    /// Occupied in both.
    Hit,
    /// Occupied in the map, free in truth.
    Mistake,
    /// Occupied in the map, and the truth does not know.
    Unobserved,
    /// Occupied in truth alone.
    Missed,
}

use CellClass::{Free, Hit, Missed, Mistake, Occupied, Unknown, Unobserved};

impl CellClass {
    /// All classes, in the order of their numbers.
    pub const ALL: [Self; 7] = [Unknown, Free, Occupied, Hit, Mistake, Unobserved, Missed];
    /// The classes that are drawn as voxels.
    pub const DRAWN: [Self; 5] = [Occupied, Hit, Mistake, Unobserved, Missed];

    /// Name in entity paths.
    pub fn name(self) -> &'static str {
        match self {
            Unknown => "unknown",
            Free => "free",
            Occupied => "occupied",
            Hit => "hit",
            Mistake => "mistake",
            Unobserved => "mistake_unobserved",
            Missed => "missed",
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Unobserved => "mistake where the truth is unknown",
            Occupied => "occupied (no truth to judge it)",
            other => other.name(),
        }
    }

    pub fn rgb(self) -> [u8; 3] {
        match self {
            Unknown => [24, 26, 30],
            Free => [66, 70, 78],
            Occupied => [176, 190, 205],
            Hit => [52, 199, 89],
            Mistake => [235, 52, 52],
            Unobserved => [255, 159, 28],
            Missed => [122, 112, 255],
        }
    }

    /// All classes with names and colours, for images of class numbers.
    pub fn annotations() -> AnnotationContext {
        AnnotationContext::new(Self::ALL.map(|class| {
            let [r, g, b] = class.rgb();
            ClassDescription::from(AnnotationInfo::from((
                class as u16,
                class.label(),
                Rgba32::from_rgb(r, g, b),
            )))
        }))
    }

    pub fn colour(self) -> Color {
        let [r, g, b] = self.rgb();
        Color::from_rgb(r, g, b)
    }
}

/// The truth of each cell, by flat index.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrueCells<'a> {
    /// Cells that were ever occupied.
    pub occupied: &'a [bool],
    /// Cells that the truth knows.
    pub observed: &'a [bool],
}

impl<'a> TrueCells<'a> {
    /// The truth of a range of cells.
    pub fn part(&self, cells: Range<usize>) -> Self {
        Self { occupied: &self.occupied[cells.clone()], observed: &self.observed[cells] }
    }
}

/// The class of one cell: of a map given as log-odds (NaN = never touched), occupied and known in truth.
pub(crate) fn class_of(log_odds: f32, occupied: bool, known: bool) -> CellClass {
    WITH_TRUTH[4 * state(log_odds) + 2 * usize::from(occupied) + usize::from(known)]
}

/// The class of one cell without any truth.
pub(crate) fn class_alone(log_odds: f32) -> CellClass {
    NO_TRUTH[state(log_odds)]
}

/// The class numbers of cells of a map given as log-odds (NaN = never touched).
pub(crate) fn classify(log_odds: &[f32], truth: Option<TrueCells<'_>>, numbers: &mut Vec<u8>) {
    numbers.clear();
    let Some(truth) = truth else {
        numbers.extend(log_odds.iter().map(|&l| class_alone(l) as u8));
        return;
    };
    let marks = truth.occupied.iter().zip(truth.observed);
    numbers.extend(
        log_odds.iter().zip(marks).map(|(&l, (&occupied, &observed))| class_of(l, occupied, observed) as u8),
    );
}

/// 0 for a cell that was never touched, 1 for a free one, 2 for an occupied one.
fn state(log_odds: f32) -> usize {
    usize::from(!log_odds.is_nan()) + usize::from(log_odds > 0.0)
}

const NO_TRUTH: [CellClass; 3] = [Unknown, Free, Occupied];
/// By state, then occupied and known in truth.
const WITH_TRUTH: [CellClass; 12] = [
    Unknown, Unknown, Missed, Missed, //
    Free, Free, Missed, Missed, //
    Unobserved, Mistake, Hit, Hit,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn map_and_laser_make_the_class() {
        let nan = f32::NAN;
        // Columns: log-odds, occupied and observed for the laser, class with laser, class without.
        let cells = [
            (nan, false, false, Unknown, Unknown),
            (nan, false, true, Unknown, Unknown),
            (nan, true, true, Missed, Unknown),
            (-1.0, false, false, Free, Free),
            (-1.0, false, true, Free, Free),
            (0.0, false, true, Free, Free),
            (0.0, true, true, Missed, Free),
            (0.1, true, true, Hit, Occupied),
            (0.1, false, true, Mistake, Occupied),
            (9.0, false, false, Unobserved, Occupied),
        ];
        let log_odds = cells.map(|c| c.0);
        let (occupied, observed) = (cells.map(|c| c.1), cells.map(|c| c.2));
        let mut classes = Vec::new();
        classify(&log_odds, Some(TrueCells { occupied: &occupied, observed: &observed }), &mut classes);
        assert_eq!(classes, cells.map(|c| c.3 as u8));
        classify(&log_odds, None, &mut classes);
        assert_eq!(classes, cells.map(|c| c.4 as u8));
    }

    #[test]
    fn numbers_names_and_colours_are_distinct() {
        for (i, a) in CellClass::ALL.into_iter().enumerate() {
            assert_eq!(a as usize, i);
            for b in &CellClass::ALL[..i] {
                assert!(a.name() != b.name() && a.rgb() != b.rgb(), "{a:?} {b:?}");
            }
        }
    }
}
