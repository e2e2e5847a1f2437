use evigrid_grid::{PlanSpec, SafetyMap};

/// A true safety map, with the cells next to a border between safe and unsafe ones.
#[derive(Debug, Clone)]
pub struct SafetyReference {
    map: SafetyMap,
    is_at_border: Vec<bool>,
    /// Measured height of each cell, metres, NaN where none; empty where the planes of the map are exact.
    heights_m: Vec<f64>,
}

impl SafetyReference {
    /// The reference of a true map.
    pub fn new(map: SafetyMap) -> Self {
        let is_at_border = (0..map.labels().len()).map(|cell| is_at_border(&map, cell)).collect();
        Self { map, is_at_border, heights_m: Vec::new() }
    }

    /// The same with the height that was measured in each cell, metres, NaN where none was. Planes are then held
    /// against planes that are fitted to these heights over the same cells.
    #[must_use]
    pub fn with_heights(self, heights_m: Vec<f64>) -> Self {
        Self { heights_m, ..self }
    }

    /// The true map.
    pub fn map(&self) -> &SafetyMap {
        &self.map
    }

    /// Measured height of each cell in the map frame, metres, NaN where none; empty where planes are exact.
    pub fn heights_m(&self) -> &[f64] {
        &self.heights_m
    }

    /// Whether a neighbour of a cell is unsafe and the cell safe, or the other way round. A laser map that was
    /// annotated by hand could not resolve such cells.
    pub fn is_at_border(&self, flat: usize) -> bool {
        self.is_at_border[flat]
    }
}

fn is_at_border(map: &SafetyMap, flat: usize) -> bool {
    let own = map.labels()[flat].is_safe();
    let is_other = |cell: usize| map.labels()[cell].is_safe().is_some_and(|other| Some(other) != own);
    own.is_some() && map.spec().neighbours(flat).any(is_other)
}

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
        let [x, y] = spec.centre_m(flat);
        let [dx, dy] = [x - self.at_m[0], y - self.at_m[1]];
        dx * dx + dy * dy <= self.radius_m * self.radius_m + 1e-9
    }
}
