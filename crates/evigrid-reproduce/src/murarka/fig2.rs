//! Fig. 2: the 3-D model, in the middle of a drive and at its end, beside what the camera sees there (Fig. 1).

use anyhow::Result;
use evigrid_safety_map::Model;
use evigrid_synth::World;

use super::drive::{FRAME, Heights, Sight, WORLD, config, drive, height_colour};
use super::plan_view::{panel, patches, robot_series};
use crate::chart::{Panel, Sheet};
use crate::image_view::{PANEL, disparity_panel, grey_panel};
use crate::job::Job;
use crate::recording::record;
use crate::table::rounded;

/// Heights that are told apart, metres.
const HEIGHTS: Heights = Heights([-0.6, 1.2]);
/// Width over height of what a panel of [`PANEL`] shows, without axes and title.
const IMAGE_SHAPE: f64 = 341.0 / 265.0;
/// Disparity that is drawn brightest, pixels.
const MOST_PX: f64 = 48.0;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let world = World::builtin(WORLD)?;
    let (mut panels, mut rows) = (Vec::new(), Vec::new());
    drive(job, &[FRAME, world.frame_count() - 1], &mut |sight| {
        let heights = heights_m(sight)?;
        rows.extend(rows_of(sight, &heights)?);
        panels.extend(panels_of(sight, &heights)?);
        Ok(())
    })?;
    job.write_table(&["frame", "x_m", "y_m", "height_over_floor_m", "points"], rows)?;
    let sheet = Sheet {
        title: format!("The 3-D model of {WORLD} (Murarka and Kuipers 2009, Figs 1 and 2)"),
        notes: vec![
            "right: height of the highest occupied voxel of each column that is lower than the robot (1.3 m); \
             white: none"
                .into(),
            "disparities: the nearer the brighter, white: none. The circle is the planning radius of 4 m".into(),
        ],
        columns: 3,
        panel: PANEL,
        panels,
    };
    job.write_keyed_picture(&sheet, &HEIGHTS.key())?;
    let mut config = config(&world)?;
    config.run.dataset = format!("synth:{WORLD}");
    config.run.frames = format!("0..{}", FRAME + 1);
    record(job, config)
}

/// For each column the height of its highest occupied voxel below the robot's, over the robot's floor, metres.
fn heights_m(sight: &Sight<'_>) -> Result<Vec<Option<f64>>> {
    let (model, floor_m) = (sight.model()?, sight.floor_m);
    let robot_m = sight.hybrid()?.robot_height_m;
    let [nx, ny, _] = model.spec().shape();
    let height = |column| highest(model, column, floor_m + robot_m).map(|centre_m| centre_m - floor_m);
    Ok((0..nx * ny).map(height).collect())
}

/// Height of the centre of the highest occupied voxel of a column whose centre is below a height, metres.
fn highest(model: &Model, column: usize, below_m: f64) -> Option<f64> {
    let layers = model.spec().shape()[2];
    let voxels = (column * layers..(column + 1) * layers).rev().filter(|&flat| model.is_occupied(flat));
    voxels.map(|flat| model.spec().centre_m(flat)[2]).find(|&centre_m| centre_m < below_m)
}

/// The columns with their points, the 3-D point cloud's share of them.
fn rows_of(sight: &Sight<'_>, heights_m: &[Option<f64>]) -> Result<Vec<[String; 5]>> {
    let model = sight.model()?;
    let (plan, layers) = (model.spec().plan(), model.spec().shape()[2]);
    let points = |column: usize| -> usize {
        let occupied = (column * layers..(column + 1) * layers).filter(|&flat| model.is_occupied(flat));
        occupied.map(|flat| model.points(flat).count()).sum()
    };
    let row = |(column, height_m): (usize, &Option<f64>)| {
        let [x, y] = plan.centre_m(column).map(|v| rounded(v, 2));
        let points = points(column).to_string();
        Some([sight.frame.index().to_string(), x, y, rounded((*height_m)?, 2), points])
    };
    Ok(heights_m.iter().enumerate().filter_map(row).collect())
}

fn panels_of(sight: &Sight<'_>, heights_m: &[Option<f64>]) -> Result<[Panel; 3]> {
    let (frame, number) = (sight.frame, sight.frame.index());
    let size = [frame.rig().width, frame.rig().height];
    let left = grey_panel(&format!("left image, frame {number}"), size, |x, y| frame.left().row(y)[x]);
    let values = sight.matching.matches.disparity.values();
    let disparity = disparity_panel("disparities, multi-scale matching", size, MOST_PX, values);
    let plan = sight.model()?.spec().plan();
    let ny = plan.shape()[1];
    let mut series =
        patches(&plan).shaded(|i, j| heights_m[i * ny + j].map(|h| HEIGHTS.share(h)), height_colour);
    series.extend(robot_series(&sight.robot));
    let model = widened(panel(format!("3-D model after {} frames", number + 1), &plan, series));
    Ok([left, disparity, model])
}

/// A panel of a square map with room on its sides, so that a metre is as long along both axes in a panel that has
/// the shape of an image.
fn widened(mut panel: Panel) -> Panel {
    let [from, to] = panel.x.range;
    let room = 0.5 * (IMAGE_SHAPE - 1.0) * (to - from);
    panel.x.range = [from - room, to + room];
    panel
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::{Pose, StereoRig, level_camera};
    use evigrid_grid::{GridSettings, GridSpec};
    use evigrid_safety_map::SafetyMapSettings;

    /// One pixel sees a point 2 m ahead on the level of the camera: nothing below 0, that voxel below 1 m.
    #[test]
    fn the_highest_voxel_is_that_below_the_limit() {
        let grid = GridSettings { x_m: [0.0, 4.0], y_m: [-1.0, 1.0], z_m: [-1.05, 0.95], cell_size_m: 0.1 };
        let settings = SafetyMapSettings { occupied_at: 10, ..SafetyMapSettings::default() };
        let mut model = Model::new(GridSpec::new(&grid).unwrap(), settings);
        let rig = StereoRig {
            width: 3,
            height: 1,
            focal_px: 100.0,
            centre_x_px: 1.0,
            centre_y_px: 0.0,
            baseline_m: 0.2,
        };
        let pose = Pose::from_parts(nalgebra::Vector3::new(0.0, 0.03, 0.02).into(), level_camera());
        model.update(&rig, &pose, &[f32::NAN, 9.8, f32::NAN]);
        let ahead_m = 100.0 * 0.2 / f64::from(9.8_f32);
        let column = model.spec().plan().cell_of([ahead_m, 0.03]).unwrap();
        // The layer of z = 0.02 reaches from -0.05 to 0.05.
        assert!(highest(&model, column, 1.0).unwrap().abs() < 1e-9);
        assert_eq!(highest(&model, column, 0.0), None);
        assert_eq!(highest(&model, column + 1, 1.0), None);
    }
}
