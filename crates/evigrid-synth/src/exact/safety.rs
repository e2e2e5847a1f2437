//! Where a robot can drive, by the definitions of a published method but with the world's real surfaces.

use evigrid_core::Pose;
use evigrid_grid::safe_ground::{Plan, SafetyRules, Surface, Verdict};
use evigrid_grid::{GridSpec, SafetyLabel, SafetyMap};
use rayon::prelude::*;

use super::safety_map::safety_map;
use super::terrain::{GroundColumn, Probe, cell_point};
use crate::{SynthError, World};

/// True safety labels of the cells (i, j) of a grid's ground plan.
///
/// The surface of a cell is that of [`super::TerrainTruth`]. A cell has an edge, and is non-ground, if at
/// 4 x 4 places in it the height is more than `max_step_m` off the plane at its centre, or something there
/// reaches higher than the robot, or nothing is there. Segments are 8-connected cells on one continuous
/// surface, of which all or none are too steep. What follows is Algorithm 2 of the paper, with the true
/// planes at the cells in place of fitted ones:
/// - segments that steps of at most `max_examined_step_m` do not lead to from the robot's are non-ground;
/// - steep segments are non-ground, small and thin ones unknown, the one under the robot is safe;
/// - a segment next to a safe one becomes safe if at enough cells of either at their border the heights
///   differ by less than `max_step_m`; all others are non-ground.
///
/// Whether safe ground is level or inclined is decided cell by cell.
#[derive(Debug, Clone)]
pub struct SafetyTruth {
    spec: GridSpec,
    labels: Vec<SafetyLabel>,
    /// The surface of each cell that is on a surface and has no edge.
    surfaces: Vec<Option<Surface>>,
}

/// Places along each edge of a cell where its surface is looked at.
const PLACES: usize = 4;

/// State of a cell before segments are known.
#[derive(Debug, Clone, Copy)]
enum Examined {
    Nothing,
    Obstacle,
    Ground(Surface),
}

impl SafetyTruth {
    /// The truth for the cells of `spec`, whose heights do not matter, and a robot that starts at
    /// `first_frame`. If it stands outside of the grid, it counts as standing on the nearest cell.
    ///
    /// # Errors
    /// As [`super::TerrainTruth::new`], or if the robot's cell has no surface or an edge.
    pub fn new(
        world: &World,
        spec: GridSpec,
        map_from_world: &Pose,
        first_frame: usize,
        rules: &SafetyRules,
    ) -> Result<Self, SynthError> {
        let probe = Probe::new(world, map_from_world, first_frame)?;
        let [nx, ny, _] = spec.shape();
        let cell = |flat: usize| [flat / ny, flat % ny];
        let is_near = |cell: [usize; 2]| {
            let [x, y] = cell_point(&spec, cell, [0.5, 0.5]);
            let away = libm::hypot(x - probe.robot_m[0], y - probe.robot_m[1]);
            rules.max_range_m.is_none_or(|limit| away <= limit)
        };
        let examined: Vec<Examined> = (0..nx * ny)
            .into_par_iter()
            .with_min_len(64)
            .map(|flat| match cell(flat) {
                cell if is_near(cell) => examine(&probe, &spec, cell, rules),
                _ => Examined::Nothing,
            })
            .collect();
        let surface = |cell: &Examined| match cell {
            Examined::Ground(surface) => Some(*surface),
            Examined::Nothing | Examined::Obstacle => None,
        };
        let surfaces: Vec<Option<Surface>> = examined.iter().map(surface).collect();
        let plan = Plan { shape: [nx, ny], cell_size_m: spec.cell_size_m(), surfaces: &surfaces, rules };
        let segments = plan.segments();
        let Some(start) = segments.of_cell[nearest_cell(&spec, probe.robot_m)] else {
            let expected =
                format!("the robot on a surface without an edge in its cell at frame {first_frame}");
            return Err(SynthError::value("robot", expected, "an edge or nothing"));
        };
        let verdicts = plan.verdicts(&segments, start);
        let label = |(flat, cell): (usize, &Examined)| match cell {
            Examined::Nothing => SafetyLabel::Unknown,
            Examined::Obstacle => SafetyLabel::NonGround,
            Examined::Ground(surface) => match segments.of_cell[flat].map(|segment| verdicts[segment]) {
                Some(Verdict::Safe) if surface.slope_rad().to_degrees() > rules.level_slope_deg => {
                    SafetyLabel::Inclined
                }
                Some(Verdict::Safe) => SafetyLabel::Level,
                Some(Verdict::Unknown) => SafetyLabel::Unknown,
                Some(Verdict::Steep | Verdict::Unreached) | None => SafetyLabel::NonGround,
            },
        };
        Ok(Self { labels: examined.iter().enumerate().map(label).collect(), surfaces, spec })
    }

    /// The grid's geometry; only x and y matter.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The label of each cell (i, j); its place in the list is i * ny + j.
    pub fn labels(&self) -> &[SafetyLabel] {
        &self.labels
    }

    /// The labels on the grid's ground plan, with the exact planes of the safe cells; all others have none.
    /// Cells of one plane (normals and offsets differ by 1e-9 at most) share it.
    pub fn map(&self) -> SafetyMap {
        safety_map(self.spec.plan(), &self.labels, &self.surfaces)
    }
}

fn nearest_cell(spec: &GridSpec, point_m: [f64; 2]) -> usize {
    let [x, y, _] = spec.to_cells([point_m[0], point_m[1], 0.0]);
    let [nx, ny, _] = spec.shape();
    // A cast from float to integer stops at 0.
    (x as usize).min(nx - 1) * ny + (y as usize).min(ny - 1)
}

fn examine(probe: &Probe, spec: &GridSpec, cell: [usize; 2], rules: &SafetyRules) -> Examined {
    let surface = match probe.column(cell_point(spec, cell, [0.5, 0.5])) {
        GroundColumn::Empty => return Examined::Nothing,
        GroundColumn::Filled { .. } => return Examined::Obstacle,
        GroundColumn::Surface(found) => found.surface(),
    };
    let place = |index: usize| (index as f64 + 0.5) / PLACES as f64;
    let is_flat = (0..PLACES * PLACES).all(|index| {
        let at = [place(index / PLACES), place(index % PLACES)];
        let plane_m = surface.height_at(at.map(|share| (share - 0.5) * spec.cell_size_m()));
        match probe.column(cell_point(spec, cell, at)) {
            GroundColumn::Surface(there) => (there.height_m - plane_m).abs() <= rules.max_step_m,
            GroundColumn::Empty | GroundColumn::Filled { .. } => false,
        }
    });
    if is_flat { Examined::Ground(surface) } else { Examined::Obstacle }
}

#[cfg(test)]
#[path = "safety_tests.rs"]
mod tests;
