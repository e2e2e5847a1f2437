//! Disparity images drawn into occupancy grids by an inverse sensor model: Andert, "Drawing Stereo Disparity Images into
//! Occupancy Grids: Measurement Model and Fast Implementation" (2009), whose four methods are `line`, `line-pyramid`,
//! `ray` and `ray-pyramid`, and Souza, Maia, Goncalves, "3D Probabilistic Occupancy Grid to Robotic Mapping with Stereo
//! Vision" (2012), `souza`, which adds the error of the robot's motion.

mod blur;
mod bresenham;
mod counters;
mod error;
mod filter;
mod gaussian_table;
mod image_grid;
mod layers;
mod line_drawing;
mod line_ends;
mod lines;
mod mapper;
mod model;
mod pyramid;
mod ray_tracing;
mod settings;
mod slice;
mod window;

pub use blur::{BlurKind, MAX_DEVIATION_CELLS, PoseDeviation, blurred};
pub use counters::Counters;
pub use error::SettingError;
pub use gaussian_table::{GaussianTable, Profile, TABLE_ERROR};
pub use layers::{LAYERS, LayerTable};
pub use mapper::InverseModelMapper;
pub use model::{Measurement, NearPixels, Obstacle, SensorModel};
pub use settings::{
    BlockPoint, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, SouzaSettings, Walk,
};
pub use slice::{Slice, horizontal_slice};
pub use window::WindowCube;
