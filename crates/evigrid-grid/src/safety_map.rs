use nalgebra::Vector3;

use crate::PlanSpec;

/// The meaning of a cell to a robot that drives (Murarka and Kuipers 2009).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum SafetyLabel {
    /// Safe, and nearly level.
    Level,
    /// Safe, and inclined.
    Inclined,
    /// Unsafe: too steep, an edge, an obstacle, or ground that the robot cannot get to.
    NonGround,
    /// No surface, or a surface too small or too thin to tell.
    Unknown,
    /// Outside of the planning radius, so nobody has looked.
    Unexamined,
}

impl SafetyLabel {
    /// All labels, in the order of their numbers.
    pub const ALL: [Self; 5] =
        [Self::Level, Self::Inclined, Self::NonGround, Self::Unknown, Self::Unexamined];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Level => "level",
            Self::Inclined => "inclined",
            Self::NonGround => "non_ground",
            Self::Unknown => "unknown",
            Self::Unexamined => "unexamined",
        }
    }

    /// Whether a robot may drive there; `None` where nobody knows.
    pub fn is_safe(self) -> Option<bool> {
        match self {
            Self::Level | Self::Inclined => Some(true),
            Self::NonGround => Some(false),
            Self::Unknown | Self::Unexamined => None,
        }
    }
}

/// A plane of ground: all points p with normal . p = offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafetyPlane {
    /// Upward unit normal in the map frame.
    pub normal: Vector3<f64>,
    /// Distance of the plane from the map frame's origin along the normal, metres.
    pub offset_m: f64,
}

/// Safety labels of the cells of a ground plan, with the planes behind them.
#[derive(Debug, Clone)]
pub struct SafetyMap {
    spec: PlanSpec,
    labels: Vec<SafetyLabel>,
    planes: Vec<SafetyPlane>,
    plane_of: Vec<Option<u32>>,
    is_drop_off: Vec<bool>,
}

impl SafetyMap {
    /// A map of which nothing is known.
    pub fn unknown(spec: PlanSpec) -> Self {
        Self::of(spec, SafetyLabel::Unknown)
    }

    /// A map of one label, without planes.
    pub fn of(spec: PlanSpec, label: SafetyLabel) -> Self {
        let cells = spec.cell_count();
        let (labels, plane_of) = (vec![label; cells], vec![None; cells]);
        Self { spec, labels, planes: Vec::new(), plane_of, is_drop_off: vec![false; cells] }
    }

    /// The geometry of the cells, in the map frame.
    pub fn spec(&self) -> &PlanSpec {
        &self.spec
    }

    /// Labels by flat index.
    pub fn labels(&self) -> &[SafetyLabel] {
        &self.labels
    }

    /// The planes of ground.
    pub fn planes(&self) -> &[SafetyPlane] {
        &self.planes
    }

    /// The plane that a cell lies on, if any.
    pub fn plane_of(&self, flat: usize) -> Option<&SafetyPlane> {
        self.plane_of[flat].map(|plane| &self.planes[plane as usize])
    }

    /// Number of the plane that each cell lies on, by flat index.
    pub fn plane_numbers(&self) -> &[Option<u32>] {
        &self.plane_of
    }

    /// Whether a cell may be the edge of a drop-off, by flat index.
    pub fn drop_offs(&self) -> &[bool] {
        &self.is_drop_off
    }

    /// Marks a cell as a potential drop-off edge.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn mark_drop_off(&mut self, flat: usize) {
        self.is_drop_off[flat] = true;
    }

    /// Adds a plane; its number.
    pub fn add_plane(&mut self, plane: SafetyPlane) -> u32 {
        self.planes.push(plane);
        (self.planes.len() - 1) as u32
    }

    /// Labels a cell that lies on a plane of this map, or on none.
    ///
    /// # Panics
    /// If there is no such cell or plane.
    pub fn set(&mut self, flat: usize, label: SafetyLabel, plane: Option<u32>) {
        assert!(plane.is_none_or(|plane| (plane as usize) < self.planes.len()), "no plane {plane:?}");
        (self.labels[flat], self.plane_of[flat]) = (label, plane);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn cells_keep_their_label_and_plane() {
        let mut map = SafetyMap::unknown(PlanSpec::of_area([0.0, 2.0], [0.0, 1.0], 1.0).unwrap());
        let floor = SafetyPlane { normal: Vector3::z(), offset_m: -1.0 };
        let plane = map.add_plane(floor);
        map.set(1, SafetyLabel::Level, Some(plane));
        assert_eq!(map.labels(), [SafetyLabel::Unknown, SafetyLabel::Level]);
        assert_eq!((map.plane_of(0), map.plane_of(1)), (None, Some(&floor)));
        for (number, label) in SafetyLabel::ALL.into_iter().enumerate() {
            assert_eq!(label as usize, number);
        }
    }
}
