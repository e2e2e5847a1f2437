//! A run of two frames on a map of a few cells, recorded and read back.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;

use evigrid_core::{Disparity, Frame, GrayImage, LaserScan, Matching, Pose, StereoRig};
use evigrid_eval::{Config, LazyModel, LazyPictures, MethodStep, Observer, Step, Truth};
use evigrid_grid::{GridSettings, GridSpec, Layer, LayerKind, LogOddsGrid};
use evigrid_metrics::Scores;
use evigrid_record::Recorder;
use evigrid_results::{MethodInfo, MethodMaps, MethodResult, RunInfo, RunResult, SettingsText};
use evigrid_truth::TruthSettings;
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};

const RIG: StereoRig =
    StereoRig { width: 8, height: 6, focal_px: 7.0, centre_x_px: 3.5, centre_y_px: 2.5, baseline_m: 0.5 };

fn info() -> RunInfo {
    let grid = GridSettings { x_m: [0.0, 30.0], y_m: [-2.0, 2.0], z_m: [-1.0, 1.0], cell_size_m: 1.0 };
    let spec = GridSpec::new(&grid).unwrap();
    let method = |name: &str| MethodInfo { name: name.into(), layers: vec![LayerKind::Voxels] };
    RunInfo {
        dataset: "tiny".into(),
        layout: "by hand".into(),
        frames: vec![3, 5],
        stride: 2,
        methods: ["first", "second"].map(method).to_vec(),
        spec,
        tolerances_m: Vec::new(),
        truth: "laser",
        settings: SettingsText { json: Default::default(), toml: String::new(), hash: String::new() },
    }
}

/// Frame 5 has a laser scan: one ray straight ahead that ends in the cell at x 4..5, y 0..1, z 0..1.
fn frame(index: usize) -> Frame {
    let image = || GrayImage::new(8, 6, vec![100; 48]).unwrap();
    let pose = Pose::translation(index as f64, 0.0, 0.0);
    let map_from_laser = Pose::translation(0.5, 0.5, 0.5);
    let scan = (index == 5).then(|| LaserScan::new(vec![[4.0, 0.0, 0.0]], map_from_laser).unwrap());
    Frame::new(index, index as i64 * 100_000_000, RIG, image(), image(), pose, scan).unwrap()
}

/// Occupied at x 4..5 (the laser will say: hit), 2..3 (mistake) and 25..26 (unobserved), straight ahead.
fn map(spec: GridSpec) -> LogOddsGrid {
    let mut map = LogOddsGrid::unknown(spec);
    for x in [4.5, 2.5, 25.5] {
        map.values_mut()[spec.cell_of([x, 0.5, 0.5]).unwrap()] = 1.0;
    }
    map
}

/// Runs two frames; stops before the end if `whole` is false.
fn record(path: &Path, whole: bool) {
    let info = info();
    let mut recorder = Recorder::create(path.to_owned()).unwrap();
    recorder.begin(&info, &Config::default()).unwrap();
    let mut truth = Truth::laser(info.spec, TruthSettings::default()).unwrap();
    let (map, empty) = (map(info.spec), LogOddsGrid::unknown(info.spec));
    let layers = [vec![Layer::from(&map)], vec![Layer::from(&empty)]];
    let matching = Matching::from_disparity(Disparity::new(8, 6, vec![2.0; 48]).unwrap());
    for (position, &index) in info.frames.iter().enumerate() {
        let frame = frame(index);
        truth.add(&frame);
        let scores: Vec<Scores> =
            truth.voxels().map(|truth| Scores::voxels(map.values(), &truth, &[])).into_iter().collect();
        let methods = [
            MethodStep {
                method: "first",
                layers: &layers[0],
                scores: &scores,
                hybrid: LazyModel::NONE,
                pictures: LazyPictures::NONE,
            },
            MethodStep {
                method: "second",
                layers: &layers[1],
                scores: &scores,
                hybrid: LazyModel::NONE,
                pictures: LazyPictures::NONE,
            },
        ];
        let matching = Some(&matching);
        let step = Step { position, frame: &frame, matching, truth: &truth, methods: &methods };
        recorder.frame(&step).unwrap();
    }
    if !whole {
        return;
    }
    let reference = truth.voxels().unwrap();
    let methods = [("first", &map), ("second", &empty)].map(|(name, map)| MethodResult {
        method: name.into(),
        scores: vec![Scores::voxels_at_end(map.values(), &reference, &[])],
        safety: None,
        plan: None,
    });
    let result = RunResult {
        methods: methods.to_vec(),
        frames: 2,
        without_laser: vec![3],
        wall_ms: 0.0,
        stage_totals: Vec::new(),
    };
    for file in recorder.end(&result, &layers.clone().map(MethodMaps::from), &truth).unwrap() {
        file.publish().unwrap();
    }
}

