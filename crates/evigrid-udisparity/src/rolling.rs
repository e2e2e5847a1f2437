use evigrid_grid::{PlanGrid, PlanSpec};
use nalgebra::{Isometry2, Vector2};

use crate::GroundView;

/// A window of ground cells that goes with the vehicle. Its cells stay where they are in the map: it moves by whole
/// cells and never turns.
#[derive(Debug, Clone)]
pub struct RollingPlan {
    grid: PlanGrid,
    /// Whether the window moves at all.
    rolls: bool,
    /// The middle of the window as seen from the camera of the first frame, ahead and to the left, metres.
    middle_m: [f64; 2],
    /// Cells that it has moved by.
    offset: [i64; 2],
}

impl RollingPlan {
    /// The window that holds the plan's cells for a camera at the origin that looks along x.
    pub fn new(spec: PlanSpec, rolls: bool) -> Self {
        let middle = |a: usize| spec.origin_m()[a] + 0.5 * spec.shape()[a] as f64 * spec.cell_size_m();
        Self { grid: PlanGrid::unknown(spec), rolls, middle_m: [middle(0), middle(1)], offset: [0, 0] }
    }

    /// Moves the window to the view of a frame; by how many cells it went on, along x and y.
    pub fn follow(&mut self, view: &GroundView) -> [i64; 2] {
        if !self.rolls {
            return [0, 0];
        }
        let ([ahead, left], [c, s]) = (self.middle_m, view.ahead);
        let wanted = [c * ahead - s * left, s * ahead + c * left];
        let cell_m = self.grid.spec().cell_size_m();
        let offset = [0, 1].map(|a| {
            let moved_m = view.camera_m[a] + wanted[a] - self.middle_m[a];
            (moved_m / cell_m).round() as i64
        });
        let by = [offset[0] - self.offset[0], offset[1] - self.offset[1]];
        self.offset = offset;
        let [x, y] = offset.map(|cells| cells as f64 * cell_m);
        self.grid.move_to(Isometry2::new(Vector2::new(x, y), 0.0));
        by
    }

    /// The plan with its place in the map.
    pub fn grid(&self) -> &PlanGrid {
        &self.grid
    }

    /// The probabilities, to be set.
    pub fn probabilities_mut(&mut self) -> &mut [f32] {
        self.grid.probabilities_mut()
    }

    /// The cells where they are in the map.
    pub fn spec_in_map(&self) -> PlanSpec {
        self.grid.spec().moved(self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(camera_m: [f64; 2], angle: f64) -> GroundView {
        let ahead = [angle.cos(), angle.sin()];
        GroundView { camera_m, ahead, focal_px: 1.0, centre_x_px: 0.0, baseline_m: 1.0 }
    }

    #[test]
    fn the_window_goes_by_whole_cells_and_its_cells_stay_in_the_map() {
        let spec = PlanSpec::of_area([0.0, 20.0], [-10.0, 10.0], 0.2).unwrap();
        let mut plan = RollingPlan::new(spec, true);
        assert_eq!(plan.follow(&view([0.0, 0.0], 0.0)), [0, 0]);
        assert_eq!(plan.follow(&view([0.47, -0.11], 0.0)), [2, -1]);
        // Looking left: the middle is 10 m to the left of the camera.
        plan.follow(&view([0.0, 0.0], std::f64::consts::FRAC_PI_2));
        let [x, y] = plan.grid().centre_in_map_m(0);
        assert!((x + 9.9).abs() < 1e-9 && (y - 0.1).abs() < 1e-9, "{x} {y}");
        assert!((plan.spec_in_map().centre_m(0)[0] - x).abs() < 1e-9);
        assert_eq!(RollingPlan::new(spec, false).follow(&view([3.0, 1.0], 1.0)), [0, 0]);
    }
}
