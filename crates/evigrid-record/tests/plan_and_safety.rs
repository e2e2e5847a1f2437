//! Plans, safety maps and the 3-D models behind them, recorded and read back element by element.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use evigrid_core::{Disparity, Frame, GrayImage, Matching, Pose, StereoRig};
use evigrid_eval::{Config, LazyModel, LazyPictures, MethodStep, Observer, Step, Truth};
use evigrid_grid::{
    GridSettings, GridSpec, HybridModel, Layer, LayerKind, PlanGrid, PlanSpec, SafetyLabel, SafetyMap,
    SafetyPlane,
};
use evigrid_record::Recorder;
use evigrid_results::{MethodInfo, MethodMaps, MethodResult, RunInfo, RunResult, SettingsText};
use evigrid_truth::TruthSettings;
use rerun::components::{Color, Position3D, TriangleIndices, Vector3D, VoxelIndex};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use rerun::{AnnotationContext, Mesh3D, SegmentationImage, VoxelGridMap};

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

/// Level in the rear on the right, on a plane at z = -0.5; inclined in the rear on the left, on none; unsafe in
/// front on the left.
fn safety() -> SafetyMap {
    let mut map = SafetyMap::unknown(area());
    let plane = map.add_plane(SafetyPlane { normal: nalgebra::Vector3::z(), offset_m: -0.5 });
    map.set(0, SafetyLabel::Level, Some(plane));
    map.set(1, SafetyLabel::Inclined, None);
    map.set(5, SafetyLabel::NonGround, None);
    map
}

/// Two layers of voxels over that area: the upper one over the level cell, the lower one of an unknown cell, both
/// of the unsafe one.
fn hybrid() -> HybridModel {
    let grid = GridSettings { x_m: [5.0, 8.0], y_m: [-3.0, -1.0], z_m: [-1.0, 1.0], cell_size_m: 1.0 };
    let spec = GridSpec::new(&grid).unwrap();
    let voxels = [[0, 0, 1], [1, 1, 0], [2, 1, 0], [2, 1, 1]].map(|v| spec.flat(v).unwrap() as u32);
    HybridModel { spec, voxels: voxels.to_vec(), robot_m: [5.5, -2.0, -0.5], robot_height_m: 1.25 }
}

