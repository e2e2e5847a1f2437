use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::{Layer, PlanGrid, PlanSpec};
use evigrid_metrics::PlanState;
use nalgebra::Isometry2;
use rerun::blueprint::components::Eye3DKind;
use rerun::components::{ImageFormat, Radius};
use rerun::external::re_sdk_types::blueprint::archetypes::{EyeControls3D, LineGrid3D};
use rerun::{Arrows3D, ChannelDatatype, Color, ColorModel, GridMap};

use crate::blueprint::Pane;
use crate::layout::dark;
use crate::part::{Out, Part, Shown, Slot, Start};
use crate::trajectory::TRAJECTORY;

/// Colours of what nobody knows.
const UNKNOWN: [u8; 3] = [150, 170, 215];
/// An arrow ends where a cell is after so many seconds.
const ARROW_S: f32 = 0.5;
/// Cells get an arrow from this probability and this speed (m/s) on.
const ARROW_FROM: [f32; 2] = [0.6, 0.25];
/// Height of the plans and of the arrows over the ground, metres.
const RAISED_M: [f32; 2] = [0.02, 0.1];

/// The ground plan of one method as a map on the ground, white free to black occupied, with the velocities of its
/// cells as arrows; and what the laser of the frame says of the same place.
pub(crate) struct PlanGroundPart {
    number: usize,
    method: String,
    /// Middle of the plan after the last frame, and half its width, metres.
    middle_m: [f64; 3],
    reach_m: f64,
    has_laser: bool,
}

/// Path of the laser's plan.
const LASER: &str = "world/ground/laser";

impl PlanGroundPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        let method = start.info.methods[number].name.clone();
        Self { number, method, middle_m: [0.0; 3], reach_m: 10.0, has_laser: false }
    }

    fn path(&self) -> String {
        format!("world/ground/{}", self.method)
    }

    fn pane(&self, title: String, paths: &[String]) -> Pane {
        let [x, y, z] = self.middle_m.map(|v| v as f32);
        let above = 2.1 * self.reach_m as f32;
        let eye = EyeControls3D::new()
            .with_kind(Eye3DKind::Orbital)
            .with_position([x - 0.01, y, z + above])
            .with_look_target([x, y, z])
            .with_eye_up([1.0, 0.0, 0.0]);
        let pane = Pane::new("3D", title, "world")
            .with("EyeControls3D", eye)
            .with("Background", dark())
            .with("LineGrid3D", LineGrid3D::new().with_visible(false));
        Pane { contents: paths.iter().map(|path| format!("+ /{path}/**")).collect(), ..pane }
    }
}

impl Part for PlanGroundPart {
    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let layers = step.methods[self.number].layers;
        let Some(plan) = layers.iter().find_map(Layer::plan) else { return Ok(()) };
        let ground_m = step.truth.ground_m().unwrap_or(0.0);
        let cells: Vec<[u8; 3]> = plan.probabilities().iter().map(|p| shade(*p)).collect();
        let place = Place { spec: plan.spec(), map_from_plan: *plan.map_from_plan(), ground_m };
        out.log(self.path(), &place.grid_map(&cells))?;
        out.log(format!("{}/velocity", self.path()), &arrows(plan, ground_m as f32))?;
        let [nx, ny] = plan.spec().shape().map(|n| n as f64 * plan.spec().cell_size_m());
        let [x, y] = plan.spec().origin_m();
        let middle = plan.map_from_plan() * nalgebra::Point2::new(x + 0.5 * nx, y + 0.5 * ny);
        (self.middle_m, self.reach_m) = ([middle.x, middle.y, ground_m], 0.5 * nx.max(ny));
        if let Some(laser) = step.truth.frame_plan() {
            self.has_laser = true;
            let colour = |state: &PlanState| match state {
                PlanState::Unknown => UNKNOWN,
                PlanState::Free => [255; 3],
                PlanState::Occupied => [0; 3],
            };
            let cells: Vec<[u8; 3]> = laser.cells.iter().map(colour).collect();
            let place = Place { spec: &laser.spec, map_from_plan: Isometry2::identity(), ground_m };
            out.log(LASER, &place.grid_map(&cells))?;
        }
        Ok(())
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let title = format!("{}: black = occupied, arrows = where cells are in 0.5 s", self.method);
        let own = self.pane(title, &[self.path(), TRAJECTORY.into()]);
        let mut panes = vec![(Slot::Space, own)];
        if self.has_laser && self.number == 0 {
            let laser = self.pane("laser of the frame".into(), &[LASER.into(), TRAJECTORY.into()]);
            panes.push((Slot::Above, laser));
        }
        panes
    }
}

