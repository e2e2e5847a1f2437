use anyhow::{Result, bail};
use evigrid_core::{Mounting, Pose, stable_hash};
use evigrid_grid::{GridSpec, LayerKind};
use evigrid_methods::{Entry, MethodSettings};
use evigrid_results::{MethodInfo, RunInfo, SettingsText};
use evigrid_stereo::MatcherKind;
use evigrid_truth::TruthSource;

use crate::needs::{check_matcher, mounting};
use crate::{Config, FrameRange, OutputSettings, Recording};

/// A run whose every setting has been checked; nothing further in validates again.
#[derive(Debug)]
pub struct Plan {
    /// The recording.
    pub recording: Recording,
    /// The run itself.
    pub job: RunJob,
}

/// A run on a recording, checked against it.
#[derive(Debug)]
pub struct RunJob {
    /// All settings.
    pub config: Config,
    /// The methods.
    pub methods: Vec<Entry>,
    /// Description of the run for results and observers.
    pub info: RunInfo,
    /// From the recording's world to the map frame of this run.
    pub map_from_world: Pose,
    /// How the left camera stands over the ground, if anybody tells.
    pub mounting: Option<Mounting>,
}

impl Plan {
    /// Opens the recording and checks all settings against it.
    ///
    /// # Errors
    /// If the data set, a method or a frame does not exist, a setting is outside its domain, or a method
    /// needs what the run cannot give.
    pub fn new(config: Config) -> Result<Self> {
        let methods = check_settings(&config)?;
        let recording = Recording::open(&config.run.dataset)?;
        let job = RunJob::new(config, methods, &recording)?;
        Ok(Self { recording, job })
    }

    /// The distance from the camera within which the disparities that are tried show nothing, metres, if a method
    /// tells road from obstacles by them and it is more than a fifth of the grid's length ahead.
    pub fn unseen_m(&self) -> Option<f64> {
        let (config, rig) = (&self.job.config, &self.recording.sequence().info().rig);
        let largest_px = (config.stereo.min_disparity + config.stereo.disparities) as f64 - 0.5;
        let unseen_m = rig.depth_m(largest_px);
        let is_asked = self.job.methods.iter().any(|method| method.needs.road);
        let [from, to] = config.grid.x_m;
        (is_asked && unseen_m > 0.2 * (to - from)).then_some(unseen_m)
    }
}

impl RunJob {
    /// The run of checked settings on a recording.
    ///
    /// # Errors
    /// If a frame does not exist, or the recording lacks what a setting or a method asks for.
    pub(crate) fn new(config: Config, methods: Vec<Entry>, recording: &Recording) -> Result<Self> {
        let sequence = recording.sequence().info();
        let range: FrameRange = config.run.frames.parse()?;
        let frames = range.frames(sequence.frame_count, config.run.stride)?;
        if config.truth.source == TruthSource::Exact && recording.world().is_none() {
            bail!(
                "truth.source: expected laser for data set {}, found exact (synthetic worlds alone know their exact truth)",
                sequence.id
            );
        }
        if config.stereo.matcher == MatcherKind::Exact && recording.world().is_none() {
            bail!(
                "stereo.matcher: expected another for data set {}, found exact (synthetic worlds alone know their disparities)",
                sequence.id
            );
        }
        let mounting = mounting(&config, recording, &methods)?;
        let map_from_world = recording.map_frame(&frames)?;
        let info = RunInfo {
            dataset: sequence.id.clone(),
            layout: sequence.layout.to_owned(),
            stride: config.run.stride,
            methods: methods.iter().map(method_info).collect(),
            spec: GridSpec::new(&config.grid)?,
            tolerances_m: config.score.tolerances_m.clone(),
            truth: config.truth.source.name(),
            settings: SettingsText {
                json: config.to_json()?,
                toml: config.to_toml()?,
                hash: settings_hash(&config, &sequence.id, &frames)?,
            },
            frames,
        };
        Ok(Self { config, methods, info, map_from_world, mounting })
    }

    /// Whether any of its methods makes such a map.
    pub(crate) fn shows(&self, kind: LayerKind) -> bool {
        self.methods.iter().any(|method| method.layers.contains(&kind))
    }
}

fn method_info(method: &Entry) -> MethodInfo {
    MethodInfo { name: method.name.to_owned(), layers: method.layers.to_vec() }
}

/// Checks everything that can be checked without the recording; returned are the methods.
pub(crate) fn check_settings(config: &Config) -> Result<Vec<Entry>> {
    let methods = parse_methods(&config.run.methods, &config.methods)?;
    GridSpec::new(&config.grid)?;
    config.stereo.checked()?;
    config.truth.checked()?;
    config.input.mounting()?;
    config.score.check(config.grid.cell_size_m)?;
    for method in config.methods.methods().iter() {
        method.check(&config.methods.table(method.name))?;
    }
    methods.iter().try_for_each(|method| check_matcher(config, method))?;
    Ok(methods)
}

fn parse_methods(names: &[String], settings: &MethodSettings) -> Result<Vec<Entry>> {
    if names.is_empty() {
        bail!("run.methods: expected at least one method, found none");
    }
    let mut methods: Vec<Entry> = Vec::new();
    for name in names {
        let Some(method) = settings.methods().find(name) else {
            bail!("unknown method `{name}`{}", settings.methods().hint(name));
        };
        if methods.iter().any(|m| m.name == method.name) {
            bail!("method `{name}` is named twice");
        }
        methods.push(*method);
    }
    Ok(methods)
}

/// Two runs with the same hash were made under the same conditions: recording, frames, and all settings that
/// they use. Settings of methods that do not run, the recording's place and the files that are written do not
/// count.
fn settings_hash(config: &Config, dataset: &str, frames: &[usize]) -> Result<String> {
    let mut used = config.clone();
    dataset.clone_into(&mut used.run.dataset);
    used.output = OutputSettings::default();
    let mut text = toml::to_string(&used)?;
    for name in &config.run.methods {
        text += &format!("[{name}]\n{}", config.methods.table(name));
    }
    Ok(format!("{:016x}", stable_hash(&format!("{text}{frames:?}"))))
}