/// Records one frame without any truth.
fn record(path: &Path) {
    let info = info();
    let (plan, safety) = (plan(), safety());
    let mut layers = vec![vec![Layer::from(&plan), Layer::from(&safety)]];
    let truth = Truth::laser(info.spec, TruthSettings::default()).unwrap();
    let image = || GrayImage::new(8, 6, vec![100; 48]).unwrap();
    let frame = Frame::new(7, 0, RIG, image(), image(), Pose::identity(), None).unwrap();
    // At 15.4 m the pixel in column 7, row 2 shows (7.7, -1.1), the unsafe cell; all others look past the map.
    let mut disparity = vec![0.001; 48];
    disparity[2 * 8 + 7] = 0.5 * 7.0 / 15.4;
    let matching = Matching::from_disparity(Disparity::new(8, 6, disparity).unwrap());
    let mut recorder = Recorder::create(path.to_owned()).unwrap();
    recorder.begin(&info, &Config::default()).unwrap();
    let model = || Some(hybrid());
    let methods = [MethodStep {
        method: "toy",
        layers: &layers[0],
        scores: &[],
        hybrid: LazyModel::new(&model),
        pictures: LazyPictures::NONE,
    }];
    let step =
        Step { position: 0, frame: &frame, matching: Some(&matching), truth: &truth, methods: &methods };
    recorder.frame(&step).unwrap();
    let result = RunResult {
        methods: vec![MethodResult { method: "toy".into(), scores: Vec::new(), safety: None, plan: None }],
        frames: 1,
        without_laser: vec![7],
        wall_ms: 0.0,
        stage_totals: Vec::new(),
    };
    for file in recorder.end(&result, &[MethodMaps::from(layers.remove(0))], &truth).unwrap() {
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

/// The recording in a folder of its own.
fn recorded() -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("recording.rrd");
    record(&path);
    (dir, path)
}

/// The values of a component in all rows of an entity.
fn all<C: rerun::Component>(chunks: &[Chunk], component: rerun::ComponentIdentifier) -> Vec<C> {
    let batches = chunks.iter().filter_map(|chunk| chunk.component_batch::<C>(component, 0));
    batches.flat_map(|batch| batch.unwrap()).collect()
}

/// The only value of a component among all rows of an entity.
fn only<C: rerun::Component>(chunks: &[Chunk], component: rerun::ComponentIdentifier) -> C {
    let mut values: Vec<C> = all(chunks, component);
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
    let (_dir, path) = recorded();
    let (unknown, free, occupied) = ([24, 26, 30], [66, 70, 78], [176, 190, 205]);
    let expected = [[free, unknown, unknown], [occupied, free, unknown]];
    assert_eq!(colours(&path, "/plan/toy"), expected);
}

#[test]
fn a_safety_map_has_forward_to_the_right_and_left_upwards() {
    let (_dir, path) = recorded();
    let (unknown, level, inclined, not_ground) =
        ([112, 116, 124], [0, 114, 178], [86, 180, 233], [230, 130, 0]);
    let expected = [[inclined, unknown, not_ground], [level, unknown, unknown]];
    assert_eq!(colours(&path, "/safety/toy"), expected);
}

#[test]
fn safe_ground_is_a_mesh_on_its_plane() {
    let (_dir, path) = recorded();
    let ground = chunks(&path, "/world/hybrid/toy/ground");
    let corners: Vec<Position3D> = all(&ground, Mesh3D::descriptor_vertex_positions().component);
    let corners: Vec<[f32; 3]> = corners.into_iter().map(|p| p.0.0).collect();
    assert_eq!(corners, [[5.0, -3.0, -0.5], [6.0, -3.0, -0.5], [6.0, -2.0, -0.5], [5.0, -2.0, -0.5]]);
    let triangles: Vec<TriangleIndices> = all(&ground, Mesh3D::descriptor_triangle_indices().component);
    let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|t| t.0.0).collect();
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    let colours: Vec<Color> = all(&ground, Mesh3D::descriptor_vertex_colors().component);
    assert_eq!(colours, [Color::from_rgb(0, 114, 178); 4]);
}

#[test]
fn voxels_stand_by_the_label_of_their_column_and_the_robot_on_its_floor() {
    let (_dir, path) = recorded();
    let voxels = |group: &str| -> Vec<[i32; 3]> {
        let chunks = chunks(&path, &format!("/world/hybrid/toy/voxels/{group}"));
        let found: Vec<VoxelIndex> = all(&chunks, VoxelGridMap::descriptor_voxel_indices().component);
        found.into_iter().map(|v| v.0.0).collect()
    };
    assert_eq!(voxels("non_ground"), [[2, 1, 0], [2, 1, 1]]);
    assert_eq!(voxels("unknown"), [[1, 1, 0]]);
    assert_eq!(voxels("over_safe_ground"), [[0, 0, 1]]);
    let robot = chunks(&path, "/world/hybrid/toy/robot");
    let origins: Vec<Position3D> = all(&robot, rerun::Arrows3D::descriptor_origins().component);
    assert!(origins.iter().all(|p| p.0.0 == [5.5, -2.0, -0.5]), "{origins:?}");
    let vectors: Vec<Vector3D> = all(&robot, rerun::Arrows3D::descriptor_vectors().component);
    assert_eq!((vectors.len(), vectors[1].0.0), (2, [0.0, 0.0, 1.25]));
}

#[test]
fn labels_lie_over_the_pixels_that_show_their_cells() {
    let (_dir, path) = recorded();
    let mut expected = vec![vec![[0, 0, 0]; 8]; 6];
    expected[2][7] = [230, 130, 0];
    assert_eq!(colours(&path, "/world/left/image/labels/toy"), expected);
}

#[test]
fn without_a_truth_nothing_is_judged() {
    let (_dir, path) = recorded();
    let images = |entity: &str| {
        let component = SegmentationImage::descriptor_buffer().component;
        let chunks = chunks(&path, entity);
        chunks.iter().filter(|chunk| chunk.components().contains_component(component)).count()
    };
    assert_eq!([images("/safety/toy"), images("/safety_verdict/toy")], [1, 0]);
}
