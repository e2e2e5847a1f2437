//! Runs mapping methods over a recording and scores them: the settings of a run, the loop, the results folder, its
//! tables and map files. Results are plain values; tables, progress and recording are equal observers of the loop.

mod clock;
mod colours;
mod compare;
mod config;
mod ground_truth;
mod map_file;
mod memory;
mod method;
mod observer;
mod outputs;
mod pair_matcher;
mod plan;
mod prefetch;
mod run;
mod score_file;
mod scores;
mod sweep;
mod tables;

pub use clock::{Clock, RealClock};
pub use colours::turbo;
pub use compare::{CompareOptions, Comparison, ToleranceRule, compare, parse_percent};
pub use config::{Config, ConfigError, InputSettings, OutputSettings, RunSettings, ScoreSettings};
pub use map_file::{MapFile, read_map, write_map, write_truth};
pub use memory::peak_memory_mib;
pub use method::Method;
pub use observer::{MethodStep, Observer, RunInfo, RunResult, StageTime, Step};
pub use outputs::{PendingFile, ResultsFolder, SealedFile};
pub use plan::{FrameRange, Plan, data_root, open_dataset};
pub use run::evaluate;
pub use score_file::score_map_file;
pub use scores::{MethodResult, Scores};
pub use sweep::{Mapped, Sweep, SweepPlan, SweepStep, map_together, run_sweep};
pub use tables::{TableWriter, markdown_summary, run_json};
