use std::ops::Range;

use rerun::Color;

/// What the map and the laser say of one cell together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum CellClass {
    /// Never touched by the map.
    Unknown,
    /// Free in the map, and not occupied for the laser.
    Free,
    /// Occupied in the map, and there is no laser to judge it.
    Occupied,
    /// Occupied in both.
    Hit,
    /// Occupied in the map, free for the laser.
    Mistake,
    /// Occupied in the map, never touched by a laser ray.
    Unobserved,
    /// Occupied for the laser alone.
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
            Unobserved => "mistake where the laser saw nothing",
            Occupied => "occupied (no laser to judge it)",
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

    pub fn colour(self) -> Color {
        let [r, g, b] = self.rgb();
        Color::from_rgb(r, g, b)
    }
}

/// What the laser says of each cell, by flat index.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Laser<'a> {
    /// Cells that were ever occupied.
    pub occupied: &'a [bool],
    /// Cells that any ray touched.
    pub observed: &'a [bool],
}

impl<'a> Laser<'a> {
    /// The same for a range of cells.
    pub fn part(&self, cells: Range<usize>) -> Self {
        Self { occupied: &self.occupied[cells.clone()], observed: &self.observed[cells] }
    }
}

/// The class numbers of cells of a map given as log-odds (NaN = never touched).
pub(crate) fn classify(log_odds: &[f32], laser: Option<Laser<'_>>, numbers: &mut Vec<u8>) {
    numbers.clear();
    let Some(laser) = laser else {
        numbers.extend(log_odds.iter().map(|&l| NO_LASER[state(l)] as u8));
        return;
    };
    let marks = laser.occupied.iter().zip(laser.observed);
    numbers.extend(log_odds.iter().zip(marks).map(|(&l, (&occupied, &observed))| {
        WITH_LASER[4 * state(l) + 2 * usize::from(occupied) + usize::from(observed)] as u8
    }));
}

/// 0 for a cell that was never touched, 1 for a free one, 2 for an occupied one.
fn state(log_odds: f32) -> usize {
    usize::from(!log_odds.is_nan()) + usize::from(log_odds > 0.0)
}

const NO_LASER: [CellClass; 3] = [Unknown, Free, Occupied];
/// By state, then occupied and observed for the laser.
const WITH_LASER: [CellClass; 12] = [
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
        classify(&log_odds, Some(Laser { occupied: &occupied, observed: &observed }), &mut classes);
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
