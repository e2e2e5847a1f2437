use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use evigrid_core::{Pose, name_hint};
use evigrid_grid::GridSpec;
use evigrid_replay::{Sequence, find_dataset, map_from_world};
use evigrid_synth::{SyntheticSequence, World};

use crate::{Config, Method, RunInfo};

/// A run whose every setting has been checked; nothing further in validates again.
pub struct Plan {
    /// The recording.
    pub sequence: Box<dyn Sequence>,
    /// From the recording's world to the map frame of this run.
    pub map_from_world: Pose,
    /// The methods.
    pub methods: Vec<Method>,
    /// What observers are told.
    pub info: RunInfo,
}

impl std::fmt::Debug for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Plan").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Plan {
    /// Opens the recording and checks all settings against it.
    ///
    /// # Errors
    /// If the data set, a method or a frame does not exist, or a setting is outside its domain.
    pub fn new(config: Config) -> Result<Self> {
        let methods = check_settings(&config)?;
        let sequence = open_dataset(&config.run.dataset)?;
        let info = run_info(config, sequence.as_ref())?;
        let map_from_world = map_frame(sequence.as_ref(), &info.frames)?;
        Ok(Self { sequence, map_from_world, methods, info })
    }
}

/// Checks everything that can be checked without the recording; returned are the methods.
pub(crate) fn check_settings(config: &Config) -> Result<Vec<Method>> {
    let methods = parse_methods(&config.run.methods)?;
    GridSpec::new(&config.grid)?;
    config.stereo.checked()?;
    config.truth.checked()?;
    config.winner_take_all.checked()?;
    config.cost_curve.checked()?;
    config.cost_curve_bayes.checked()?;
    config.line.checked()?;
    config.line_pyramid.checked()?;
    config.ray.checked()?;
    config.ray_pyramid.checked()?;
    config.souza.checked()?;
    if let Some(method) = methods.iter().find(|m| m.needs_costs()) {
        check_costs(config, method.name())?;
    }
    check_tolerances(&config.score.tolerances_m, config.grid.cell_size_m)?;
    Ok(methods)
}

/// Checks that there will be matching costs for the method of this name, which needs them.
fn check_costs(config: &Config, name: &str) -> Result<()> {
    let elsewhere = &config.input.disparity_dir;
    if !elsewhere.is_empty() {
        bail!(
            "input.disparity_dir: expected none for `{name}`, which needs matching costs, found `{elsewhere}`"
        );
    }
    if !config.stereo.matcher.has_volume() {
        bail!(
            "stereo.matcher: expected block or semi-global for `{name}`, which needs matching costs, found graph-cuts"
        );
    }
    Ok(())
}

/// What a run of these settings on a recording is.
pub(crate) fn run_info(config: Config, sequence: &dyn Sequence) -> Result<RunInfo> {
    let range: FrameRange = config.run.frames.parse()?;
    Ok(RunInfo {
        dataset: sequence.info().id.clone(),
        layout: sequence.info().layout.to_owned(),
        frames: range.frames(sequence.info().frame_count, config.run.stride)?,
        methods: config.run.methods.clone(),
        spec: GridSpec::new(&config.grid)?,
        config,
    })
}

/// From a recording's world to the map frame of a run over these frames, at least one.
pub(crate) fn map_frame(sequence: &dyn Sequence, frames: &[usize]) -> Result<Pose> {
    Ok(map_from_world(&sequence.world_from_left(frames[0])?))
}

fn parse_methods(names: &[String]) -> Result<Vec<Method>> {
    if names.is_empty() {
        bail!("run.methods: expected at least one method, found none");
    }
    let mut methods = Vec::new();
    for name in names {
        let Some(method) = Method::from_name(name) else {
            bail!("unknown method `{name}`{}", name_hint(name, Method::ALL.iter().map(|m| m.name())));
        };
        if methods.contains(&method) {
            bail!("method `{name}` is named twice");
        }
        methods.push(method);
    }
    Ok(methods)
}

/// Every cell within a tolerance is looked at, so a tolerance of many cells would take for ever.
const MAX_TOLERANCE_CELLS: f64 = 20.0;

