//! Synthetic worlds as sequences of frames: a renderer of stereo pairs and a simulated laser on one scene.
//!
//! A world is data: a TOML with shapes, materials, light, trajectory and sensors (`datasets/synth/`; every
//! key is explained in docs/synthetic.md). [`World`] is the checked description. For every frame it yields a
//! scene: all shapes in their places at that instant, built once where nothing moves. Cameras and laser
//! scanners look at the scene; the exact truth never uses a sensor: voxels, terrain, safety labels and planes
//! come from the shapes.
//!
//! The same world gives the same bytes for any number of threads and on every machine. Nothing in a frame
//! depends on another frame or on the order of the pixels: random numbers come from ChaCha streams keyed by
//! seed, frame, sensor and row, textures from integer hashes, sines and cosines from the `libm` crate; the
//! rest is IEEE arithmetic, which is exact by definition.
//!
//! World frame: x and y on the ground, z up, metres. Body frame (the vehicle): x forward, y left, z up,
//! origin on the ground.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod angle;
mod camera;
mod contents;
mod description;
#[cfg(test)]
mod docs_tests;
mod error;
mod exact;
mod hazard_kind;
mod hazard_spec;
mod laser;
mod light;
mod material;
mod mesh;
mod name;
mod noise;
mod number;
mod object_spec;
mod pattern;
mod random;
mod ray;
mod render;
mod reported_pose;
mod robot;
mod scene;
mod sequence;
mod shape;
mod shape_spec;
mod thing;
mod tiles;
mod trajectory;
mod tree;
mod view_truth;
mod world;
mod write;

pub use error::SynthError;
pub use exact::{
    BoardView, GroundColumn, GroundPlane, GroundSurface, Hazard, SafetyTruth, TerrainTruth, Track,
    VoxelState, VoxelTruth, boards, ground_planes, hazards, hazards_or_nothing, tracks,
};
pub use hazard_kind::HazardKind;
pub use sequence::SyntheticSequence;
pub use view_truth::{LeftViewTruth, PixelTruth};
pub use world::World;
pub use write::{WriteError, WriteStep, write_data_set};
