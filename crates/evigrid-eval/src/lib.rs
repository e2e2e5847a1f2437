//! Runs mapping methods over a recording and scores them: the settings of a run, the one loop over frames for
//! runs, sweeps and foreign maps, and the truth of every kind of map. Tables, progress and recording are
//! equal observers of a run.

mod clock;
mod colours;
mod config;
mod frame_plan;
mod frame_range;
mod lane;
mod match_source;
mod memory;
mod needs;
mod observer;
mod pass;
mod plan;
mod prefetch;
mod recording;
mod run;
mod score;
mod stage_times;
mod sweep;
mod tables;
mod truth;

pub use clock::{Clock, RealClock};
pub use colours::turbo;
pub use config::{Config, ConfigError, InputSettings, OutputSettings, RunSettings, ScoreSettings};
pub use frame_range::FrameRange;
pub use match_source::MatchSource;
pub use memory::peak_memory_mib;
pub use observer::{LazyModel, LazyPictures, MethodStep, Observer, Step};
pub use plan::{Plan, RunJob};
pub use recording::{Recording, data_root};
pub use run::evaluate;
pub use score::score_map_file;
pub use sweep::{Followed, Mapped, Sweep, SweepPlan, SweepStep, follow_together, map_together, run_sweep};
pub use tables::TableWriter;
pub use truth::Truth;
