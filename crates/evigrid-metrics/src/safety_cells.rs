//! The cells of a true safety map that count, one by one.

use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap};

use crate::SafetyReference;

/// The part of a plan that a safety map is asked about: a disc around the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanningDisc {
    /// The robot's place in the map frame, metres.
    pub at_m: [f64; 2],
    /// The planning radius, metres.
    pub radius_m: f64,
}

impl PlanningDisc {
    /// Whether the centre of a cell lies within, the radius itself included.
    pub fn contains(&self, spec: &PlanSpec, flat: usize) -> bool {
        self.squared_distance(spec, flat) <= self.radius_m * self.radius_m + 1e-9
    }

    /// Distance of the centre of a cell from the robot, metres.
    pub fn distance_m(&self, spec: &PlanSpec, flat: usize) -> f64 {
        self.squared_distance(spec, flat).sqrt()
    }

    fn squared_distance(&self, spec: &PlanSpec, flat: usize) -> f64 {
        let [x, y] = spec.centre_m(flat);
        let [dx, dy] = [x - self.at_m[0], y - self.at_m[1]];
        dx * dx + dy * dy
    }
}

/// A cell that the true map classifies, and what the found map says of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JudgedCell {
    /// Its flat index in the true map.
    pub flat: usize,
    /// Its true label, which is known.
    pub truth: SafetyLabel,
    /// Whether it is safe in truth.
    pub safe: bool,
    /// Its flat index in the found map, if it lies there.
    pub found_at: Option<usize>,
    /// Its label in the found map; unknown outside of it.
    pub found: SafetyLabel,
}

/// The cells that the true map classifies, looked up in the found map by their centres; those within `disc`
/// alone, if there is one.
pub(crate) fn judged_cells<'a>(
    found: &'a SafetyMap,
    truth: &'a SafetyReference,
    disc: Option<PlanningDisc>,
) -> impl Iterator<Item = JudgedCell> + 'a {
    let map = truth.map();
    let counts = move |flat: usize| disc.is_none_or(|disc| disc.contains(map.spec(), flat));
    map.labels().iter().enumerate().filter_map(move |(flat, &label)| {
        let safe = label.is_safe().filter(|_| counts(flat))?;
        let found_at = found.spec().cell_of(map.spec().centre_m(flat));
        let found = found_at.map_or(SafetyLabel::Unknown, |cell| found.labels()[cell]);
        Some(JudgedCell { flat, truth: label, safe, found_at, found })
    })
}
