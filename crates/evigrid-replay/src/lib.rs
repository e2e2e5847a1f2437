//! Stereo data sets as sequences of frames: KITTI raw, KITTI odometry, Middlebury pairs.
//!
//! [`open`] recognises the [`Layout`] of a folder; [`check`] tells what a folder holds and lacks;
//! [`datasets`] lists the recordings that the project knows by name.
//!
//! A new layout is a module with a [`Sequence`] and an associated constant of [`Layout`] that describes it.
//! It is named here and in `Layout::ALL`, and nowhere else.

mod calibration;
mod check;
mod check_folder;
mod datasets;
mod detect;
mod disparity_png;
mod error;
#[cfg(test)]
mod fixtures;
mod folder;
mod frame_parts;
mod frame_ranges;
mod image_size;
mod kitti_odometry;
mod kitti_raw;
mod laser_file;
mod layout;
mod middlebury;
mod oxts;
mod png;
mod poses;
mod sequence;
mod stamps;
mod text;

pub use check::{CheckItem, CheckReport, ItemState};
pub use datasets::{DatasetInfo, datasets, find_dataset};
pub use detect::{check, open};
pub use disparity_png::{read_disparity_png, write_disparity_png};
pub use error::ReplayError;
pub use frame_ranges::FrameRanges;
pub use kitti_odometry::KittiOdometry;
pub use kitti_raw::KittiRaw;
pub use layout::Layout;
pub use middlebury::{MiddleburyPair, middlebury_truth};
pub use sequence::{Sequence, SequenceInfo, map_from_world};
