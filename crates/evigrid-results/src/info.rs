use evigrid_grid::{GridSpec, HybridModel, Layer, LayerKind, SafetyMap};
use evigrid_metrics::{PlanTally, SafetyTally, Scores, VoxelReference};
use serde_json::Value;

/// Description of a run before its first frame.
#[derive(Debug, Clone)]
pub struct RunInfo {
    /// Name of the recording.
    pub dataset: String,
    /// Layout of the recording.
    pub layout: String,
    /// Frame numbers, in the order of the run.
    pub frames: Vec<usize>,
    /// Distance between frame numbers.
    pub stride: usize,
    /// The methods, in the order of the run.
    pub methods: Vec<MethodInfo>,
    /// The grid of all maps.
    pub spec: GridSpec,
    /// Distances of the tolerant scores, metres.
    pub tolerances_m: Vec<f64>,
    /// Source of the truth: `laser`, or `exact` for a world whose shapes are known.
    pub truth: &'static str,
    /// All settings.
    pub settings: SettingsText,
}

/// A method of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MethodInfo {
    /// Its name.
    pub name: String,
    /// The kinds of maps that it makes.
    pub layers: Vec<LayerKind>,
}

/// All settings of a run, as they are written to its files.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingsText {
    /// For run.json.
    pub json: Value,
    /// For config.toml.
    pub toml: String,
    /// A hash that is the same for two runs under the same conditions: recording, frames, and settings that
    /// matter.
    pub hash: String,
}

/// Final maps of one method.
#[derive(Debug, Clone)]
pub struct MethodMaps<'a> {
    /// Its layers.
    pub layers: Vec<Layer<'a>>,
    /// The 3-D model behind its safety map, if it makes one.
    pub hybrid: Option<HybridModel>,
}

impl<'a> From<Vec<Layer<'a>>> for MethodMaps<'a> {
    fn from(layers: Vec<Layer<'a>>) -> Self {
        Self { layers, hybrid: None }
    }
}

/// Final scores of one method.
#[derive(Debug, Clone)]
pub struct MethodResult {
    /// Name of the method.
    pub method: String,
    /// One entry per kind of layer that there is a truth for.
    pub scores: Vec<Scores>,
    /// Its safety map by place and by hazard, summed over frames; `None` if it was not scored.
    pub safety: Option<SafetyTally>,
    /// Its ground plan counted frame by frame; `None` if it was not.
    pub plan: Option<PlanTally>,
}

impl MethodResult {
    /// The scores of a kind of layer, if it could be scored.
    pub fn scores_of(&self, kind: LayerKind) -> Option<&Scores> {
        scores_of(&self.scores, kind)
    }
}

/// The scores of a kind of layer among those of a method.
pub(crate) fn scores_of(scores: &[Scores], kind: LayerKind) -> Option<&Scores> {
    scores.iter().find(|scores| scores.kind == kind)
}

/// Result of a run.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// One entry per method.
    pub methods: Vec<MethodResult>,
    /// Number of frames that were mapped.
    pub frames: usize,
    /// Numbers of the frames that had no laser scan: they were mapped, but are not in the reference.
    pub without_laser: Vec<usize>,
    /// Wall time of the whole loop, milliseconds.
    pub wall_ms: f64,
    /// Stages in the order of a frame, with the sum of their times over all frames and methods, milliseconds.
    pub stage_totals: Vec<(&'static str, f64)>,
}

impl RunResult {
    /// Each method whose safety map was scored, by name.
    pub(crate) fn safety(&self) -> impl Iterator<Item = (&str, &SafetyTally)> {
        self.methods.iter().filter_map(|method| Some((method.method.as_str(), method.safety.as_ref()?)))
    }

    /// Each method whose plan was counted frame by frame, by name.
    pub(crate) fn plans(&self) -> impl Iterator<Item = (&str, &PlanTally)> {
        self.methods.iter().filter_map(|method| Some((method.method.as_str(), method.plan.as_ref()?)))
    }

    /// Whether any method has scores of a kind of layer.
    pub(crate) fn has_scores(&self, kind: LayerKind) -> bool {
        self.methods.iter().any(|method| method.scores_of(kind).is_some())
    }
}

/// Time that one stage of one frame took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageTime {
    /// Frame number.
    pub frame: usize,
    /// Position of the method in the run; `None` for what all methods share.
    pub method: Option<usize>,
    /// read, match, integrate, truth, score or record.
    pub stage: &'static str,
    /// Duration, milliseconds.
    pub ms: f64,
}

/// Scores after one frame.
#[derive(Debug, Clone)]
pub struct FrameRow<'a> {
    /// Frame number.
    pub frame: usize,
    /// Time of the frame, nanoseconds.
    pub stamp_ns: i64,
    /// Laser scans in the reference so far.
    pub scans: usize,
    /// Pixels with a disparity, before any filter.
    pub matched_pixels: usize,
    /// Scores of each method, one entry per kind of layer that there is a truth for.
    pub scores: Vec<&'a [Scores]>,
}

/// The truth of a run, for its files.
#[derive(Debug, Clone, Copy)]
pub struct TruthFile<'a> {
    /// True voxels, for truth.npz.
    pub voxels: Option<VoxelReference<'a>>,
    /// True safety labels, for truth.safety.npz.
    pub safety: Option<&'a SafetyMap>,
}