/// All rows of a file: entity path -> for each row, its frame (none if static) and the number of its values.
fn rows(path: &Path) -> BTreeMap<String, Vec<(Option<i64>, usize)>> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut rows: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for message in DecoderApp::decode_eager(file).unwrap() {
        if let LogMsg::ArrowMsg(_, chunk) = message.unwrap() {
            let chunk = Chunk::from_arrow_msg(&chunk).unwrap();
            let frame = chunk.timelines().values().find(|t| t.timeline().name().as_str() == "frame");
            let frame = frame.map(|column| column.times_raw()[0]);
            let values = chunk.components().list_arrays().map(|l| l.value_length(0) as usize).max();
            rows.entry(chunk.entity_path().to_string()).or_default().push((frame, values.unwrap_or(0)));
        }
    }
    rows
}

fn names(dir: &Path) -> Vec<String> {
    let names = std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    names.collect()
}

#[test]
fn every_class_of_every_block_is_written_when_it_changes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path, true);
    assert_eq!(names(dir.path()), ["recording.rrd"]);
    let rows = rows(&path);
    let blocks = |class: &str| {
        let prefix = format!("/world/map/first/{class}/");
        let below = rows.iter().filter_map(|(path, rows)| Some((path.strip_prefix(&prefix)?, &rows[..])));
        below.collect::<Vec<_>>()
    };
    // The first row of each gives colour and size, once and for all. Without a laser cells are only occupied;
    // with the first scan, of frame 5, they are hits and mistakes, and the occupied ones are gone.
    let look = (None, 1);
    let occupied_0 = [look, (Some(3), 2), (Some(5), 0)];
    let occupied_1 = [look, (Some(3), 1), (Some(5), 0)];
    assert_eq!(blocks("occupied"), [("block_0_0_0", &occupied_0[..]), ("block_1_0_0", &occupied_1[..])]);
    let once = [look, (Some(5), 1)];
    assert_eq!(blocks("hit"), [("block_0_0_0", &once[..])]);
    assert_eq!(blocks("mistake"), [("block_0_0_0", &once[..])]);
    assert_eq!(blocks("mistake_unobserved"), [("block_1_0_0", &once[..])]);
    assert_eq!(blocks("missed"), []);
    assert_eq!(rows["/world/map/second/missed/block_0_0_0"], once, "the other map has nothing");
}

#[test]
fn camera_scores_curve_and_summary_are_there() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path, true);
    let rows = rows(&path);
    let frames = |path: &str| rows[path].iter().map(|r| r.0).collect::<Vec<_>>();
    assert_eq!(frames("/world/left"), [Some(3), Some(5)]);
    // The pinhole once, the image twice.
    assert_eq!(frames("/world/left/image"), [Some(3), Some(3), Some(5)]);
    assert_eq!(frames("/disparity"), [None, Some(3), Some(5)]);
    assert_eq!(frames("/rates/first"), [None, Some(5)], "no scores without a laser");
    assert_eq!(frames("/top_view/first"), [None, Some(3), Some(5)]);
    for path in ["/summary", "/curve/axes", "/curve/first", "/curve/second"] {
        assert_eq!(frames(path), [None], "{path}");
    }
}

#[test]
fn equal_runs_into_the_same_file_give_the_same_messages() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    let [first, second] = [(); 2].map(|()| {
        record(&path, true);
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let messages = DecoderApp::decode_eager(file).unwrap().map(Result::unwrap);
        messages
            .filter_map(|message| match message {
                LogMsg::ArrowMsg(store, chunk) => Some((store, chunk.chunk_id, chunk.batch.clone())),
                _ => None,
            })
            .collect::<Vec<_>>()
    });
    assert!(first.len() > 50 && first == second);
}

#[test]
fn a_run_that_stops_leaves_the_old_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path, false);
    assert!(names(dir.path()).is_empty());
    std::fs::write(&path, "old").unwrap();
    record(&path, false);
    assert_eq!(names(dir.path()), ["recording.rrd"]);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
}

#[test]
fn an_unwritable_path_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("nowhere/recording.rrd");
    let message = format!("{:#}", Recorder::create(path.clone()).unwrap_err());
    assert!(message.starts_with(&format!("cannot write {}: ", path.display())), "{message}");
}
