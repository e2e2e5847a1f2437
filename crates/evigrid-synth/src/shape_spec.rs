//! Shapes as a world describes them.

use std::path::Path;
use std::sync::Arc;

use evigrid_core::Pose;
use nalgebra::{Translation3, Vector3};
use serde::Deserialize;

use crate::angle;
use crate::mesh::Mesh;
use crate::noise::{Footprint, FractalNoise};
use crate::number::{Count, Finite, NonNegative, Octaves, Positive, vector};
use crate::shape::Shape;

/// The form and size of a shape.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeSpec {
    /// A box; `size_m` are its full lengths along x, y and z.
    Box {
        /// Lengths, metres.
        size_m: [Positive; 3],
    },
    /// An upright cylinder.
    Cylinder {
        /// Radius, metres.
        radius_m: Positive,
        /// Height, metres.
        height_m: Positive,
    },
    /// A sphere.
    Sphere {
        /// Radius, metres.
        radius_m: Positive,
    },
    /// A tilted slab that rises along x. Its centre is the middle of its upper face.
    Ramp {
        /// Level length of the upper face, metres.
        run_m: Positive,
        /// How much higher its far end is, metres.
        rise_m: Finite,
        /// Width along y, metres.
        width_m: Positive,
        /// Thickness across the face, metres.
        thickness_m: Positive,
    },
    /// Ground of given heights over a rectangle, solid down to `thickness_m` below its lowest place. Its
    /// centre is the middle of the rectangle at height 0.
    HeightField {
        /// Lengths along x and y, metres.
        size_m: [Positive; 2],
        /// Rows of heights, metres: along a row x grows, from row to row y.
        heights_m: Vec<Vec<Finite>>,
        /// Thickness below the lowest place, metres.
        thickness_m: Positive,
    },
    /// Ground whose heights are fractal noise, otherwise as a height field.
    RoughGround {
        /// Lengths along x and y, metres.
        size_m: [Positive; 2],
        /// How many squares there are along x and y.
        squares: [Count; 2],
        /// Standard deviation of the heights, metres.
        deviation_m: NonNegative,
        /// Cell size of the coarsest octave, metres.
        scale_m: Positive,
        /// Number of octaves, each half as coarse as the one before.
        octaves: Octaves,
        /// Strength of an octave relative to the one before.
        roughness: Positive,
        /// Thickness below the lowest place, metres.
        thickness_m: Positive,
    },
    /// Triangles given here.
    Mesh {
        /// Corners, metres.
        vertices_m: Vec<[Finite; 3]>,
        /// Three vertex numbers each, from 0, anticlockwise seen from outside.
        triangles: Vec<[u32; 3]>,
    },
    /// Triangles of a Wavefront OBJ file.
    MeshFile {
        /// The file, relative to that of the world.
        path: String,
        /// Metres per unit of the file.
        unit_m: Positive,
    },
}

/// No more triangles than this in one world, to bound the memory (about 300 bytes
/// each while the world is built).
pub const MAX_TRIANGLES: usize = 8_000_000;

impl ShapeSpec {
    /// The shape, and the pose of its frame in that of the object. Files are looked for in `folder`.
    ///
    /// # Errors
    /// If a mesh or a height field is not sound, or a file cannot be read.
    pub fn build(&self, seed: u32, folder: Option<&Path>) -> Result<(Shape, Pose), String> {
        Ok(match self {
            Self::Box { size_m } => (a_box(size_m.map(|s| s.0)), Pose::identity()),
            Self::Cylinder { radius_m, height_m } => {
                let half_height = 0.5 * height_m.0;
                (Shape::Cylinder { radius: radius_m.0, half_height }, Pose::identity())
            }
            Self::Sphere { radius_m } => (Shape::Sphere { radius: radius_m.0 }, Pose::identity()),
            Self::Ramp { run_m, rise_m, width_m, thickness_m } => {
                let length = (run_m.0 * run_m.0 + rise_m.0 * rise_m.0).sqrt();
                let slab = a_box([length, width_m.0, thickness_m.0]);
                let turned = angle::pitch_up([run_m.0 / length, rise_m.0 / length]);
                let below = Translation3::new(0.0, 0.0, -0.5 * thickness_m.0);
                (slab, turned * below)
            }
            Self::HeightField { size_m, heights_m, thickness_m } => {
                let columns = heights_m.first().map_or(0, Vec::len);
                if heights_m.len() < 2 || columns < 2 || heights_m.iter().any(|row| row.len() != columns) {
                    let lengths: Vec<_> = heights_m.iter().map(Vec::len).collect();
                    return Err(format!(
                        "expected two or more rows of the same length of two or more heights, \
                         found lengths {lengths:?}"
                    ));
                }
                let height = |x: usize, y: usize| heights_m[y][x].0;
                let squares = [columns - 1, heights_m.len() - 1];
                (ground(size_m.map(|s| s.0), squares, height, thickness_m.0)?, Pose::identity())
            }
            Self::RoughGround { size_m, squares, deviation_m, scale_m, octaves, roughness, thickness_m } => {
                let noise = FractalNoise::new(scale_m.0, octaves.0, roughness.0);
                let (size, squares) = (size_m.map(|s| s.0), squares.map(Count::get));
                // What is finer than the squares cannot be shown.
                let width_m = (size[0] / squares[0] as f64).max(size[1] / squares[1] as f64);
                let footprint = Footprint { width_m, span_m: [0.0; 2] };
                let place = |i: usize, a: usize| size[a] * i as f64 / squares[a] as f64;
                let height = |x: usize, y: usize| {
                    let point = [place(x, 0), place(y, 1)];
                    deviation_m.0 * f64::from(noise.sample(point, &footprint, seed))
                };
                (ground(size, squares, height, thickness_m.0)?, Pose::identity())
            }
            Self::Mesh { vertices_m, triangles } => {
                let vertices = vertices_m.iter().map(|&v| vector(v)).collect();
                (mesh(vertices, triangles.clone())?, Pose::identity())
            }
            Self::MeshFile { path, unit_m } => (mesh_file(path, unit_m.0, folder)?, Pose::identity()),
        })
    }

