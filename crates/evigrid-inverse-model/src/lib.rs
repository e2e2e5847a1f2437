//! Disparity images drawn into occupancy grids by an inverse sensor model: Andert, "Drawing Stereo Disparity
//! Images into Occupancy Grids: Measurement Model and Fast Implementation" (2009), whose four methods are
//! `line`, `line-pyramid`, `ray` and `ray-pyramid`, and Souza, Maia, Goncalves, "3D Probabilistic Occupancy
//! Grid to Robotic Mapping with Stereo Vision" (2012), `souza`, which adds the error of the robot's motion.
//!
//! # How a disparity image is drawn
//!
//! `model` has Andert's eqs 1 to 13 in closed form; drawing uses a table of the Gaussian, off by at most 6e-4
//! in P. An image is drawn into a grid of its own, as P (`image_grid`: a mark per cell, and a number where it
//! is more than free), then blurred if wanted, then added to the map.
//!
//! - Bresenham's line knows cells alone, so all pixels that end in one cell share their line. Its free space
//!   is drawn once per image; the section near the end is walked once per run of neighbouring pixels; only
//!   the profile is evaluated per pixel, and no farther than 4 deviations in front.
//! - Layer 0 of a pyramid is never stored where no layer that low is asked for: filters and the first halving
//!   are one pass.
//! - Blurring does all cells with one size of kernel together, by three passes along the axes.

mod blur;
mod bresenham;
mod counters;
mod drawing;
mod gaussian_table;
mod image_grid;
mod layers;
mod line_drawing;
mod line_ends;
mod lines;
mod mapper;
mod methods;
mod model;
mod pyramid;
mod ray_tracing;
mod settings;
mod slice;
mod window;

pub use blur::{BlurKind, MAX_DEVIATION_CELLS, PoseDeviation, blurred};
pub use counters::Counters;
pub use gaussian_table::{GaussianTable, Profile, TABLE_ERROR};
pub use layers::{LAYERS, LayerTable};
pub use mapper::InverseModelMapper;
pub use methods::{Line, LinePyramid, Ray, RayPyramid, Souza};
pub use model::{ANDERT_RIG, Measurement, NearPixels, Obstacle, SensorModel};
pub use settings::{
    BlockPoint, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, SouzaSettings, Walk,
};
pub use slice::{Slice, horizontal_slice};
pub use window::WindowCube;
