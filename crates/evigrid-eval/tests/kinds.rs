//! Maps of every kind go through the whole harness: truth, scores, tables, files, sweeps. Methods from
//! outside are refused where a run cannot give what they need.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::HashMap;
use std::path::Path;

use evigrid_core::{SettingError, View};
use evigrid_eval::{Config, Plan, RealClock, Sweep, SweepPlan, TableWriter, evaluate, run_sweep};
use evigrid_grid::{
    GridSpec, Layer, LayerKind, MapError, Mapper, Method, Needs, PlanGrid, PlanSpec, SafetyLabel, SafetyMap,
};
use evigrid_methods::Methods;
use evigrid_results::npz::Npz;
use evigrid_results::{ResultsFolder, RunResult};
use evigrid_truth::TruthSource;

/// How far the toy says that space is occupied, in a plan that moves with the camera; all the rest is free.
/// Every cell of its safety map is level.
struct Toy<const NEED: usize> {
    plan: PlanGrid,
    safety: SafetyMap,
    occupied_to_m: f64,
}

#[derive(Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct ToySettings {
    /// Forward distance. Unit: m. Source: this test.
    occupied_to_m: f64,
}

impl Default for ToySettings {
    fn default() -> Self {
        Self { occupied_to_m: 12.0 }
    }
}

/// The toys differ in what they need beyond poses: nothing, the mounting, road and obstacles apart, costs.
const NEEDS: [Needs; 4] = [
    Needs::NOTHING,
    Needs { mounting: true, ..Needs::NOTHING },
    Needs { matches: true, road: true, ..Needs::NOTHING },
    Needs::COSTS,
];

impl<const NEED: usize> Method for Toy<NEED> {
    const NAME: &'static str = ["toy", "toy-mounting", "toy-road", "toy-costs"][NEED];
    const SUMMARY: &'static str = "a plan that moves, and a level world";
    const NEEDS: Needs = NEEDS[NEED];
    const LAYERS: &'static [LayerKind] = &[LayerKind::Plan, LayerKind::Safety];
    type Settings = ToySettings;

    fn build(spec: GridSpec, settings: &ToySettings) -> Result<Box<dyn Mapper>, SettingError> {
        let area = PlanSpec::of_area([0.0, 20.0], [-4.0, 4.0], 0.5).unwrap();
        let mut safety = SafetyMap::unknown(spec.plan());
        (0..spec.plan().cell_count()).for_each(|n| safety.set(n, SafetyLabel::Level, None));
        let occupied_to_m = settings.occupied_to_m;
        Ok(Box::new(Self { plan: PlanGrid::unknown(area), safety, occupied_to_m }))
    }
}

impl<const NEED: usize> Mapper for Toy<NEED> {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let [x, y] = [view.map_from_left.translation.x, view.map_from_left.translation.y];
        self.plan.move_to(nalgebra::Isometry2::translation(x, y));
        for n in 0..self.plan.spec().cell_count() {
            let is_occupied = self.plan.spec().centre_m(n)[0] < self.occupied_to_m;
            self.plan.probabilities_mut()[n] = if is_occupied { 0.75 } else { 0.25 };
        }
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.plan), Layer::from(&self.safety)]
    }
}

fn methods() -> Methods {
    Methods::default().with::<Toy<0>>().with::<Toy<1>>().with::<Toy<2>>().with::<Toy<3>>()
}

fn config(dataset: &str, method: &str, truth: TruthSource) -> Config {
    let mut config = Config::of(methods());
    config.run.dataset = dataset.into();
    config.run.frames = "0..2".into();
    config.run.methods = vec![method.into()];
    config.grid.x_m = [0.0, 30.0];
    config.truth.source = truth;
    config
}

fn run(config: Config, out: &Path) -> RunResult {
    let plan = Plan::new(config).unwrap();
    let (folder, _) = ResultsFolder::open(out).unwrap();
    let mut tables = TableWriter::create(&folder, &plan.job.info, serde_json::Value::Null).unwrap();
    evaluate(&plan, &RealClock::default(), &folder, &mut [&mut tables]).unwrap()
}

fn rows(table: &Path) -> Vec<HashMap<String, String>> {
    csv::Reader::from_path(table).unwrap().deserialize().map(Result::unwrap).collect()
}

