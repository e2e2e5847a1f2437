//! Fig. 4: the safety map, and the hybrid model of planes where the ground is safe and voxels elsewhere.

use anyhow::{Context, Result};
use evigrid_grid::{HybridModel, Patch, SafetyLabel, SafetyMap, merged_patches, patches};
use evigrid_results::voxel_rgb;
use plotters::prelude::RGBColor;

use super::drive::{FRAME, WORLD, drive};
use super::plan_view::{self, colour, label_key, label_series, panel, robot_series};
use crate::chart::{Axis, Marks, Panel, Series, Sheet};
use crate::cubes::{Corner, Slant, faces};
use crate::job::Job;
use crate::journey::RobotAt;
use crate::table::rounded;

/// How a metre ahead is drawn in the slanted view, to the right and up.
const SLANT: Slant = Slant([0.45, 0.5]);
const EDGE: RGBColor = RGBColor(0, 0, 0);

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut seen = None;
    drive(job, &[FRAME], &mut |sight| {
        let hybrid = sight.hybrid()?;
        seen = Some((sight.mapper.map().clone(), hybrid, sight.robot));
        Ok(())
    })?;
    let (map, hybrid, robot) = seen.context("a drive without frames")?;
    let header = ["x_m", "y_m", "label", "drop_off_edge", "height_m", "normal_x", "normal_y", "normal_z"];
    job.write_table(&header, rows(&map, hybrid.robot_m[2]))?;
    let mut key = label_key();
    key.push(("potential drop-off edge".into(), EDGE));
    let sheet = Sheet {
        title: format!("Safety map and hybrid model, {WORLD}, frame {FRAME} (Murarka and Kuipers 2009, Fig. 4)"),
        notes: vec![
            "left: from above, the robot with its planning radius of 4 m; right: planes of safe ground and voxels \
             elsewhere, seen from behind; what is higher than the robot is left out"
                .into(),
        ],
        columns: 2,
        panel: (760, 740),
        panels: vec![map_panel(&map, &robot), model_panel(&map, &hybrid)],
    };
    job.write_keyed_picture(&sheet, &key)
}

/// The examined cells; heights are those of safe planes over the robot's floor, normals those of inclined cells.
fn rows(map: &SafetyMap, floor_m: f64) -> Vec<[String; 8]> {
    let row = |(cell, &label): (usize, &SafetyLabel)| {
        let at_m = map.spec().centre_m(cell);
        let plane = map.plane_of(cell).filter(|_| label.is_safe() == Some(true));
        let height_m = plane.and_then(|plane| plane.height_m(at_m)).map_or(f64::NAN, |z| z - floor_m);
        let normal = plane.filter(|_| label == SafetyLabel::Inclined);
        let normal = normal.map_or([f64::NAN; 3], |plane| plane.normal.into());
        let [x, y] = at_m.map(|v| rounded(v, 2));
        let [nx, ny, nz] = normal.map(|v| rounded(v, 4));
        let edge = map.drop_offs()[cell].to_string();
        [x, y, label.name().to_owned(), edge, rounded(height_m, 3), nx, ny, nz]
    };
    let examined = map.labels().iter().enumerate().filter(|(_, label)| **label != SafetyLabel::Unexamined);
    examined.map(row).collect()
}

fn map_panel(map: &SafetyMap, robot: &RobotAt) -> Panel {
    let ny = map.spec().shape()[1];
    let edges = plan_view::patches(map.spec()).areas(|i, j| map.drop_offs()[i * ny + j]);
    let mut series = label_series(map);
    series.push(Series::new("", EDGE, Marks::Areas(edges.clone())));
    series.extend(robot_series(robot));
    panel(format!("safety map: {}", counts(map)), map.spec(), series)
}

fn counts(map: &SafetyMap) -> String {
    let count = |label| map.labels().iter().filter(|own| **own == label).count();
    let edges = map.drop_offs().iter().filter(|edge| **edge).count();
    let [level, inclined, unsafe_, unknown] =
        [SafetyLabel::Level, SafetyLabel::Inclined, SafetyLabel::NonGround, SafetyLabel::Unknown].map(count);
    format!("level {level}, inclined {inclined}, non-ground {unsafe_}, unknown {unknown}; {edges} edges")
}

/// The slanted view, row by row of cells from the farthest on: what is near covers what is far.
fn model_panel(map: &SafetyMap, hybrid: &HybridModel) -> Panel {
    let (spec, ground) = (map.spec(), patches(map));
    let c = spec.cell_size_m();
    let mut series = Vec::new();
    for row in (0..spec.shape()[0]).rev() {
        let x = spec.origin_m()[0] + row as f64 * c;
        let here = ground.iter().filter(|patch| (patch.corners_m[0][0] - x).abs() < 0.5 * c);
        series.extend(here.map(patch_series));
        for (label, corners) in voxels_of_row(map, hybrid, row) {
            let [r, g, b] = voxel_rgb(label);
            series.extend(faces(SLANT, &corners, c, RGBColor(r, g, b)));
        }
    }
    let places: Vec<_> = corners(map, hybrid).into_iter().map(|corner| SLANT.place(corner)).collect();
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = || places.iter().map(of);
        [values().fold(f64::INFINITY, f64::min) - 0.2, values().fold(f64::NEG_INFINITY, f64::max) + 0.2]
    };
    let ([x0, x1], [y0, y1]) = (range(|p| p.0), range(|p| p.1));
    Panel {
        title: format!(
            "hybrid model: {} patches of planes, {} voxels",
            merged_patches(map).len(),
            hybrid.voxels.len()
        ),
        x: Axis::new("metres to the right, and 0.45 of the metres ahead", x0, x1),
        y: Axis::new("metres up, and half of the metres ahead", y0, y1),
        series,
        legend: None,
    }
}

