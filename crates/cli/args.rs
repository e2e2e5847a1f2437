use std::path::PathBuf;

use anyhow::Result;
use clap::{Parser, Subcommand};
use evigrid_eval::Config;
use evigrid_results::{ToleranceRule, parse_percent};
use evigrid_synth::World;

/// Replays stereo recordings, builds occupancy grids with published methods and scores them against the
/// laser.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 110)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Map a recording and score the maps; without arguments on a small built-in world.
    Run(RunArgs),
    /// Map and score a grid of settings x methods x data sets; goes on where an earlier sweep was stopped.
    Sweep(SweepArgs),
    /// Score a map that another mapper made.
    Score(ScoreArgs),
    /// Tell what got better or worse from one run to another; exit code 1 if anything got worse.
    Compare(CompareArgs),
    /// Tell what was expected of a data set, what was found and what can be run on it.
    Check(CheckArgs),
    /// Make figures and tables again, each as data and picture.
    Reproduce(ReproduceArgs),
    /// Write a synthetic data set with its exact truth.
    Synth(SynthArgs),
    /// List the methods and every setting, with default, unit and source.
    Methods,
    /// List the metrics, with formula, unit and the tolerance of `compare`, as Markdown.
    Metrics,
}

/// Which frames of which recording, and all settings.
#[derive(Debug, clap::Args)]
pub struct InputArgs {
    /// A folder (`evigrid check DIR` tells what is in it), the name of a known data set, or synth:WORLD
    /// [default: synth:street].
    #[arg(long, value_name = "DIR|NAME")]
    pub dataset: Option<String>,
    /// Frames A to B, B excluded; either may be left out [default: all].
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// Use every N-th frame [default: 1].
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole_number)]
    pub stride: Option<usize>,
    /// Settings in TOML, as config.toml of an earlier run.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// One setting, as SECTION.KEY=VALUE (`evigrid methods` lists them); may be given many times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub sets: Vec<String>,
}

impl InputArgs {
    /// The settings: defaults, then the file, then `--set`, then the other arguments.
    pub fn config(&self) -> Result<Config> {
        let mut config = Config::load(self.config.as_deref(), &self.sets)?;
        if let Some(dataset) = &self.dataset {
            config.run.dataset.clone_from(dataset);
        }
        if let Some(frames) = &self.frames {
            config.run.frames.clone_from(frames);
        }
        config.run.stride = self.stride.unwrap_or(config.run.stride);
        Ok(config)
    }
}

#[derive(Debug, clap::Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// A method (`evigrid methods` lists them); may be given many times [default: winner-take-all].
    #[arg(long = "method", value_name = "NAME")]
    pub methods: Vec<String>,
    /// Sweep a setting over a range, SECTION.KEY=A..B:STEP or SECTION.KEY=[VALUE, ...], around this run; may
    /// be given many times, for all combinations. No recording is written.
    #[arg(long = "sweep", value_name = "KEY=A..B:STEP")]
    pub sweeps: Vec<String>,
    /// Folder for the results [default: out/DATASET, of a sweep out/sweep-DATASET].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl RunArgs {
    /// The settings: those of the input, with the methods.
    pub fn config(&self) -> Result<Config> {
        let mut config = self.input.config()?;
        if !self.methods.is_empty() {
            config.run.methods.clone_from(&self.methods);
        }
        Ok(config)
    }
}

#[derive(Debug, clap::Args)]
pub struct SweepArgs {
    /// The plan in TOML (docs/sweep.md).
    #[arg(value_name = "PLAN.toml")]
    pub plan: PathBuf,
    /// Folder for the results; points that it holds are kept [default: out/sweep-NAME].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub struct ScoreArgs {
    /// The map: npz with indices [N,3], log_odds [N], origin [3], cell_size; or safety labels, npz with labels
    /// [nx,ny], origin [2], cell_size.
    #[arg(value_name = "MAP.npz")]
    pub map: PathBuf,
    /// True safety labels for a map of such labels: truth.safety.npz of a run, or safety_map.png of a written
    /// world. No recording is needed then; every cell that the truth knows counts.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["dataset", "frames", "stride", "config", "sets"])]
    pub truth: Option<PathBuf>,
    #[command(flatten)]
    pub input: InputArgs,
}

#[derive(Debug, clap::Args)]
pub struct CompareArgs {
    /// Results folder of the run that is the measure.
    #[arg(value_name = "BASE")]
    pub base: PathBuf,
    /// Results folder of the run that is judged.
    #[arg(value_name = "NEW")]
    pub new: PathBuf,
    /// Changes that count as none: 0.005 (all rates), 2% (all counts), METRIC=0.005, METRIC=2%; METRIC=off
    /// gives no verdict; may be given many times [default: 0.002 and 1%].
    #[arg(long = "tolerance", value_name = "[METRIC=]VALUE", allow_negative_numbers = true)]
    pub tolerances: Vec<ToleranceRule>,
    /// Judge time and memory too; up to PERCENT more is tolerated.
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true, default_missing_value = "20%",
        value_parser = parse_percent)]
    pub timing: Option<f64>,
    /// Show unchanged metrics too.
    #[arg(long)]
    pub all: bool,
}

#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// Folder of the data set.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

#[derive(Debug, clap::Args)]
#[command(after_help = items())]
pub struct ReproduceArgs {
    /// A group or one item of it (listed below); `worlds/FILE.toml` is the picture of a world of your own
    /// [default: all].
    #[arg(value_name = "GROUP[/ITEM]")]
    pub names: Vec<String>,
    /// Folder below which the data sets lie [default: $EVIGRID_DATA, else data].
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub out: PathBuf,
}

#[derive(Debug, clap::Args)]
#[command(after_help = built_in_worlds())]
pub struct SynthArgs {
    /// A built-in world (listed below), or a world of your own as a .toml file.
    #[arg(value_name = "WORLD")]
    pub world: String,
    /// Folder for the data set; new, empty, or one that this command wrote.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Frames A to B, B excluded; either may be left out [default: all].
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub frames: Option<String>,
}

/// A count, as the command line has it.
fn whole_number(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("expected a whole number, at least 1, found `{text}`"))
}

/// The groups with their items, for the help.
fn items() -> String {
    let line = |group: &evigrid_reproduce::Group| format!("  {}: {}", group.name, group.items().join(", "));
    let lines: Vec<String> = evigrid_reproduce::GROUPS.iter().map(line).collect();
    format!("Groups and items:\n{}", lines.join("\n"))
}

/// The worlds there are, for the help.
fn built_in_worlds() -> String {
    let names: Vec<&str> = World::builtin_names().collect();
    format!("Built-in worlds: {}", names.join(", "))
}