/// An array of an npz file, by columns of its last axis.
fn array(file: &Path, name: &str) -> Vec<f64> {
    let bytes = std::fs::read(file).unwrap();
    Npz::new(&bytes).unwrap().array(name).unwrap().values
}

/// The plan of the toy on truth.npz, counted cell by cell: hits, mistakes, missed.
fn count_plan(out: &Path, levels: std::ops::Range<i64>, camera_x_m: f64) -> [usize; 3] {
    let cells = |name: &str| -> std::collections::BTreeSet<[i64; 2]> {
        let indices = array(&out.join("truth.npz"), name);
        let inside = indices.chunks_exact(3).filter(|v| levels.contains(&(v[2] as i64)));
        inside.map(|v| [v[0] as i64, v[1] as i64]).collect()
    };
    let (occupied, observed) = (cells("occupied"), cells("observed"));
    let mut counts = [0; 3];
    let mut covered = std::collections::BTreeSet::new();
    for i in 0..40 {
        for j in 0..16 {
            let (x, y) = (camera_x_m + (i as f64 + 0.5) * 0.5, -4.0 + (j as f64 + 0.5) * 0.5);
            let cell = [(x / 0.2).floor() as i64, ((y + 5.0) / 0.2).floor() as i64];
            let (is_true, is_occupied) = (occupied.contains(&cell), (i as f64 + 0.5) * 0.5 < 12.0);
            if is_true || observed.contains(&cell) {
                counts[0] += usize::from(is_true && is_occupied);
                counts[1] += usize::from(!is_true && is_occupied);
                counts[2] += usize::from(is_true && !is_occupied);
                covered.insert(cell);
            }
        }
    }
    let in_area = |cell: &[i64; 2]| {
        let (x, y) = ((cell[0] as f64 + 0.5) * 0.2 - camera_x_m, (cell[1] as f64 + 0.5) * 0.2 - 5.0);
        (0.0..20.0).contains(&x) && (-4.0..4.0).contains(&y)
    };
    counts[2] += occupied.iter().filter(|cell| !in_area(cell)).count();
    counts
}

#[test]
fn plans_and_safety_maps_have_tables_files_and_scores_that_can_be_counted_again() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path();
    let config = config("synth:safety-1", "toy", TruthSource::Exact);
    let plan = Plan::new(config.clone()).unwrap();
    let height_m = plan.job.mounting.unwrap().height_m;
    // Centres of voxels from 0.3 m to 1.8 m over the ground, which is as far below the camera as it is high.
    let centre = |k: i64| -2.0 + (k as f64 + 0.5) * 0.2 + height_m;
    let levels: Vec<i64> = (0..20).filter(|k| (0.3..1.8).contains(&centre(*k))).collect();
    let result = run(config, out);
    let camera_x_m = array(&out.join("plan.toy.npz"), "map_from_plan")[0];
    let expected = count_plan(out, levels[0]..levels[levels.len() - 1] + 1, camera_x_m);
    let row = &rows(&out.join("summary.plan.csv"))[0];
    let found = ["plan_hits", "plan_mistakes", "plan_missed"].map(|c| row[c].parse::<usize>().unwrap());
    assert_eq!(found, expected);
    assert!(expected[0] > 0 && expected[1] > 0 && expected[2] > 0, "{expected:?}");

    let truth = array(&out.join("truth.safety.npz"), "labels");
    let is = |label: SafetyLabel| truth.iter().filter(|l| **l == f64::from(label as u8)).count() as f64;
    let (safe, unsafe_cells) =
        (is(SafetyLabel::Level) + is(SafetyLabel::Inclined), is(SafetyLabel::NonGround));
    assert!(safe > 0.0 && unsafe_cells > 0.0);
    let row = &rows(&out.join("summary.safety.csv"))[0];
    let found = ["safety_fn_rate", "safety_fp_rate", "safety_unclassified", "safety_unsafe_found"]
        .map(|c| row[c].parse::<f64>().unwrap());
    assert_eq!(found, [1.0, 0.0, 0.0, 0.0], "everything is called level");

    assert_eq!(rows(&out.join("frames.plan.csv")).len(), 2);
    assert_eq!(rows(&out.join("frames.safety.csv")).len(), 2);
    assert_eq!(rows(&out.join("summary.csv"))[0]["hits"], "", "there are no voxels to score");
    assert!(out.join("safety.toy.npz").is_file() && !out.join("map.toy.npz").exists());
    let main = result.methods[0].scores.iter().map(|s| s.main().unwrap().metric.name);
    assert_eq!(main.collect::<Vec<_>>(), ["plan_f1", "safety_unsafe_found"]);
}

