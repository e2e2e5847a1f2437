use evigrid_grid::{PlanSpec, SafetyMap};

/// A true safety map, with what else is known of its cells.
#[derive(Debug, Clone)]
pub struct SafetyReference {
    map: SafetyMap,
    is_at_border: Vec<bool>,
    from_unsafe_m: Vec<f64>,
    /// Measured height of each cell, metres, NaN where none; empty where the planes of the map are exact.
    heights_m: Vec<f64>,
    /// When the robot is on each cell for the last time; empty where nobody tells its way.
    last_visit: Vec<Option<usize>>,
    areas: Vec<NamedArea>,
}

/// Cells with a name: a hazard, or an area that is safe.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedArea {
    /// Its name.
    pub name: String,
    /// What makes it dangerous, or that it is safe.
    pub kind: String,
    /// Whether its cells are safe in truth.
    pub is_safe: bool,
    /// Flat indices of its cells in the true map, ascending. All are safe, or all unsafe.
    pub cells: Vec<usize>,
}

impl SafetyReference {
    /// The reference of a true map.
    pub fn new(map: SafetyMap) -> Self {
        let is_at_border = (0..map.labels().len()).map(|cell| is_at_border(&map, cell)).collect();
        let is_unsafe: Vec<bool> = map.labels().iter().map(|label| label.is_safe() == Some(false)).collect();
        let from_unsafe_m = distances_m(map.spec(), &is_unsafe);
        let (heights_m, last_visit, areas) = (Vec::new(), Vec::new(), Vec::new());
        Self { map, is_at_border, from_unsafe_m, heights_m, last_visit, areas }
    }

    /// The same with the height that was measured in each cell, metres, NaN where none was. Planes are then held
    /// against planes that are fitted to these heights over the same cells.
    #[must_use]
    pub fn with_heights(self, heights_m: Vec<f64>) -> Self {
        Self { heights_m, ..self }
    }

    /// The same with the robot's way: its place in the map frame at each frame of the run, metres. Between two
    /// frames it drives straight.
    #[must_use]
    pub fn with_way(self, places_m: &[[f64; 2]]) -> Self {
        let last_visit = last_visits(self.map.spec(), places_m);
        Self { last_visit, ..self }
    }

    /// The same with named hazards and safe areas.
    #[must_use]
    pub fn with_areas(self, areas: Vec<NamedArea>) -> Self {
        Self { areas, ..self }
    }

    /// The true map.
    pub fn map(&self) -> &SafetyMap {
        &self.map
    }

    /// Measured height of each cell in the map frame, metres, NaN where none; empty where planes are exact.
    pub fn heights_m(&self) -> &[f64] {
        &self.heights_m
    }

    /// Named hazards and safe areas.
    pub fn areas(&self) -> &[NamedArea] {
        &self.areas
    }

    /// Whether a neighbour of a cell is unsafe and the cell safe, or the other way round. A laser map that was
    /// annotated by hand could not resolve such cells.
    pub fn is_at_border(&self, flat: usize) -> bool {
        self.is_at_border[flat]
    }

    /// Distance between the centres of a cell and of the nearest unsafe one, metres; infinite if there is none.
    pub fn from_unsafe_m(&self, flat: usize) -> f64 {
        self.from_unsafe_m[flat]
    }

    /// Whether the robot is on a cell after a frame, given by its position in the run.
    pub fn is_driven_after(&self, flat: usize, position: usize) -> bool {
        self.last_visit.get(flat).copied().flatten().is_some_and(|last| last > position)
    }
}

fn is_at_border(map: &SafetyMap, flat: usize) -> bool {
    let own = map.labels()[flat].is_safe();
    let is_other = |cell: usize| map.labels()[cell].is_safe().is_some_and(|other| Some(other) != own);
    own.is_some() && map.spec().neighbours(flat).any(is_other)
}

