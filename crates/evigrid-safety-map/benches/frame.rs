//! Time of one 640x480 frame on a map of 10 x 10 x 3 m in voxels of 0.1 m, stage by stage (Murarka and Kuipers
//! 2009, VII-D: model 92 ms, segmentation 4, planes 61, labels 71).
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use evigrid_core::{
    Disparity, Frame, GrayImage, MatchFilter, MatchLimits, Matching, Mounting, Pose, StereoRig, View,
    level_camera,
};
use evigrid_grid::{GridSettings, GridSpec, Mapper};
use evigrid_safety_map::{
    Columns, Model, Readings, Robot, SafetyMapPlusSettings, SafetyMapSettings, SafetyMapping, label_columns,
};
use nalgebra::{UnitQuaternion, Vector3};

const RIG: StereoRig = StereoRig {
    width: 640,
    height: 480,
    focal_px: 430.0,
    centre_x_px: 319.5,
    centre_y_px: 239.5,
    baseline_m: 0.12,
};
const MOUNTING: Mounting = Mounting::over_middle(1.0, 0.35);
const FRAMES: usize = 30;

fn pose(frame: usize) -> Pose {
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -MOUNTING.pitch_rad);
    Pose::from_parts(Vector3::new(0.033 + 0.05 * frame as f64, 0.013, 0.0).into(), level_camera() * tilt)
}

/// A floor with a ramp on the right, a drop of 0.5 m from 4 m on, and walls on the left and in front; the
/// disparities are off by up to a quarter of a pixel.
fn disparity(pose: &Pose) -> Disparity {
    let eye: [f64; 3] = pose.translation.vector.into();
    let value = |n: usize| {
        let ray: [f64; 3] = (pose.rotation * RIG.ray((n % RIG.width) as f64, (n / RIG.width) as f64)).into();
        let mut depth = f64::INFINITY;
        let mut plane = |height_m: f64, rise: f64, holds: &dyn Fn(f64, f64) -> bool| {
            let t = (height_m + rise * eye[0] - eye[2]) / (ray[2] - rise * ray[0]);
            if t > 0.0 && t < depth && holds(eye[0] + t * ray[0], eye[1] + t * ray[1]) {
                depth = t;
            }
        };
        plane(-1.0, 0.0, &|x, y| x < 4.0 && y > -1.0);
        plane(-1.5, 0.0, &|x, _| x >= 4.0);
        plane(-1.0 - 0.1 * 1.5, 0.1, &|x, y| y <= -1.0 && x > 1.5);
        plane(-1.0, 0.0, &|x, y| y <= -1.0 && x <= 1.5);
        let wall = (3.0 - eye[1]) / ray[1];
        let front = (7.0 - eye[0]) / ray[0];
        depth = [wall, front].into_iter().filter(|t| *t > 0.0).fold(depth, f64::min);
        let noise = ((n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / f64::from(1 << 24);
        (RIG.disparity_px(depth) + 0.5 * noise - 0.25) as f32
    };
    Disparity::new(RIG.width, RIG.height, (0..RIG.width * RIG.height).map(value).collect()).unwrap()
}

fn bench(c: &mut Criterion) {
    let settings = GridSettings { x_m: [-3.0, 7.0], y_m: [-5.0, 5.0], z_m: [-2.05, 0.95], cell_size_m: 0.1 };
    let (spec, paper) = (GridSpec::new(&settings).unwrap(), SafetyMapSettings::default());
    let matchings: Vec<Matching> =
        (0..FRAMES).map(|n| Matching::from_disparity(disparity(&pose(n)))).collect();
    let limits = MatchLimits::left_right(None);
    let mut model = Model::new(spec, paper);
    for (n, matching) in matchings.iter().enumerate() {
        model.update(&RIG, &pose(n), matching.matches.disparity.values());
    }
    let last = FRAMES - 1;
    let (at, filter) = (pose(last), MatchFilter::new(&matchings[last].matches, &limits));
    let robot = Robot::below(&at, MOUNTING);
    let mut group = c.benchmark_group("safety-map");
    group.bench_function("outliers", |b| {
        let mut readings = Readings::default();
        b.iter(|| readings.fill(&filter, RIG.width, RIG.height, 1.0)[0]);
    });
    group.bench_function("update", |b| {
        b.iter(|| model.update(&RIG, &at, matchings[last].matches.disparity.values()));
    });
    let mut columns = Columns::none(spec.plan());
    group.bench_function("columns", |b| b.iter(|| model.columns(&robot, &mut columns)));
    for (name, settings) in [("labels", paper), ("labels-plus", SafetyMapPlusSettings::default().0)] {
        let is_free = |column, height_m| model.is_free(column, height_m);
        let layer = ((robot.floor_m - spec.origin_m()[2]) / spec.cell_size_m()) as i32;
        let map = label_columns(&columns, &robot, layer, &settings, &is_free);
        eprintln!("{name}: {} planes, {} safe cells", map.planes().len(), safe(map.labels()));
        group.bench_function(name, |b| {
            b.iter(|| label_columns(&columns, &robot, layer, &settings, &is_free));
        });
    }
    let grey = || GrayImage::new(RIG.width, RIG.height, vec![0; RIG.width * RIG.height]).unwrap();
    let frames: Vec<Frame> =
        (0..FRAMES).map(|n| Frame::new(n, 0, RIG, grey(), grey(), pose(n), None).unwrap()).collect();
    group.sample_size(20);
    group.bench_function("whole_of_30", |b| {
        b.iter_batched(
            || SafetyMapping::new(spec, paper).unwrap(),
            |mut mapper| {
                for (frame, matching) in frames.iter().zip(&matchings) {
                    mapper.integrate(&View::new(frame, Some(MOUNTING), matching)).unwrap();
                }
                mapper
            },
            BatchSize::LargeInput,
        );
    });
}

fn safe(labels: &[evigrid_grid::SafetyLabel]) -> usize {
    labels.iter().filter(|label| label.is_safe() == Some(true)).count()
}

criterion_group!(benches, bench);
criterion_main!(benches);