#[test]
fn a_sweep_ranks_plans_by_their_own_metric() {
    let dir = tempfile::tempdir().unwrap();
    let run = config("synth:safety-1", "toy", TruthSource::Exact);
    let sweep = Sweep::new(SweepPlan::around(run, &["toy.occupied_to_m=[0, 12]".into()]).unwrap()).unwrap();
    let (out, build) = (dir.path().join("out"), serde_json::json!({"version": "1", "commit": "x"}));
    run_sweep(&sweep, &out, &build, &RealClock::default(), &mut |_| ()).unwrap();
    let points = rows(&out.join("points.csv"));
    assert_eq!(points.len(), 2);
    assert!(!points[0].contains_key("hits") && points[0]["plan_hits"] == "0", "{:?}", points[0]);
    let page = std::fs::read_to_string(out.join("sweep.md")).unwrap();
    assert!(page.contains("Highest F1: toy on safety-1, toy.occupied_to_m = 12"), "{page}");
    assert!(page.contains("Highest unsafe found"), "{page}");
    assert_eq!(rows(&out.join("curves.safety-1.csv"))[1]["plan_hits"], points[1]["plan_hits"]);
}

/// Points of one pass that differ in what they are told of the ground are scored each with its own ground.
#[test]
fn points_with_another_mounting_have_another_ground_plan() {
    let dir = tempfile::tempdir().unwrap();
    let base = config("synth:safety-1", "toy", TruthSource::Laser);
    let key = "input.mounting=[[0.9, 0.0], [1.9, 0.0]]".to_owned();
    let sweep = Sweep::new(SweepPlan::around(base.clone(), &[key]).unwrap()).unwrap();
    let (out, build) = (dir.path().join("out"), serde_json::json!({"version": "1", "commit": "x"}));
    run_sweep(&sweep, &out, &build, &RealClock::default(), &mut |_| ()).unwrap();
    let found = rows(&out.join("points.csv"));
    for (row, height_m) in found.iter().zip([0.9, 1.9]) {
        let mut alone = base.clone();
        alone.input.mounting = vec![height_m, 0.0];
        let single = dir.path().join(height_m.to_string());
        run(alone, &single);
        let expected = &rows(&single.join("summary.plan.csv"))[0];
        for column in ["plan_hits", "plan_mistakes", "plan_missed"] {
            assert_eq!(row[column], expected[column], "{column} at {height_m} m");
        }
    }
    assert_ne!(found[0]["plan_missed"], found[1]["plan_missed"]);
}

/// The one line that says why a run is refused.
fn refusal(config: Config) -> String {
    let message = format!("{:#}", Plan::new(config).unwrap_err());
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn needs_that_cannot_be_met_are_refused_before_the_first_frame() {
    let on = |dataset: &str, method: &str| config(dataset, method, TruthSource::Laser);
    let no_ground = refusal(on("synth:andert-flight-posts", "toy-mounting"));
    assert!(
        no_ground.contains("input.mounting: expected [height_m, pitch_deg] for `toy-mounting`"),
        "{no_ground}"
    );
    let mut told = on("synth:andert-flight-posts", "toy-mounting");
    told.input.mounting = vec![1.5, -2.0];
    let mounting = Plan::new(told).unwrap().job.mounting.unwrap();
    assert!((mounting.height_m, mounting.pitch_rad) == (1.5, (-2.0_f64).to_radians()));
    assert!(Plan::new(on("synth:street", "toy-mounting")).is_ok(), "the world tells it");

    let no_road = refusal(on("synth:street", "toy-road"));
    assert!(no_road.contains("stereo.matcher") && no_road.contains("`toy-road`"), "{no_road}");
    let mut cuts = on("synth:street", "toy-costs");
    cuts.stereo.matcher = evigrid_stereo::MatcherKind::GraphCuts;
    let no_costs = refusal(cuts);
    assert!(no_costs.contains("expected block or semi-global for `toy-costs`"), "{no_costs}");
    let mut elsewhere = on("synth:street", "toy-costs");
    elsewhere.input.disparity_dir = "somewhere".into();
    assert!(refusal(elsewhere).contains("input.disparity_dir: expected none for `toy-costs`"));
}
