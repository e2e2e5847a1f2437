//! A small run for the tests.

use evigrid_grid::{
    GridSettings, GridSpec, HybridModel, LayerKind, LogOddsGrid, PlanGrid, SafetyLabel, SafetyMap,
};
use evigrid_metrics::{
    NamedArea, PlanReference, PlanState, PlanningDisc, SafetyCase, SafetyReference, SafetyTally, Scores,
    VoxelReference,
};
use serde_json::json;

use crate::{MethodInfo, MethodResult, RunInfo, RunResult, SettingsText};

/// Two methods on six voxels: `line` makes voxels alone, `all` makes every kind of layer.
pub fn info() -> RunInfo {
    let settings = GridSettings { x_m: [0.0, 1.2], y_m: [0.0, 0.2], z_m: [0.0, 0.2], cell_size_m: 0.2 };
    let method = |name: &str, layers: &[LayerKind]| MethodInfo { name: name.into(), layers: layers.to_vec() };
    RunInfo {
        dataset: "yard".into(),
        layout: "synthetic".into(),
        frames: vec![0, 2],
        stride: 2,
        methods: vec![method("line", &[LayerKind::Voxels]), method("all", &LayerKind::ALL)],
        spec: GridSpec::new(&settings).unwrap(),
        tolerances_m: vec![0.2],
        truth: "laser",
        settings: SettingsText {
            json: json!({ "grid": { "cell_size_m": 0.2 }, "truth": { "source": "laser" } }),
            toml: "[grid]\n".into(),
            hash: "00ff".into(),
        },
    }
}

/// A map of one hit, one mistake, and one missed cell.
pub fn voxels() -> LogOddsGrid {
    let mut map = LogOddsGrid::unknown(info().spec);
    map.values_mut()[..3].copy_from_slice(&[1.0, 2.0, -1.0]);
    map
}

/// A ground plan of one hit, the rest unknown.
pub fn plan() -> PlanGrid {
    let mut plan = PlanGrid::unknown(info().spec.plan());
    plan.probabilities_mut()[0] = 0.75;
    plan
}

/// A safety map of one unsafe cell, the rest unknown.
pub fn safety() -> SafetyMap {
    let mut map = SafetyMap::unknown(info().spec.plan());
    map.set(0, SafetyLabel::NonGround, None);
    map
}

/// The 3-D model behind it: one voxel.
pub fn hybrid() -> HybridModel {
    HybridModel { spec: info().spec, voxels: vec![0], robot_m: [0.0; 3], robot_height_m: 1.0 }
}

/// Occupied voxels of the truth.
pub const OCCUPIED: [bool; 6] = [true, false, true, false, false, false];
/// Observed voxels of the truth.
pub const OBSERVED: [bool; 6] = [true, true, true, true, false, false];

/// Scores of the safety map against itself.
pub fn safety_scores() -> Scores {
    Scores::safety(&SafetyCase::new(&safety(), &SafetyReference::new(safety()), None))
}

/// The safety map against itself around a robot on its only unsafe cell, a hazard.
pub fn safety_tally() -> SafetyTally {
    let area = NamedArea { name: "kerb".into(), kind: "step".into(), is_safe: false, cells: vec![0] };
    let truth = SafetyReference::new(safety()).with_areas(vec![area]);
    let mut tally = SafetyTally::new(&truth);
    tally.add(&safety(), &truth, PlanningDisc { at_m: [0.1, 0.1], radius_m: 4.0 }, 0);
    tally
}

/// Final scores: voxels of both methods, plan of both (that of `line` by projection), safety labels of the
/// second.
pub fn result() -> RunResult {
    let info = info();
    let truth = VoxelReference { spec: &info.spec, occupied: &OCCUPIED, observed: &OBSERVED, in_view: None };
    let plan_truth = PlanReference {
        spec: info.spec.plan(),
        cells: OCCUPIED.map(|o| if o { PlanState::Occupied } else { PlanState::Free }).to_vec(),
    };
    let voxels = Scores::voxels_at_end(voxels().values(), &truth, &info.tolerances_m);
    let plan = Scores::plan(&plan(), &plan_truth);
    let safety = safety_scores();
    let method = |name: &str, scores: Vec<Scores>, safety| MethodResult {
        method: name.to_owned(),
        scores,
        safety,
        plan: None,
    };
    RunResult {
        methods: vec![
            method("line", vec![voxels.clone(), plan.clone()], None),
            method("all", vec![voxels, plan, safety], Some(safety_tally())),
        ],
        frames: 2,
        without_laser: vec![2],
        wall_ms: 0.0,
        stage_totals: Vec::new(),
    }
}
