//! The 3-D model of a safety map as a polygon file (PLY) that any viewer of meshes opens.

use std::io::Write;

use anyhow::{Context, Result};
use evigrid_grid::{HybridModel, SafetyLabel, SafetyMap, outer_faces, patches};

use crate::label_colours::{label_rgb, voxel_rgb};
use crate::{PendingFile, SealedFile};

/// A quadrangle of one colour.
struct Face {
    corners_m: [[f64; 3]; 4],
    rgb: [u8; 3],
}

/// Writes safe ground as quadrangles, one per cell, and the voxels as cubes, in a binary little-endian PLY:
/// vertices with x, y, z float32 (metres, map frame: x forward, y left, z up) and red, green, blue uint8; faces
/// of four vertices each, counter-clockwise as seen from above or outside. Faces between two voxels are left out.
/// A voxel has the colour of its column's label.
///
/// # Errors
/// If the file cannot be written.
pub fn write_model(mut file: PendingFile, map: &SafetyMap, model: &HybridModel) -> Result<SealedFile> {
    let bytes = encode(&faces(map, model));
    file.write_all(&bytes).with_context(|| file.failed())?;
    file.seal()
}

/// Ground first, then voxels.
fn faces(map: &SafetyMap, model: &HybridModel) -> Vec<Face> {
    let ground = patches(map).into_iter().map(|p| Face { corners_m: p.corners_m, rgb: label_rgb(p.label) });
    let layers = model.spec.shape()[2];
    let rgb = |number: usize| {
        let column = model.voxels[number] as usize / layers;
        voxel_rgb(map.labels().get(column).copied().unwrap_or(SafetyLabel::Unexamined))
    };
    let sides = outer_faces(&model.spec, &model.voxels).into_iter();
    ground.chain(sides.map(|(number, corners_m)| Face { corners_m, rgb: rgb(number) })).collect()
}

fn encode(faces: &[Face]) -> Vec<u8> {
    let mut bytes = header(4 * faces.len(), faces.len()).into_bytes();
    for face in faces {
        for corner in face.corners_m {
            corner.iter().for_each(|v| bytes.extend((*v as f32).to_le_bytes()));
            bytes.extend(face.rgb);
        }
    }
    for number in 0..faces.len() as i32 {
        bytes.push(4);
        (4 * number..4 * number + 4).for_each(|vertex| bytes.extend(vertex.to_le_bytes()));
    }
    bytes
}

fn header(vertices: usize, faces: usize) -> String {
    let floats = ["x", "y", "z"].map(|name| format!("property float {name}\n")).concat();
    let colours = ["red", "green", "blue"].map(|name| format!("property uchar {name}\n")).concat();
    format!(
        "ply\nformat binary_little_endian 1.0\n{}element vertex {vertices}\n{floats}{colours}\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n",
        comments()
    )
}

