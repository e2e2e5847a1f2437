//! Height maps and views made by hand.
#![allow(dead_code, clippy::unwrap_used)]

use evigrid_core::{Disparity, Frame, GrayImage, Matching, Mounting, Pose, StereoRig, level_camera};
use evigrid_grid::{GridSettings, GridSpec, Moments, PlanSpec, SafetyMap};
use evigrid_safety_map::{Column, Columns, Robot, SafetyMapSettings, label_columns};
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// Cells of 0.1 m, 4 x 4 m around the origin.
pub fn plan() -> PlanSpec {
    PlanSpec::of_area([-2.0, 2.0], [-2.0, 2.0], 0.1).unwrap()
}

/// The robot of the hand-made maps: at the origin, on a floor at the height 0, which is the middle of layer 10.
pub const ROBOT: Robot = Robot { at_m: [0.0, 0.0], floor_m: 0.0 };

/// The layer of the floor.
pub const FLOOR: i32 = 10;

/// The columns of a surface: `height_m` by the centre of a cell; NaN: nothing is there. Layer 10 has the
/// heights from -0.05 m to 0.05 m. Every column has nine points of the surface.
pub fn surface(height_m: impl Fn([f64; 2]) -> f64) -> Columns {
    let spec = plan();
    let mut columns = Columns::none(spec);
    columns.fill(spec, ROBOT.at_m, 4.0, |flat| {
        let [x, y] = spec.centre_m(flat);
        let height = height_m([x, y]);
        if height.is_nan() {
            return None;
        }
        let mut moments = Moments::default();
        for n in 0..9 {
            let at = [x + 0.03 * f64::from(n / 3 - 1), y + 0.03 * f64::from(n % 3 - 1)];
            let there = height_m(at);
            moments.add([at[0], at[1], if (there - height).abs() < 0.04 { there } else { height }]);
        }
        Some(Column { height: (height / 0.1 + 0.5).floor() as i32 + FLOOR, moments })
    });
    columns
}

/// The safety map of such a surface.
pub fn labelled(settings: &SafetyMapSettings, height_m: impl Fn([f64; 2]) -> f64) -> SafetyMap {
    label_columns(&surface(height_m), &ROBOT, FLOOR, settings, &|_, _| false)
}

/// A small rig.
pub fn rig() -> StereoRig {
    StereoRig { width: 32, height: 24, focal_px: 20.0, centre_x_px: 15.3, centre_y_px: 11.8, baseline_m: 0.2 }
}

/// A grid of 0.1 m around the origin, 1 m over a floor.
pub fn grid() -> GridSpec {
    GridSpec::new(&GridSettings { x_m: [-1.0, 3.0], y_m: [-2.0, 2.0], z_m: [-1.5, 1.0], cell_size_m: 0.1 })
        .unwrap()
}

/// The camera 1 m over the floor.
pub const MOUNTING: Mounting = Mounting::over_middle(1.0, 0.3);

/// A camera that looks along x, turned and tilted down.
pub fn pose(at: [f64; 3], yaw: f64, tilt: f64) -> Pose {
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -tilt);
    Pose::from_parts(Vector3::from(at).into(), yaw * level_camera() * tilt)
}

/// A frame from a pose, with disparities by pixel.
pub fn frame(
    index: usize,
    map_from_left: Pose,
    disparity: impl Fn(usize, usize) -> f32,
) -> (Frame, Matching) {
    let rig = rig();
    let grey = || GrayImage::new(rig.width, rig.height, vec![0; rig.width * rig.height]).unwrap();
    let values = (0..rig.width * rig.height).map(|n| disparity(n % rig.width, n / rig.width)).collect();
    let disparity = Disparity::new(rig.width, rig.height, values).unwrap();
    let frame = Frame::new(index, 0, rig, grey(), grey(), map_from_left, None).unwrap();
    (frame, Matching::from_disparity(disparity))
}

/// The disparities of a scene that is a floor 1 m below the map frame and a wall across at `wall_x_m`.
pub fn floor_and_wall(map_from_left: Pose, wall_x_m: f64) -> impl Fn(usize, usize) -> f32 {
    let rig = rig();
    move |x, y| {
        let ray = map_from_left.rotation * rig.ray(x as f64, y as f64);
        let eye = map_from_left.translation.vector;
        let to_floor = if ray.z < 0.0 { (-1.0 - eye.z) / ray.z } else { f64::INFINITY };
        let to_wall = if ray.x > 0.0 { (wall_x_m - eye.x) / ray.x } else { f64::INFINITY };
        let depth = to_floor.min(to_wall);
        let _: Point3<f64> = (eye + ray * depth).into();
        if depth.is_finite() { rig.disparity_px(depth) as f32 } else { f32::NAN }
    }
}