/// Distance of the centre of every cell from that of the nearest marked one, metres, infinite without any: along
/// y first, then over the cells of the same row (the separable Euclidean distance).
fn distances_m(spec: &PlanSpec, is_marked: &[bool]) -> Vec<f64> {
    let [nx, ny] = spec.shape();
    let mut along_y = vec![f64::INFINITY; nx * ny];
    for (cells, marks) in along_y.chunks_mut(ny).zip(is_marked.chunks(ny)) {
        fill_distances(cells.iter_mut().zip(marks));
        fill_distances(cells.iter_mut().zip(marks).rev());
    }
    let squared = |flat: usize| {
        let (i, j) = (flat / ny, flat % ny);
        let from_row = |row: usize| (row.abs_diff(i) as f64).powi(2) + along_y[row * ny + j].powi(2);
        (0..nx).map(from_row).fold(f64::INFINITY, f64::min)
    };
    (0..nx * ny).map(|flat| squared(flat).sqrt() * spec.cell_size_m()).collect()
}

/// Lowers the distances of a row of cells to the number of steps from the last marked cell.
fn fill_distances<'a>(cells: impl Iterator<Item = (&'a mut f64, &'a bool)>) {
    let mut steps = f64::INFINITY;
    for (distance, &is_marked) in cells {
        steps = if is_marked { 0.0 } else { steps + 1.0 };
        *distance = distance.min(steps);
    }
}

/// For each cell the last frame at which the robot's place lies in it, or the later frame of the two that it
/// drives between when it crosses it. Ways are sampled ten times a cell.
fn last_visits(spec: &PlanSpec, places_m: &[[f64; 2]]) -> Vec<Option<usize>> {
    let mut last = vec![None; spec.cell_count()];
    let mut before = places_m.first().copied();
    for (position, &place) in places_m.iter().enumerate() {
        let from = before.replace(place).unwrap_or(place);
        let length_m = (place[0] - from[0]).hypot(place[1] - from[1]);
        let steps = (10.0 * length_m / spec.cell_size_m()).ceil().max(1.0);
        for step in 0..=steps as usize {
            let t = step as f64 / steps;
            let at = [0, 1].map(|a| from[a] + t * (place[a] - from[a]));
            if let Some(cell) = spec.cell_of(at) {
                last[cell] = Some(position);
            }
        }
    }
    last
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::SafetyLabel;
    use proptest::prelude::*;

    fn spec() -> PlanSpec {
        PlanSpec::of_area([-1.0, 2.5], [0.0, 2.5], 0.5).unwrap()
    }

    proptest! {
        #[test]
        fn distances_are_those_of_all_pairs(marks in prop::collection::vec(any::<bool>(), 35), all in 0..35_usize) {
            // Few marks and many: only the first `all` may be marked.
            let marks: Vec<bool> = marks.iter().enumerate().map(|(n, mark)| *mark && n < all).collect();
            let spec = spec();
            let found = distances_m(&spec, &marks);
            for (flat, &distance) in found.iter().enumerate() {
                let [x, y] = spec.centre_m(flat);
                let to = |other: usize| {
                    let [u, v] = spec.centre_m(other);
                    (u - x).hypot(v - y)
                };
                let expected =
                    (0..35).filter(|&n| marks[n]).map(to).fold(f64::INFINITY, f64::min);
                prop_assert!(distance == expected || (distance - expected).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_cell_is_driven_until_the_last_visit() {
        let map = SafetyMap::of(spec(), SafetyLabel::Level);
        // Along x over four cells in one frame, then back by one, then outside of the map.
        let way = [[-0.75, 0.25], [0.75, 0.25], [0.25, 0.25], [0.25, -9.0]];
        let reference = SafetyReference::new(map).with_way(&way);
        let last = |x: f64| {
            let cell = spec().cell_of([x, 0.25]).unwrap();
            (0..5).filter(|&position| reference.is_driven_after(cell, position)).max()
        };
        // Driven after frame p until the frame of the last visit, less one.
        assert_eq!([-0.75, -0.25, 0.25, 0.75, 1.25].map(last), [Some(0), Some(0), Some(2), Some(1), None]);
        assert!(!SafetyReference::new(SafetyMap::unknown(spec())).is_driven_after(0, 0));
    }
}
