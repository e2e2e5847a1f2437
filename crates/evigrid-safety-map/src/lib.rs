//! Local safety maps: where a wheeled robot can drive, from stereo alone (Murarka and Kuipers 2009).
//!
//! Points of each frame go into voxels with log-odds and into a list of points per voxel; columns of voxels
//! become segments of ground, segments become planes, and planes and their neighbourhood become labels.
//!
//! [`SafetyMapping`] is the method. [`label_voxels`] labels the map of any other method by the same rules.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod beyond;
mod columns;
mod edges;
mod evidence;
mod labels;
mod merge;
mod method;
mod model;
mod outliers;
mod points;
mod reassign;
mod robot;
mod scroll;
mod segments;
mod settings;
mod voxel_map;

pub use columns::{Column, Columns};
pub use labels::label_columns;
pub use method::{SafetyMapping, SafetyMappingPlus, Stage};
pub use model::Model;
pub use outliers::Readings;
pub use robot::Robot;
pub use segments::{Segment, Segments};
pub use settings::{FloorPlace, SafetyMapPlusSettings, SafetyMapSettings, Spread};
pub use voxel_map::label_voxels;
