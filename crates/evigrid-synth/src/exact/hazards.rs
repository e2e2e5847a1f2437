//! The cells of named hazards and safe areas.

use evigrid_core::Pose;
use evigrid_grid::{PlanSpec, SafetyMap};
use nalgebra::Point3;

use crate::hazard_spec::{Area, NamedArea};
use crate::{HazardKind, SynthError, World};

/// A hazard or a safe area of a world on a ground plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hazard {
    /// Its name, which no other has.
    pub name: String,
    /// What makes it dangerous, or that it is safe.
    pub kind: HazardKind,
    /// Flat indices of its cells, in ascending order: those with their centre in its area that the true
    /// safety map calls unsafe (of a safe area: safe). Cells of unknown safety belong to none.
    pub cells: Vec<usize>,
}

/// The hazards of a world on the plan of its true safety map ([`super::SafetyTruth::map`]), then its safe
/// areas. A cell may belong to several.
///
/// # Errors
/// If one has no cell; the message names it.
pub fn hazards(world: &World, map_from_world: &Pose, truth: &SafetyMap) -> Result<Vec<Hazard>, SynthError> {
    let hazards = hazards_or_nothing(world, map_from_world, truth);
    let Some(empty) = hazards.iter().find(|hazard| hazard.cells.is_empty()) else { return Ok(hazards) };
    let (key, expected) = if empty.kind.is_safe() {
        ("safe_area", "at least one safe cell of the safety map in its area")
    } else {
        ("hazard", "at least one unsafe cell of the safety map in its area")
    };
    Err(SynthError::value(format!("{key} {}", empty.name), expected, "none"))
}

/// The hazards of a world on the plan of its true safety map, then its safe areas. Those that lie outside of
/// the plan, for one, have no cells.
pub fn hazards_or_nothing(world: &World, map_from_world: &Pose, truth: &SafetyMap) -> Vec<Hazard> {
    let world_from_map = map_from_world.inverse();
    let hazard = |named: &NamedArea| {
        let in_area = cells_in(&named.area, truth.spec(), &world_from_map);
        let wanted = Some(named.kind.is_safe());
        let cells = in_area.filter(|&flat| truth.labels()[flat].is_safe() == wanted).collect();
        Hazard { name: named.name.clone(), kind: named.kind, cells }
    };
    world.areas.iter().map(hazard).collect()
}

/// The cells with their centre in an area of the world.
fn cells_in<'a>(
    area: &'a Area,
    spec: &'a PlanSpec,
    world_from_map: &'a Pose,
) -> impl Iterator<Item = usize> + 'a {
    (0..spec.cell_count()).filter(move |&flat| {
        let [x, y] = spec.centre_m(flat);
        let place = world_from_map * Point3::new(x, y, 0.0);
        area.contains([place.x, place.y])
    })
}

#[cfg(test)]
#[path = "hazards_tests.rs"]
mod tests;
