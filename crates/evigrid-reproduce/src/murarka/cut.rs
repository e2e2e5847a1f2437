//! Cross sections of a map: the cells along a line, and the true surface below it.

use anyhow::{Context, Result};
use evigrid_grid::{GridSettings, GridSpec, PlanSpec, SafetyLabel, SafetyMap};
use evigrid_safety_map::{Columns, Robot};
use evigrid_synth::TerrainTruth;
use nalgebra::Point3;

use super::mapping::{Drive, Mapping};
use crate::chart::Point;

/// A line over the ground of a world, along one of its axes, metres in the world's frame.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    pub name: &'static str,
    /// 0: along x; 1: along y.
    pub axis: usize,
    /// From where to where along the axis, and the place across it.
    pub along_m: [f64; 2],
    pub across_m: f64,
    /// Where it crosses the first edge.
    pub edge_m: f64,
}

/// A cell on a cut. Heights are those over the floor that the robot stands on, metres.
#[derive(Debug, Clone, Copy)]
pub struct CutCell {
    /// Its centre along the cut, metres in the world's frame.
    pub along_m: f64,
    /// Centre of the highest occupied voxel below the robot's height, and the plane of its segment.
    pub column_m: Option<f64>,
    pub plane_m: Option<f64>,
    pub label: SafetyLabel,
    pub true_label: SafetyLabel,
}

/// Distance between two points of the true surface, metres.
const STEP_M: f64 = 0.02;

impl Cut {
    /// A place on the cut in the map frame.
    fn in_map(&self, drive: &Drive, along_m: f64) -> [f64; 2] {
        let mut at = [self.across_m; 2];
        at[self.axis] = along_m;
        let place = drive.map_from_world * Point3::new(at[0], at[1], 0.0);
        [place.x, place.y]
    }

    /// The last frame at which the middle of the robot is this near to the first edge.
    pub fn last_frame_near(&self, drive: &Drive, reach_m: f64) -> Result<usize> {
        let [x, y] = self.in_map(drive, self.edge_m);
        let away = |frame: &usize| {
            let pose = drive.map_from_world * drive.world.reported_world_from_left(*frame);
            let [robot_x, robot_y] = drive.mounting.robot_m(&pose);
            (robot_x - x).hypot(robot_y - y) <= reach_m
        };
        drive.frames().rev().find(away).with_context(|| format!("{}: the robot is never near", self.name))
    }

    /// Flat indices of the cells that the cut passes through, in its order.
    fn cells(&self, drive: &Drive, spec: &PlanSpec) -> Vec<usize> {
        let mut cells: Vec<usize> =
            self.steps().filter_map(|along| spec.cell_of(self.in_map(drive, along))).collect();
        cells.dedup();
        cells
    }

    fn steps(&self) -> impl Iterator<Item = f64> + use<> {
        let [from, to] = self.along_m;
        (0..=((to - from) / STEP_M) as usize).map(move |n| from + n as f64 * STEP_M)
    }

    /// The cells of a map on the cut, when the robot is at a frame's place.
    pub fn look(
        &self,
        drive: &Drive,
        frame: usize,
        map: &Mapping,
        truth: &SafetyMap,
    ) -> Result<Vec<CutCell>> {
        let (model, labels) = (map.model()?, map.mapper.map());
        let pose = drive.map_from_world * drive.world.reported_world_from_left(frame);
        let robot = Robot::below(&pose, drive.mounting);
        let (plan, mut columns) = (*labels.spec(), Columns::none(*labels.spec()));
        model.columns(&robot, &mut columns);
        let [_, _, low_m] = model.spec().origin_m();
        let c = model.spec().cell_size_m();
        let world_from_map = drive.map_from_world.inverse();
        let cell = |flat: usize| {
            let at = plan.centre_m(flat);
            let column = columns.height(flat).map(|layer| low_m + (f64::from(layer) + 0.5) * c);
            let plane = labels.plane_of(flat).and_then(|plane| plane.height_m(at));
            let [column_m, plane_m] = [column, plane].map(|height| height.map(|m| m - robot.floor_m));
            CutCell {
                along_m: (world_from_map * Point3::new(at[0], at[1], 0.0))[self.axis],
                column_m,
                plane_m,
                label: labels.labels()[flat],
                true_label: truth.labels()[flat],
            }
        };
        Ok(self.cells(drive, &plan).into_iter().map(cell).collect())
    }

