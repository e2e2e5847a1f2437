//! Ground plans frame by frame, against what the laser of the frame says of the cells that the camera looks at.

use evigrid_core::{Frame, Mounting};
use evigrid_grid::{GridSpec, Layer, PlanGrid, PlanSpec, projected};
use evigrid_metrics::{FrameCell, PLAN_BANDS_M, PlanTally};
use evigrid_truth::{LaserPlan, PlanBand};
use nalgebra::Vector3;

use crate::Config;

/// The laser's plan of the last frame.
#[derive(Debug)]
pub(crate) struct FramePlans {
    /// Cells around the camera, of the same lattice as the maps; moved from frame to frame.
    window: PlanSpec,
    mounting: Mounting,
    band_m: [f64; 2],
    min_range_m: f64,
    /// Levels of voxels that make up the plan of a map of voxels.
    levels: std::ops::Range<usize>,
    cells: Vec<SeenCell>,
    plan: Option<LaserPlan>,
}

/// A cell that the laser knows and the camera looks at.
#[derive(Debug, Clone, Copy)]
struct SeenCell {
    centre_m: [f64; 2],
    occupied: bool,
    beside_occupied: bool,
    range_m: f64,
}

impl FramePlans {
    /// Without a frame. `levels`: those of the grid that lie in the band.
    pub fn new(
        spec: &GridSpec,
        config: &Config,
        mounting: Mounting,
        levels: std::ops::Range<usize>,
    ) -> Option<Self> {
        let plan = spec.plan();
        let (c, [x, y]) = (plan.cell_size_m(), plan.origin_m());
        let edge_m = 2.0 * farthest_m() + c;
        let window = PlanSpec::of_area([x, x + edge_m], [y, y + edge_m], c).ok()?;
        let (band_m, min_range_m) = (config.score.plan_band_m, config.truth.min_range_m);
        Some(Self { window, mounting, band_m, min_range_m, levels, cells: Vec::new(), plan: None })
    }

    /// The next frame; one without a scan knows no cell.
    pub fn add(&mut self, frame: &Frame) {
        self.cells.clear();
        self.plan = None;
        let Some(scan) = frame.laser() else { return };
        let pose = frame.map_from_left();
        let camera = pose.translation.vector;
        let by = [camera.x, camera.y].map(|at| at - farthest_m());
        let spec = self.window.moved(self.window.to_cells(by).map(|cells| cells.floor() as i64));
        let ground_m = camera.z - self.mounting.height_m;
        let band = PlanBand { ground_m, band_m: self.band_m, min_range_m: self.min_range_m };
        let plan = LaserPlan::of(scan, spec, &band);
        let axis = pose.rotation * Vector3::z();
        let level = axis.x.hypot(axis.y);
        let (c, s) = (axis.x / level, axis.y / level);
        let rig = frame.rig();
        for flat in (0..spec.cell_count()).filter(|&flat| plan.occupied()[flat] || plan.free()[flat]) {
            let centre_m = spec.centre_m(flat);
            let [dx, dy] = [centre_m[0] - camera.x, centre_m[1] - camera.y];
            let (ahead, right) = (c * dx + s * dy, s * dx - c * dy);
            let column = rig.centre_x_px + rig.focal_px * right / ahead;
            if ahead > 0.0 && column >= -0.5 && column <= rig.width as f64 - 0.5 {
                let beside_occupied = has_occupied_neighbour(&spec, plan.occupied(), flat);
                let (occupied, range_m) = (plan.occupied()[flat], dx.hypot(dy));
                self.cells.push(SeenCell { centre_m, occupied, beside_occupied, range_m });
            }
        }
        self.plan = Some(plan);
    }

    /// What the laser of the last frame says; `None` if it had no scan.
    pub fn laser(&self) -> Option<&LaserPlan> {
        self.plan.as_ref()
    }

    /// Counts the plan of a map, or the projection of its voxels.
    pub fn count(&self, layers: &[Layer<'_>], tally: &mut Option<PlanTally>) {
        if self.cells.is_empty() {
            return;
        }
        let own = layers.iter().find_map(Layer::plan);
        let of_voxels =
            || layers.iter().find_map(Layer::voxels).map(|map| projected(map, self.levels.clone()));
        let made = if own.is_none() { of_voxels() } else { None };
        if let Some(plan) = own.or(made.as_ref()) {
            let cells = self.cells.iter().map(|cell| FrameCell {
                probability: probability(plan, cell.centre_m),
                occupied: cell.occupied,
                beside_occupied: cell.beside_occupied,
                range_m: cell.range_m,
            });
            tally.get_or_insert_with(PlanTally::default).add(cells);
        }
    }
}

/// P(occupied) at a place of the map; 0.5 where the plan knows nothing.
fn probability(plan: &PlanGrid, at_m: [f64; 2]) -> f32 {
    let place = plan.map_from_plan().inverse_transform_point(&at_m.into());
    let known = plan.spec().cell_of(place.into()).map(|cell| plan.probabilities()[cell]);
    known.filter(|p| !p.is_nan()).unwrap_or(0.5)
}

fn farthest_m() -> f64 {
    PLAN_BANDS_M[PLAN_BANDS_M.len() - 1]
}

fn has_occupied_neighbour(spec: &PlanSpec, occupied: &[bool], flat: usize) -> bool {
    let [i, j] = spec.cell(flat).map(|index| index as i64);
    let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
    around.filter(|cell| *cell != [i, j]).any(|cell| spec.flat(cell).is_some_and(|other| occupied[other]))
}
