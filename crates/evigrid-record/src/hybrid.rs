use anyhow::Result;
use evigrid_core::Pose;
use evigrid_eval::Step;
use evigrid_grid::{HybridModel, Layer, SafetyLabel, SafetyMap, merged_patches};
use evigrid_results::{label_rgb, voxel_rgb};
use nalgebra::Vector3;
use rerun::blueprint::components::Eye3DKind;
use rerun::components::Radius;
use rerun::external::re_sdk_types::blueprint::archetypes::{EyeControls3D, LineGrid3D};
use rerun::{Arrows3D, Color, Mesh3D, Transform3D, VoxelGridMap};

use crate::blueprint::Pane;
use crate::layout::dark;
use crate::part::{Out, Part, Shown, Slot, Start};
use crate::safety::LEGEND;
use crate::trajectory::TRAJECTORY;

/// Length of the arrow that shows where the robot looks, metres.
const HEADING_M: f64 = 0.8;

/// The groups of voxels, each of one colour: entity and the label of the columns.
const GROUPS: [(&str, SafetyLabel); 3] = [
    ("non_ground", SafetyLabel::NonGround),
    ("unknown", SafetyLabel::Unknown),
    ("over_safe_ground", SafetyLabel::Level),
];

/// The 3-D model behind the safety map of one method: safe ground as a mesh, everything else as voxels, and the
/// robot as two arrows from its floor, ahead and up to its height.
pub(crate) struct HybridPart {
    number: usize,
    method: String,
    cell_size_m: f64,
    /// What was written last.
    model: Option<HybridModel>,
    /// Where the robot looks, in the plane.
    ahead: Vector3<f64>,
}

impl HybridPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        let method = start.info.methods[number].name.clone();
        let cell_size_m = start.info.spec.cell_size_m();
        Self { number, method, cell_size_m, model: None, ahead: Vector3::x() }
    }

    fn path(&self, what: &str) -> String {
        format!("world/hybrid/{}/{what}", self.method)
    }

    fn write_voxels(&self, out: &mut Out<'_>, map: &SafetyMap, model: &HybridModel) -> Result<()> {
        let corner = model.spec.origin_m().map(|v| v as f32);
        out.log(self.path("voxels"), &Transform3D::from_translation(corner))?;
        for (group, voxels) in GROUPS.iter().zip(grouped(map, model)) {
            let path = self.path(&format!("voxels/{}", group.0));
            out.log(path, &VoxelGridMap::update_fields().with_voxel_indices(voxels))?;
        }
        Ok(())
    }

    fn write_robot(&self, out: &mut Out<'_>, model: &HybridModel) -> Result<()> {
        let up = Vector3::new(0.0, 0.0, model.robot_height_m);
        let arrows = [self.ahead * HEADING_M, up].map(|v| <[f64; 3]>::from(v).map(|v| v as f32));
        let floor = model.robot_m.map(|v| v as f32);
        let robot = Arrows3D::from_vectors(arrows)
            .with_origins([floor; 2])
            .with_radii([Radius::new_scene_units(0.03)])
            .with_colors([Color::from_rgb(240, 228, 66)]);
        out.log(self.path("robot"), &robot)
    }
}

impl Part for HybridPart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let size = [self.cell_size_m as f32; 3];
        for (name, label) in GROUPS {
            let [r, g, b] = voxel_rgb(label);
            let look = VoxelGridMap::update_fields().with_voxel_size(size);
            let path = self.path(&format!("voxels/{name}"));
            out.always(path, &look.with_colors([Color::from_rgb(r, g, b)]))?;
        }
        Ok(())
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let method = &step.methods[self.number];
        let Some(map) = method.layers.iter().find_map(Layer::safety) else { return Ok(()) };
        let model = method.hybrid.get();
        if model.is_some() && model == self.model {
            return Ok(());
        }
        out.log(self.path("ground"), &ground(map))?;
        self.ahead = ahead(step.frame.map_from_left()).unwrap_or(self.ahead);
        if let Some(model) = &model {
            self.write_voxels(out, map, model)?;
            self.write_robot(out, model)?;
        }
        self.model = model;
        Ok(())
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let robot = Vector3::from(self.model.as_ref().map_or([0.0; 3], |model| model.robot_m));
        let place = |v: Vector3<f64>| <[f64; 3]>::from(v).map(|v| v as f32);
        let eye = EyeControls3D::new()
            .with_kind(Eye3DKind::Orbital)
            .with_position(place(robot - self.ahead * 4.5 + Vector3::z() * 4.5))
            .with_look_target(place(robot + self.ahead * 0.8))
            .with_eye_up([0.0, 0.0, 1.0]);
        let title = format!("{} in 3-D: {LEGEND}, white = too high to matter", self.method);
        let paths = [format!("world/hybrid/{}", self.method), TRAJECTORY.into()];
        let pane = Pane::new("3D", title, "world")
            .with("EyeControls3D", eye)
            .with("Background", dark())
            .with("LineGrid3D", LineGrid3D::new().with_visible(false));
        vec![(Slot::Space, Pane { contents: paths.map(|path| format!("+ /{path}/**")).to_vec(), ..pane })]
    }
}

/// Where a camera looks, seen from above; `None` if it looks straight up or down.
fn ahead(map_from_left: &Pose) -> Option<Vector3<f64>> {
    let forward = map_from_left.rotation * Vector3::z();
    Vector3::new(forward.x, forward.y, 0.0).try_normalize(1e-6)
}

/// Safe ground as a mesh of two triangles per patch; an empty one clears what was there.
fn ground(map: &SafetyMap) -> Mesh3D {
    let patches = merged_patches(map);
    if patches.is_empty() {
        return Mesh3D::clear_fields();
    }
    let corners = patches.iter().flat_map(|p| p.corners_m.map(|corner| corner.map(|v| v as f32)));
    let colours = patches.iter().flat_map(|p| {
        let [r, g, b] = label_rgb(p.label);
        [Color::from_rgb(r, g, b); 4]
    });
    let triangles =
        (0..patches.len() as u32).flat_map(|n| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| 4 * n + v)));
    Mesh3D::new(corners).with_vertex_colors(colours).with_triangle_indices(triangles)
}

/// The voxels of each group, as indices on the grid.
fn grouped(map: &SafetyMap, model: &HybridModel) -> [Vec<[i32; 3]>; 3] {
    let mut groups: [Vec<[i32; 3]>; 3] = Default::default();
    let layers = model.spec.shape()[2];
    for flat in model.voxels.iter().map(|&flat| flat as usize) {
        let group = match map.labels().get(flat / layers) {
            Some(SafetyLabel::NonGround) => 0,
            Some(SafetyLabel::Level | SafetyLabel::Inclined) => 2,
            _ => 1,
        };
        groups[group].push(model.spec.voxel(flat).map(|v| v as i32));
    }
    groups
}
