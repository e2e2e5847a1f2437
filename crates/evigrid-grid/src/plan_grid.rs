use nalgebra::{Isometry2, Point2};

use crate::PlanSpec;

/// A ground plan of occupancy probabilities. A cell of which nothing is known is NaN, which is not the same
/// as 0.5 ("measured, undecided").
#[derive(Debug, Clone)]
pub struct PlanGrid {
    spec: PlanSpec,
    /// Where the plan lies in the map frame: the identity for one that is fixed there.
    map_from_plan: Isometry2<f64>,
    probabilities: Vec<f32>,
    velocities: Option<Vec<CellVelocity>>,
}

/// How a cell of a plan moves, if it is occupied.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CellVelocity {
    /// Its most probable velocity along the axes of the plan, m/s.
    pub mode_mps: [f32; 2],
    /// Standard deviation of its velocity around the mean, m/s.
    pub spread_mps: f32,
}

impl PlanGrid {
    /// A plan that is fixed in the map frame, nothing known.
    pub fn unknown(spec: PlanSpec) -> Self {
        Self::moving(spec, Isometry2::identity())
    }

    /// A plan that moves with the vehicle, nothing known; `map_from_plan` says where it is now.
    pub fn moving(spec: PlanSpec, map_from_plan: Isometry2<f64>) -> Self {
        let probabilities = vec![f32::NAN; spec.cell_count()];
        Self { spec, map_from_plan, probabilities, velocities: None }
    }

    /// The geometry of the cells, in the plan's own frame.
    pub fn spec(&self) -> &PlanSpec {
        &self.spec
    }

    /// Where the plan lies in the map frame, metres.
    pub fn map_from_plan(&self) -> &Isometry2<f64> {
        &self.map_from_plan
    }

    /// Moves the plan to another place of the map frame; its cells keep their values.
    pub fn move_to(&mut self, map_from_plan: Isometry2<f64>) {
        self.map_from_plan = map_from_plan;
    }

    /// P(occupied) by flat index; NaN = nothing known.
    pub fn probabilities(&self) -> &[f32] {
        &self.probabilities
    }

    /// P(occupied) by flat index, to be set.
    pub fn probabilities_mut(&mut self) -> &mut [f32] {
        &mut self.probabilities
    }

    /// How each cell moves, by flat index, where the method says so.
    pub fn velocities(&self) -> Option<&[CellVelocity]> {
        self.velocities.as_deref()
    }

    /// Says how each cell moves.
    ///
    /// # Panics
    /// If there are not as many velocities as cells.
    pub fn set_velocities(&mut self, velocities: Vec<CellVelocity>) {
        assert_eq!(velocities.len(), self.spec.cell_count(), "one velocity per cell");
        self.velocities = Some(velocities);
    }

    /// Centre of a cell in the map frame, metres.
    pub fn centre_in_map_m(&self, flat: usize) -> [f64; 2] {
        let centre = self.map_from_plan * Point2::from(self.spec.centre_m(flat));
        [centre.x, centre.y]
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn a_moving_plan_has_its_cells_where_the_vehicle_is() {
        let spec = PlanSpec::of_area([0.0, 4.0], [-1.0, 1.0], 1.0).unwrap();
        let fixed = PlanGrid::unknown(spec);
        assert_eq!(fixed.centre_in_map_m(0), [0.5, -0.5]);
        let quarter_turn = Isometry2::new(Vector2::new(10.0, 20.0), std::f64::consts::FRAC_PI_2);
        let moving = PlanGrid::moving(spec, quarter_turn);
        let [x, y] = moving.centre_in_map_m(0);
        assert!((x - 10.5).abs() < 1e-12 && (y - 20.5).abs() < 1e-12, "{x} {y}");
        assert!(moving.probabilities().iter().all(|p| p.is_nan()));
    }
}
