//! Small worlds for the tests of this folder.

use evigrid_core::Pose;
use evigrid_grid::{GridSettings, GridSpec};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

use crate::World;

/// The frame of tests/box.toml (a robot that starts at (1, 0.5), cameras 0.2 m to its left, 1 m per frame
/// along x, a laser without noise), with other objects and a robot of 1.2 m.
pub fn world(objects: &[String]) -> World {
    let text = include_str!("../../tests/box.toml");
    let (head, _) = text.split_once("[[object]]").unwrap();
    World::from_toml(&format!("{head}\n[robot]\nheight_m = 1.2\n{}", objects.concat())).unwrap()
}

/// An object of one shape; `rest` holds further keys.
pub fn object(shape: &str, centre_m: [f64; 3], rest: &str) -> String {
    format!(
        "\n[[object]]\nshape = {{ {shape} }}\ncentre_m = {centre_m:?}\nmaterial = \"wood\"\n{}\n",
        rest.replace("; ", "\n")
    )
}

/// A box with these lengths.
pub fn a_box(size_m: [f64; 3], centre_m: [f64; 3], rest: &str) -> String {
    object(&format!("box = {{ size_m = {size_m:?} }}"), centre_m, rest)
}

/// Shapes of all kinds that stand, overlap, abut and hide each other between (2, -3, -1) and (9, 4, 2).
pub fn mixture() -> World {
    let tetrahedron = "vertices_m = [[0, 0, 0], [1.1, 0, 0], [0.2, 1.3, 0], [0.3, 0.4, 1.2]]";
    world(&[
        a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], ""),
        a_box([1.1, 0.9, 1.3], [4.3, 1.8, 0.61], "yaw_deg = 25.0; pitch_deg = 8.0"),
        a_box([1.0, 1.0, 1.0], [6.0, 2.5, 0.5], ""),
        a_box([1.0, 1.0, 1.0], [7.0, 2.5, 0.5], ""),
        object("cylinder = { radius_m = 0.37, height_m = 1.9 }", [5.6, -1.7, 0.4], "roll_deg = 35.0"),
        object("cylinder = { radius_m = 0.08, height_m = 2.0 }", [4.2, -0.9, 1.0], ""),
        object("sphere = { radius_m = 0.55 }", [7.4, -0.2, 0.7], ""),
        object("sphere = { radius_m = 0.4 }", [7.4, 2.4, 0.9], ""),
        object(
            "ramp = { run_m = 2.0, rise_m = 0.3, width_m = 1.1, thickness_m = 0.2 }",
            [5.0, 3.3, 0.15],
            "",
        ),
        object(
            &format!("mesh = {{ {tetrahedron}, triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }}"),
            [6.6, -2.6, 0.05],
            "yaw_deg = 10.0",
        ),
        object(
            "mesh = { vertices_m = [[0, 0, 0], [1, 0.3, 0.2], [0.1, 1, 0.9]], triangles = [[0, 1, 2]] }",
            [3.0, 2.4, 0.2],
            "",
        ),
    ])
}

/// A map frame that is neither aligned with the world's axes nor with its borders.
pub fn turned_map() -> Pose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
    Pose::from_parts(Translation3::new(0.117, -0.331, -0.071), rotation)
}

/// The grid between these corners.
pub fn grid(x_m: [f64; 2], y_m: [f64; 2], z_m: [f64; 2], cell_size_m: f64) -> GridSpec {
    GridSpec::new(&GridSettings { x_m, y_m, z_m, cell_size_m }).unwrap()
}
