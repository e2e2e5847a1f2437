//! Plans and safety maps, recorded and read back pixel by pixel.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use evigrid_core::{Frame, GrayImage, Pose, StereoRig};
use evigrid_eval::{Config, MethodStep, Observer, Step, Truth};
use evigrid_grid::{GridSettings, GridSpec, Layer, LayerKind, PlanGrid, PlanSpec, SafetyLabel, SafetyMap};
use evigrid_record::Recorder;
use evigrid_results::{MethodInfo, MethodResult, RunInfo, RunResult, SettingsText};
use evigrid_truth::TruthSettings;
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use rerun::{AnnotationContext, SegmentationImage};

const RIG: StereoRig =
    StereoRig { width: 8, height: 6, focal_px: 7.0, centre_x_px: 3.5, centre_y_px: 2.5, baseline_m: 0.5 };

fn info() -> RunInfo {
    let grid = GridSettings { x_m: [0.0, 3.0], y_m: [-1.0, 1.0], z_m: [-1.0, 1.0], cell_size_m: 1.0 };
    let layers = vec![LayerKind::Plan, LayerKind::Safety];
    RunInfo {
        dataset: "tiny".into(),
        layout: "by hand".into(),
        frames: vec![7],
        stride: 1,
        methods: vec![MethodInfo { name: "toy".into(), layers }],
        spec: GridSpec::new(&grid).unwrap(),
        tolerances_m: Vec::new(),
        truth: "laser",
        settings: SettingsText { json: Default::default(), toml: String::new(), hash: String::new() },
    }
}

/// Three cells forward from x = 5, two to the left from y = -3; rows from rear to front, each from right to
/// left. No mirror image and no turned one of it is the same.
fn area() -> PlanSpec {
    PlanSpec::of_area([5.0, 8.0], [-3.0, -1.0], 1.0).unwrap()
}

/// Occupied in the rear on the right; free in the rear on the left and in the middle on the right.
fn plan() -> PlanGrid {
    // Where the plan lies does not turn its picture.
    let turned = nalgebra::Isometry2::new([10.0, 20.0].into(), 1.0);
    let mut plan = PlanGrid::moving(area(), turned);
    plan.probabilities_mut()[..3].copy_from_slice(&[0.9, 0.1, 0.2]);
    plan
}

/// Level in the rear on the right, inclined in the rear on the left, unsafe in front on the left.
fn safety() -> SafetyMap {
    let mut map = SafetyMap::unknown(area());
    for (flat, label) in [(0, SafetyLabel::Level), (1, SafetyLabel::Inclined), (5, SafetyLabel::NonGround)] {
        map.set(flat, label, None);
    }
    map
}

/// Records one frame without any truth.
fn record(path: &Path) {
    let info = info();
    let (plan, safety) = (plan(), safety());
    let layers = vec![vec![Layer::from(&plan), Layer::from(&safety)]];
    let truth = Truth::laser(info.spec, TruthSettings::default()).unwrap();
    let image = || GrayImage::new(8, 6, vec![100; 48]).unwrap();
    let frame = Frame::new(7, 0, RIG, image(), image(), Pose::identity(), None).unwrap();
    let mut recorder = Recorder::create(path.to_owned()).unwrap();
    recorder.begin(&info, &Config::default()).unwrap();
    let methods = [MethodStep { method: "toy", layers: &layers[0], scores: &[] }];
    let step = Step { position: 0, frame: &frame, matching: None, truth: &truth, methods: &methods };
    recorder.frame(&step).unwrap();
    let result = RunResult {
        methods: vec![MethodResult { method: "toy".into(), scores: Vec::new() }],
        frames: 1,
        without_laser: vec![7],
        wall_ms: 0.0,
        stage_totals: Vec::new(),
    };
    for file in recorder.end(&result, &layers, &truth).unwrap() {
        file.publish().unwrap();
    }
}

/// All rows of an entity.
fn chunks(path: &Path, entity: &str) -> Vec<Chunk> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let messages = DecoderApp::decode_eager(file).unwrap().filter_map(|message| match message.unwrap() {
        LogMsg::ArrowMsg(_, chunk) => Some(Chunk::from_arrow_msg(&chunk).unwrap()),
        _ => None,
    });
    messages.filter(|chunk| chunk.entity_path().to_string() == entity).collect()
}

/// The only value of a component among all rows of an entity.
fn only<C: rerun::Component>(chunks: &[Chunk], component: rerun::ComponentIdentifier) -> C {
    let batches = chunks.iter().filter_map(|chunk| chunk.component_batch::<C>(component, 0));
    let mut values: Vec<C> = batches.flat_map(|batch| batch.unwrap()).collect();
    assert_eq!(values.len(), 1, "{component}");
    values.remove(0)
}

/// The picture of an entity as colours, row by row from the top.
fn colours(path: &Path, entity: &str) -> Vec<Vec<[u8; 3]>> {
    let chunks = chunks(path, entity);
    let buffer: rerun::components::ImageBuffer =
        only(&chunks, SegmentationImage::descriptor_buffer().component);
    let format: rerun::components::ImageFormat =
        only(&chunks, SegmentationImage::descriptor_format().component);
    let context: rerun::components::AnnotationContext =
        only(&chunks, AnnotationContext::descriptor_context().component);
    let colour = |number: &u8| {
        let class = context.0.iter().find(|class| class.class_id.0 == u16::from(*number)).unwrap();
        let [r, g, b, _] = class.class_description.info.color.unwrap().to_array();
        [r, g, b]
    };
    assert_eq!(buffer.0.len() as u32, format.width * format.height);
    buffer.0.chunks_exact(format.width as usize).map(|row| row.iter().map(colour).collect()).collect()
}

#[test]
fn a_plan_has_forward_to_the_right_and_left_upwards() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path);
    let (unknown, free, occupied) = ([24, 26, 30], [66, 70, 78], [176, 190, 205]);
    let expected = [[free, unknown, unknown], [occupied, free, unknown]];
    assert_eq!(colours(&path, "/plan/toy"), expected);
}

#[test]
fn a_safety_map_has_forward_to_the_right_and_left_upwards() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path);
    let (unknown, level, inclined, not_ground) = ([24, 26, 30], [0, 158, 115], [240, 228, 66], [213, 94, 0]);
    let expected = [[inclined, unknown, not_ground], [level, unknown, unknown]];
    assert_eq!(colours(&path, "/safety/toy"), expected);
}

#[test]
fn without_a_truth_nothing_is_judged() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path);
    let images = |entity: &str| {
        let component = SegmentationImage::descriptor_buffer().component;
        let chunks = chunks(&path, entity);
        chunks.iter().filter(|chunk| chunk.components().contains_component(component)).count()
    };
    assert_eq!([images("/safety/toy"), images("/safety_verdict/toy")], [1, 0]);
}