fn patch_series(patch: &Patch) -> Series {
    let outline = patch.corners_m.map(|corner| SLANT.place(corner)).to_vec();
    Series::new("", colour(patch.label), Marks::Areas(vec![outline]))
}

/// The voxels over one row of cells that are no higher than the robot, by the label of their column: lower corners,
/// from left to right and from below.
fn voxels_of_row(map: &SafetyMap, hybrid: &HybridModel, row: usize) -> Vec<(SafetyLabel, Vec<Corner>)> {
    let top_m = hybrid.robot_m[2] + hybrid.robot_height_m;
    let spec = &hybrid.spec;
    let corner = |flat: u32| spec.centre_m(flat as usize).map(|v| v - 0.5 * spec.cell_size_m());
    let here = hybrid
        .voxels
        .iter()
        .copied()
        .filter(|&flat| spec.voxel(flat as usize)[0] == row && spec.centre_m(flat as usize)[2] < top_m);
    let mut labelled: Vec<(SafetyLabel, Corner)> =
        here.map(|flat| (map.labels()[flat as usize / spec.shape()[2]], corner(flat))).collect();
    labelled.sort_by_key(|(label, _)| *label);
    let same = |a: &(SafetyLabel, Corner), b: &(SafetyLabel, Corner)| a.0 == b.0;
    labelled.chunk_by(same).map(|chunk| (chunk[0].0, chunk.iter().map(|own| own.1).collect())).collect()
}

/// Corners of all that is drawn.
fn corners(map: &SafetyMap, hybrid: &HybridModel) -> Vec<Corner> {
    let rows = (0..map.spec().shape()[0]).flat_map(|row| voxels_of_row(map, hybrid, row));
    let voxels = rows.flat_map(|(_, corners)| corners);
    patches(map).iter().flat_map(|patch| patch.corners_m).chain(voxels).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::{GridSettings, GridSpec, PlanSpec, SafetyPlane};
    use nalgebra::Vector3;

    fn map() -> SafetyMap {
        let mut map =
            SafetyMap::of(PlanSpec::of_area([0.0, 2.0], [0.0, 2.0], 1.0).unwrap(), SafetyLabel::Unexamined);
        let normal = Vector3::new(-0.1, 0.0, 1.0);
        let ramp = SafetyPlane { normal: normal.normalize(), offset_m: -1.0 / normal.norm() };
        let ramp = map.add_plane(ramp);
        map.set(0, SafetyLabel::Inclined, Some(ramp));
        map.set(1, SafetyLabel::NonGround, Some(ramp));
        map.set(2, SafetyLabel::Unknown, None);
        map.mark_drop_off(0);
        map
    }

    /// The ramp z = 0.1 x - 1 is 0.05 m over a floor at -1 in the middle of the first cell.
    #[test]
    fn rows_by_hand() {
        let rows = rows(&map(), -1.0);
        assert_eq!(rows[0], ["0.50", "0.50", "inclined", "true", "0.050", "-0.0995", "0.0000", "0.9950"]);
        assert_eq!(rows[1], ["0.50", "1.50", "non_ground", "false", "", "", "", ""]);
        assert_eq!(rows.len(), 3);
        assert_eq!(counts(&map()), "level 0, inclined 1, non-ground 1, unknown 1; 1 edges");
    }

    #[test]
    fn voxels_as_high_as_the_robot_are_left_out() {
        let grid = GridSettings { x_m: [0.0, 2.0], y_m: [0.0, 2.0], z_m: [-1.0, 2.0], cell_size_m: 1.0 };
        let spec = GridSpec::new(&grid).unwrap();
        let at = |voxel| spec.flat(voxel).unwrap() as u32;
        // Centres at -0.5, 0.5 and 1.5; the robot ends at 1.
        let voxels = vec![at([0, 0, 2]), at([0, 1, 0]), at([0, 1, 1]), at([0, 1, 2]), at([1, 0, 0])];
        let hybrid = HybridModel { spec, voxels, robot_m: [0.0, 0.0, -1.0], robot_height_m: 2.0 };
        let first = voxels_of_row(&map(), &hybrid, 0);
        assert_eq!(first, [(SafetyLabel::NonGround, vec![[0.0, 1.0, -1.0], [0.0, 1.0, 0.0]])]);
        assert_eq!(voxels_of_row(&map(), &hybrid, 1), [(SafetyLabel::Unknown, vec![[1.0, 0.0, -1.0]])]);
    }
}
