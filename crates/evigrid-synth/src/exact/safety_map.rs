//! Safety labels with the planes behind them.

use std::collections::BTreeMap;

use evigrid_grid::safe_ground::Surface;
use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap, SafetyPlane};
use nalgebra::Vector3;

/// Planes are one if the components of their normals, and their offsets in metres, differ by no more than
/// this: far more than rounding, far less than any two faces of a reasonable world.
const SAME_PLANE: f64 = 1e-9;

/// The map of these labels, in which every safe cell lies on the plane of its surface.
pub fn safety_map(spec: PlanSpec, labels: &[SafetyLabel], surfaces: &[Option<Surface>]) -> SafetyMap {
    let mut map = SafetyMap::unknown(spec);
    let mut known = KnownPlanes::default();
    for (flat, (&label, surface)) in labels.iter().zip(surfaces).enumerate() {
        let surface = surface.filter(|_| label.is_safe() == Some(true));
        let plane = surface.map(|surface| known.number(&mut map, plane_at(&spec, flat, &surface)));
        map.set(flat, label, plane);
    }
    map
}

/// The plane of the surface at the centre of a cell.
fn plane_at(spec: &PlanSpec, flat: usize, surface: &Surface) -> SafetyPlane {
    let [x, y] = spec.centre_m(flat);
    let offset_m = surface.normal.dot(&Vector3::new(x, y, surface.height_m));
    SafetyPlane { normal: surface.normal, offset_m }
}

/// The planes of a map by their offsets in steps of [`SAME_PLANE`], so that a
/// plane is found without asking all.
#[derive(Default)]
struct KnownPlanes {
    by_offset: BTreeMap<i64, Vec<u32>>,
}

impl KnownPlanes {
    /// The number of a plane in the map, which gets it if it is new.
    fn number(&mut self, map: &mut SafetyMap, plane: SafetyPlane) -> u32 {
        let step = (plane.offset_m / SAME_PLANE).floor() as i64;
        // Equal planes are at most one step apart.
        let near = self.by_offset.range(step - 1..=step + 1).flat_map(|(_, numbers)| numbers);
        let mut equal = near.filter(|&&number| is_same(&map.planes()[number as usize], &plane));
        if let Some(&number) = equal.next() {
            return number;
        }
        let number = map.add_plane(plane);
        self.by_offset.entry(step).or_default().push(number);
        number
    }
}

fn is_same(a: &SafetyPlane, b: &SafetyPlane) -> bool {
    (a.normal - b.normal).amax() <= SAME_PLANE && (a.offset_m - b.offset_m).abs() <= SAME_PLANE
}

#[cfg(test)]
#[path = "safety_map_tests.rs"]
mod tests;