fn check_tolerances(tolerances_m: &[f64], cell_size_m: f64) -> Result<()> {
    let most = MAX_TOLERANCE_CELLS * cell_size_m;
    match tolerances_m.iter().find(|t| !(**t >= 0.0 && **t <= most)) {
        Some(t) => bail!("score.tolerances_m: expected metres from 0 to {most} (20 cells), found {t}"),
        None => Ok(()),
    }
}

/// Where data sets are looked for by name: the folder in the environment variable EVIGRID_DATA, else `data`.
pub fn data_root() -> PathBuf {
    std::env::var_os("EVIGRID_DATA").map_or_else(|| PathBuf::from("data"), PathBuf::from)
}

/// Opens a data set: `synth:NAME`, a folder, or the name of a known data set below [`data_root`].
///
/// # Errors
/// If there is no such world, folder or data set, or it cannot be read.
pub fn open_dataset(name: &str) -> Result<Box<dyn Sequence>> {
    if let Some(world) = name.strip_prefix("synth:") {
        return Ok(Box::new(SyntheticSequence::new(World::open(world)?)));
    }
    let path = Path::new(name);
    if path.exists() {
        return Ok(evigrid_replay::open(path)?);
    }
    let Some(known) = find_dataset(name)? else {
        let known = evigrid_replay::datasets()?.into_iter().map(|d| d.id);
        let worlds = World::builtin_names().map(|w| format!("synth:{w}"));
        let hint = name_hint(name, worlds.chain(known));
        bail!("no such data set: expected a folder or a known name, found `{name}`{hint}");
    };
    let dir = known.dir_below(&data_root());
    evigrid_replay::open(&dir).with_context(|| {
        format!("data set {name} is not here (scripts/download_datasets.sh {name} fetches it)")
    })
}

/// No recording has more frames.
const MAX_STRIDE: usize = 1_000_000;

/// Frame numbers `A..B`; either end may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    from: usize,
    to: Option<usize>,
}

impl std::str::FromStr for FrameRange {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || format!("run.frames: expected A..B, A.. or ..B with whole numbers, found `{text}`");
        let (from, to) = text.split_once("..").with_context(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().with_context(wrong);
        let from = if from.trim().is_empty() { 0 } else { number(from)? };
        let to = if to.trim().is_empty() { None } else { Some(number(to)?) };
        Ok(Self { from, to })
    }
}

impl FrameRange {
    /// The frame numbers within a recording of `count` frames, every `stride`-th.
    ///
    /// # Errors
    /// If the stride is 0, the range is empty or it goes beyond the recording.
    pub fn frames(&self, count: usize, stride: usize) -> Result<Vec<usize>> {
        if !(1..=MAX_STRIDE).contains(&stride) {
            bail!("run.stride: expected a number from 1 to {MAX_STRIDE}, found {stride}");
        }
        let to = self.to.unwrap_or(count);
        if to > count {
            bail!("run.frames: expected frames within 0..{count}, found {}..{to}", self.from);
        }
        if self.from >= to {
            bail!("run.frames: expected at least one frame within 0..{count}, found {}..{to}", self.from);
        }
        Ok((self.from..to).step_by(stride).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn frames(text: &str, stride: usize) -> Result<Vec<usize>> {
        text.parse::<FrameRange>()?.frames(10, stride)
    }

    #[test]
    fn frame_ranges() {
        assert_eq!(frames("2..5", 1).unwrap(), [2, 3, 4]);
        assert_eq!(frames("..", 4).unwrap(), [0, 4, 8]);
        assert_eq!(frames("7..", 2).unwrap(), [7, 9]);
        assert_eq!(frames("..1", 1).unwrap(), [0]);
    }

    #[test]
    fn impossible_ranges_are_refused() {
        for (text, stride, part) in [
            ("5..5", 1, "at least one frame"),
            ("6..2", 1, "at least one frame"),
            ("0..11", 1, "within 0..10"),
            ("0..3", 0, "run.stride"),
            ("3", 1, "expected A..B"),
            ("a..3", 1, "expected A..B"),
            ("-1..3", 1, "expected A..B"),
        ] {
            let message = format!("{:#}", frames(text, stride).unwrap_err());
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