/// Frame and legend.
fn comments() -> String {
    let colour = |[r, g, b]: [u8; 3]| format!("{r} {g} {b}");
    let ground = |label| format!("colour {} = ground, {}", colour(label_rgb(label)), label.name());
    let voxel =
        |label| format!("colour {} = voxel in a cell that is {}", colour(voxel_rgb(label)), label.name());
    let lines = [
        "map frame, metres: x forward, y left, z up".to_owned(),
        ground(SafetyLabel::Level),
        ground(SafetyLabel::Inclined),
        voxel(SafetyLabel::NonGround),
        voxel(SafetyLabel::Unknown),
        format!("colour {} = voxel over safe ground", colour(voxel_rgb(SafetyLabel::Level))),
    ];
    lines.map(|line| format!("comment {line}\n")).concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::{GridSettings, GridSpec, SafetyPlane};
    use nalgebra::Vector3;

    /// Three cells forward from x = 5, two to the left from y = -3, two layers up from z = -1.
    fn spec() -> GridSpec {
        let settings =
            GridSettings { x_m: [5.0, 6.5], y_m: [-3.0, -2.0], z_m: [-1.0, 0.0], cell_size_m: 0.5 };
        GridSpec::new(&settings).unwrap()
    }

    /// A ramp z = 0.2 x - 0.1 y - 1 in the rear, level on the right and inclined on the left by name; in the
    /// middle on the right an unsafe cell of two voxels, and a voxel over the level cell.
    fn model() -> (SafetyMap, HybridModel) {
        let mut map = SafetyMap::unknown(spec().plan());
        let normal = Vector3::new(-0.2, 0.1, 1.0);
        let plane = SafetyPlane { normal: normal.normalize(), offset_m: -1.0 / normal.norm() };
        let ramp = map.add_plane(plane);
        map.set(0, SafetyLabel::Level, Some(ramp));
        map.set(1, SafetyLabel::Inclined, Some(ramp));
        map.set(2, SafetyLabel::NonGround, None);
        let voxels = [[0, 0, 1], [1, 0, 0], [1, 0, 1]].map(|v| spec().flat(v).unwrap() as u32);
        let (robot_m, robot_height_m) = ([5.0, -2.5, -1.0], 1.0);
        (map, HybridModel { spec: spec(), voxels: voxels.to_vec(), robot_m, robot_height_m })
    }

    /// The header's lines, then vertices and faces by its own counts.
    #[allow(clippy::type_complexity)]
    fn parse(bytes: &[u8]) -> (Vec<String>, Vec<([f32; 3], [u8; 3])>, Vec<Vec<i32>>) {
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let lines: Vec<String> =
            std::str::from_utf8(&bytes[..at]).unwrap().lines().map(str::to_owned).collect();
        let count = |element: &str| -> usize {
            lines.iter().find_map(|l| l.strip_prefix(element)).unwrap().parse().unwrap()
        };
        let (vertices, faces) = bytes[at..].split_at(15 * count("element vertex "));
        let word = |bytes: &[u8]| -> [u8; 4] { bytes.try_into().unwrap() };
        let vertex = |v: &[u8]| {
            let at = [0, 4, 8].map(|i| f32::from_le_bytes(word(&v[i..i + 4])));
            (at, [v[12], v[13], v[14]])
        };
        let face = |f: &[u8]| {
            assert_eq!(f[0], 4);
            f[1..].chunks_exact(4).map(|i| i32::from_le_bytes(word(i))).collect()
        };
        assert_eq!(faces.len(), 17 * count("element face "));
        let vertices = vertices.chunks_exact(15).map(vertex).collect();
        (lines, vertices, faces.chunks_exact(17).map(face).collect())
    }

    fn written() -> Vec<u8> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("model.ply");
        let (map, model) = model();
        write_model(PendingFile::create(path.clone()).unwrap(), &map, &model).unwrap().publish().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn the_header_tells_what_follows() {
        let (lines, vertices, faces) = parse(&written());
        // Two patches; three voxels in an L have 18 sides, of which four touch each other.
        assert_eq!((vertices.len(), faces.len()), (4 * 16, 16));
        let (comments, lines): (Vec<_>, Vec<_>) = lines.into_iter().partition(|l| l.starts_with("comment "));
        let expected = "ply|format binary_little_endian 1.0|element vertex 64|property float x|property float y|\
            property float z|property uchar red|property uchar green|property uchar blue|element face 16|\
            property list uchar int vertex_indices|end_header";
        assert_eq!(lines.join("|"), expected);
        for label in [SafetyLabel::Level, SafetyLabel::Inclined, SafetyLabel::NonGround, SafetyLabel::Unknown]
        {
            assert!(comments.iter().any(|line| line.ends_with(label.name())), "{label:?}");
        }
        for (number, face) in faces.into_iter().enumerate() {
            let first = 4 * number as i32;
            assert_eq!(face, [first, first + 1, first + 2, first + 3]);
        }
    }

    #[test]
    fn ground_lies_on_its_plane_in_the_colour_of_its_label() {
        let (_, vertices, _) = parse(&written());
        let places = [[5.0, -3.0], [5.5, -3.0], [5.5, -2.5], [5.0, -2.5]];
        for (number, label) in [SafetyLabel::Level, SafetyLabel::Inclined].into_iter().enumerate() {
            for (([x, y, z], rgb), place) in vertices[4 * number..4 * number + 4].iter().zip(places) {
                let [to_x, to_y] = [place[0], place[1] + 0.5 * number as f32];
                assert_eq!(([*x, *y], *rgb), ([to_x, to_y], label_rgb(label)));
                assert!((z - (0.2 * to_x - 0.1 * to_y - 1.0)).abs() < 1e-6, "{z}");
            }
        }
    }

    #[test]
    fn voxels_are_cubes_in_the_colour_of_their_column() {
        let (_, vertices, _) = parse(&written());
        let range = |rgb: [u8; 3], axis: usize| {
            let values = vertices.iter().filter(|v| v.1 == rgb).map(|v| v.0[axis]);
            values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
        };
        let unsafe_rgb = voxel_rgb(SafetyLabel::NonGround);
        assert_eq!([0, 1, 2].map(|a| range(unsafe_rgb, a)), [[5.5, 6.0], [-3.0, -2.5], [-1.0, 0.0]]);
        let over_ground = voxel_rgb(SafetyLabel::Level);
        assert_eq!([0, 1, 2].map(|a| range(over_ground, a)), [[5.0, 5.5], [-3.0, -2.5], [-0.5, 0.0]]);
        let count = |rgb| vertices.iter().filter(|v| v.1 == rgb).count();
        assert_eq!((count(unsafe_rgb), count(over_ground)), (4 * 9, 4 * 5));
    }
}