    /// How many triangles the shape has, before it is built; files are counted afterwards.
    pub fn triangles(&self) -> usize {
        let of_ground = |[x, y]: [usize; 2]| 2 * x * y + 4 * (x + y) + 2;
        match self {
            Self::RoughGround { squares, .. } => of_ground(squares.map(Count::get)),
            Self::HeightField { heights_m, .. } => {
                of_ground([heights_m.first().map_or(0, Vec::len), heights_m.len()])
            }
            Self::Mesh { triangles, .. } => triangles.len(),
            _ => 0,
        }
    }
}

fn a_box(size: [f64; 3]) -> Shape {
    Shape::Box { half: Vector3::from(size) * 0.5 }
}

fn mesh(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Shape, String> {
    Ok(Shape::Mesh(Arc::new(Mesh::new(vertices, triangles)?)))
}

/// A closed mesh of a ground: two triangles per square on top, straight sides, a flat bottom.
fn ground(
    size: [f64; 2],
    [nx, ny]: [usize; 2],
    height: impl Fn(usize, usize) -> f64,
    thickness: f64,
) -> Result<Shape, String> {
    let columns = nx + 1;
    let place = |i: usize, n: usize, length: f64| length * (i as f64 / n as f64 - 0.5);
    let at = |x: usize, y: usize, z: f64| Vector3::new(place(x, nx, size[0]), place(y, ny, size[1]), z);
    let mut vertices = Vec::with_capacity(columns * (ny + 1) + 2 * (nx + ny) + 1);
    for y in 0..=ny {
        vertices.extend((0..=nx).map(|x| at(x, y, height(x, y))));
    }
    let top = |x: usize, y: usize| (y * columns + x) as u32;
    let mut triangles = Vec::with_capacity(2 * nx * ny + 6 * (nx + ny));
    for y in 0..ny {
        for x in 0..nx {
            let [a, b, c, d] = [top(x, y), top(x + 1, y), top(x + 1, y + 1), top(x, y + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    // The rim, anticlockwise from above, and below it a bottom fan.
    let rim: Vec<[usize; 2]> = (0..nx)
        .map(|x| [x, 0])
        .chain((0..ny).map(|y| [nx, y]))
        .chain((0..nx).map(|x| [nx - x, ny]))
        .chain((0..ny).map(|y| [0, ny - y]))
        .collect();
    let floor = vertices.iter().map(|v| v.z).fold(f64::INFINITY, f64::min) - thickness;
    let first = vertices.len() as u32;
    vertices.extend(rim.iter().map(|&[x, y]| at(x, y, floor)));
    let middle = vertices.len() as u32;
    vertices.push(Vector3::new(0.0, 0.0, floor));
    for (i, &[x, y]) in rim.iter().enumerate() {
        let next = (i + 1) % rim.len();
        let (a, b) = (top(x, y), top(rim[next][0], rim[next][1]));
        let (below_a, below_b) = (first + i as u32, first + next as u32);
        triangles.extend([[a, below_a, below_b], [a, below_b, b], [middle, below_b, below_a]]);
    }
    mesh(vertices, triangles)
}

fn mesh_file(path: &str, unit: f64, folder: Option<&Path>) -> Result<Shape, String> {
    let folder = folder.ok_or("a mesh file needs a world that is a file itself")?;
    let path = folder.join(path);
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let (models, _) = tobj::load_obj(&path, &options).map_err(|e| format!("{}: {e}", path.display()))?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for model in &models {
        let first = vertices.len() as u32;
        let positions = model.mesh.positions.chunks_exact(3);
        vertices.extend(positions.map(|p| Vector3::new(p[0], p[1], p[2]).map(f64::from) * unit));
        triangles.extend(model.mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| first + i)));
    }
    if triangles.len() > MAX_TRIANGLES {
        return Err(format!(
            "{}: expected at most {MAX_TRIANGLES} triangles, found {}",
            path.display(),
            triangles.len()
        ));
    }
    if vertices.iter().any(|v| !v.iter().all(|c| c.abs() <= 1e6)) {
        return Err(format!("{}: expected coordinates from -1e6 to 1e6 m", path.display()));
    }
    mesh(vertices, triangles).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
#[path = "shape_spec_tests.rs"]
mod tests;