/// Where a plan lies.
struct Place<'a> {
    spec: &'a PlanSpec,
    map_from_plan: Isometry2<f64>,
    ground_m: f64,
}

impl Place<'_> {
    /// Colours of the cells by flat index as a map on the ground.
    fn grid_map(&self, cells: &[[u8; 3]]) -> GridMap {
        let [nx, ny] = self.spec.shape();
        let pixels: Vec<u8> =
            (0..ny).rev().flat_map(|j| (0..nx).flat_map(move |i| cells[i * ny + j])).collect();
        let corner = self.map_from_plan * nalgebra::Point2::from(self.spec.origin_m());
        let half = 0.5 * self.map_from_plan.rotation.angle();
        let format =
            ImageFormat::from_color_model([nx as u32, ny as u32], ColorModel::RGB, ChannelDatatype::U8);
        GridMap::new(pixels, format, self.spec.cell_size_m() as f32)
            .with_translation([corner.x as f32, corner.y as f32, self.ground_m as f32 + RAISED_M[0]])
            .with_quaternion([0.0, 0.0, half.sin() as f32, half.cos() as f32])
    }
}

/// White is free, black occupied.
fn shade(p: f32) -> [u8; 3] {
    if p.is_nan() { UNKNOWN } else { [(255.0 * (1.0 - p.clamp(0.0, 1.0))).round() as u8; 3] }
}

/// The velocities of occupied cells that move.
fn arrows(plan: &PlanGrid, ground_m: f32) -> Arrows3D {
    let all = plan.velocities().unwrap_or_default().iter().zip(plan.probabilities()).enumerate();
    let moving = all.filter(|(_, (v, p))| {
        let [x, y] = v.mode_mps;
        **p > ARROW_FROM[0] && x.hypot(y) > ARROW_FROM[1]
    });
    let (mut origins, mut vectors) = (Vec::new(), Vec::new());
    for (cell, (velocity, _)) in moving {
        let [x, y] = plan.centre_in_map_m(cell).map(|v| v as f32);
        let [vx, vy] = velocity.mode_mps;
        let turned = plan.map_from_plan().rotation * nalgebra::Vector2::new(f64::from(vx), f64::from(vy));
        origins.push([x, y, ground_m + RAISED_M[1]]);
        vectors.push([ARROW_S * turned.x as f32, ARROW_S * turned.y as f32, 0.0]);
    }
    Arrows3D::from_vectors(vectors)
        .with_origins(origins)
        .with_radii([Radius::new_scene_units(0.03)])
        .with_colors([Color::from_rgb(213, 94, 0)])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::CellVelocity;

    #[test]
    fn arrows_stand_on_occupied_cells_that_move() {
        let spec = PlanSpec::of_area([0.0, 3.0], [0.0, 1.0], 1.0).unwrap();
        let mut plan = PlanGrid::unknown(spec);
        plan.probabilities_mut().copy_from_slice(&[0.9, 0.9, 0.1]);
        let velocity = |x| CellVelocity { mode_mps: [x, 0.0], spread_mps: 0.0 };
        plan.set_velocities(vec![velocity(2.0), velocity(0.0), velocity(3.0)]);
        // The first cell alone, from its middle to where it is in half a second.
        let expected = Arrows3D::from_vectors([[1.0_f32, 0.0, 0.0]]).with_origins([[0.5_f32, 0.5, 0.1]]);
        let found = arrows(&plan, 0.0);
        assert_eq!((found.vectors, found.origins), (expected.vectors, expected.origins));
    }

    #[test]
    fn free_is_white_and_occupied_black() {
        assert_eq!([shade(0.0), shade(1.0), shade(f32::NAN)], [[255; 3], [0; 3], UNKNOWN]);
    }
}