    /// The true surface: places along the cut with heights over the floor at the first frame, metres.
    pub fn surface(&self, drive: &Drive) -> Result<Vec<Point>> {
        let ends = self.along_m.map(|along| self.in_map(drive, along));
        let range = |a: usize| [ends[0][a].min(ends[1][a]) - STEP_M, ends[0][a].max(ends[1][a]) + STEP_M];
        let settings =
            GridSettings { x_m: range(0), y_m: range(1), z_m: [0.0, STEP_M], cell_size_m: 0.5 * STEP_M };
        let spec = GridSpec::new(&settings)?;
        let heights = TerrainTruth::new(&drive.world, spec, &drive.map_from_world, 0)?.heights_m();
        let floor_m = -drive.mounting.height_m;
        let point = |along: f64| {
            let cell = spec.plan().cell_of(self.in_map(drive, along))?;
            Some((along, f64::from(heights[cell]) - floor_m))
        };
        Ok(self.steps().filter_map(point).filter(|(_, height)| !height.is_nan()).collect())
    }
}

/// How the truly unsafe cells within the planning radius are labelled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Found {
    pub non_ground: usize,
    pub safe: usize,
    pub unknown: usize,
}

impl Found {
    /// Counts pairs of a label and the true one.
    pub fn count(labels: impl Iterator<Item = (SafetyLabel, SafetyLabel)>) -> Self {
        let mut found = Self::default();
        for (label, _) in labels.filter(|(_, truth)| *truth == SafetyLabel::NonGround) {
            match label {
                SafetyLabel::Unexamined => {}
                SafetyLabel::Unknown => found.unknown += 1,
                SafetyLabel::NonGround => found.non_ground += 1,
                SafetyLabel::Level | SafetyLabel::Inclined => found.safe += 1,
            }
        }
        found
    }

    pub fn all(&self) -> usize {
        self.non_ground + self.safe + self.unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along x through the terrace of safety-4 and its four steps down, from its description.
    const CUT: Cut = Cut { name: "down", axis: 0, along_m: [2.0, 6.9], across_m: -0.6, edge_m: 3.0 };

    #[test]
    fn the_surface_of_a_stair_has_its_steps() {
        let surface = CUT.surface(&Drive::new("safety-4").unwrap()).unwrap();
        assert_eq!(surface.len(), 246);
        // Lighter edges of 6 cm lie 2 mm over the steps.
        let (edges, nosing_m) = ([3.0, 4.1, 5.2, 6.3], 0.06);
        for &(along, height) in &surface {
            // The height is that of the cell of 0.01 m around the place.
            let near = |place: f64| (along - place).abs() < 0.02;
            if edges.iter().any(|edge| near(*edge) || near(edge - nosing_m)) {
                continue;
            }
            let steps = edges.iter().filter(|edge| along > **edge).count();
            let is_nosing = edges.iter().any(|edge| (edge - nosing_m..*edge).contains(&along));
            let expected = -0.15 * steps as f64 + if is_nosing { 0.002 } else { 0.0 };
            assert!((height - expected).abs() < 1e-4, "{along}: {height}");
        }
    }

    #[test]
    fn cells_follow_one_another_along_the_cut() {
        let drive = Drive::new("safety-4").unwrap();
        let plan = drive.world.truth_grid().plan();
        let cells = CUT.cells(&drive, &plan);
        // 49 cells along x, and at most one more for each of the rows that the oblique line passes.
        assert!((49..=53).contains(&cells.len()), "{}", cells.len());
        for pair in cells.windows(2) {
            let [a, b] = [plan.cell(pair[0]), plan.cell(pair[1])];
            assert!(a[0].abs_diff(b[0]) <= 1 && a[1].abs_diff(b[1]) <= 1 && a != b);
        }
    }

    #[test]
    fn truly_unsafe_cells_are_counted_by_their_label() {
        use SafetyLabel::{Inclined, Level, NonGround, Unexamined, Unknown};
        let pairs = [
            (NonGround, NonGround),
            (NonGround, Level),
            (Level, NonGround),
            (Inclined, NonGround),
            (Unknown, NonGround),
            (Unexamined, NonGround),
            (Level, Level),
        ];
        let found = Found::count(pairs.into_iter());
        assert_eq!(found, Found { non_ground: 1, safe: 2, unknown: 1 });
        assert_eq!(found.all(), 4);
    }
}
