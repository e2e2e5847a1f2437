//! Exact truth from the geometry of a world, not from its sensors.
//!
//! Everything is in the map frame (x forward, y left, z up, metres) that the given
//! `map_from_world` leads to; see `evigrid_replay::map_from_world`. Only `map_from_world`s that
//! keep z up make sense of heights and slopes.

mod air;
mod boards;
mod cylinder;
#[cfg(test)]
mod fixtures;
mod hazards;
mod placed;
mod planes;
mod safety;
mod safety_map;
#[cfg(test)]
mod surface_points;
mod terrain;
mod touch;
mod tracks;
mod voxels;

pub use boards::{BoardView, boards};
pub use hazards::{Hazard, hazards, hazards_or_nothing};
pub use planes::{GroundPlane, ground_planes};
pub use safety::SafetyTruth;
pub use terrain::{GroundColumn, GroundSurface, TerrainTruth};
pub use tracks::{Track, tracks};
pub use voxels::{VoxelState, VoxelTruth};
