//! Results on disk: the folder of a run, its tables, map files and summary, and the comparison of two runs.
//!
//! docs/metrics.md describes every file and column.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod compare;
pub mod files;
mod info;
mod label_colours;
mod label_file;
mod layer_file;
mod map_file;
mod map_files;
mod model_file;
pub mod npz;
mod outputs;
mod plan_tables;
mod ros_map;
mod run_file;
mod safety_tables;
mod summary;
mod tables;
#[cfg(test)]
mod test_run;
mod writer;
#[cfg(test)]
mod writer_tests;

pub use compare::{CompareOptions, Comparison, ToleranceRule, compare, parse_percent};
pub use files::RECORDING;
pub use info::{
    FrameRow, MethodInfo, MethodMaps, MethodResult, RunInfo, RunResult, SettingsText, StageTime, TruthFile,
};
pub use label_colours::{label_rgb, voxel_rgb};
pub use label_file::{check_same_cells, is_label_file, read_labels};
pub use layer_file::{write_layer, write_plan, write_safety};
pub use map_file::{MapFile, read_map, write_map, write_truth};
pub use model_file::write_model;
pub use outputs::{PendingFile, ResultsFolder, SealedFile};
pub use ros_map::{write_ros_picture, write_ros_yaml};
pub use run_file::{RESULTS_FORMAT, run_json};
pub use safety_tables::{HAZARD_COLUMNS, PLACE_COLUMNS, hazard_cells, place_cells};
pub use summary::{markdown_summary, markdown_table};
pub use tables::{seal, summary_header, write_rows, write_text};
pub use writer::{Kept, ResultsWriter, has_maps};
