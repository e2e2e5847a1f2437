//! Time of one frame by each method: from costs or winners to evidence, drawing and fusion.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::{
    CostScale, CostVolume, Disparity, Frame, GrayImage, Matches, Matching, NO_COST, Pose, StereoRig, View,
    level_camera,
};
use evigrid_cost_curve::{
    CostCurve, CostCurveBayes, CostCurveBayesSettings, CostCurveSettings, CostUnit, WinnerTakeAll,
    WinnerTakeAllSettings,
};
use evigrid_grid::{GridSettings, GridSpec, Mapper};
use nalgebra::{UnitQuaternion, Vector3};

/// Camera above the road, metres.
const HEIGHT_M: f64 = 1.65;
/// Walls on either side of the camera, metres to the right.
const WALLS_M: [f64; 2] = [-4.2, 6.5];

/// A whole number below 1000 that looks random, from a pixel's index.
fn noise(pixel: usize, salt: u64) -> f64 {
    let mut h =
        (pixel as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((h >> 40) % 1000) as f64
}

/// A road between walls under the sky, a car 9 m ahead; disparities off by up to half a pixel, 3 % of them
/// wild, and 30 % of the pixels without a clear winner.
fn road(rig: &StereoRig) -> Matches {
    let (mut disparity, mut peak_ratio) = (Vec::new(), Vec::new());
    for pixel in 0..rig.width * rig.height {
        let ray = rig.ray((pixel % rig.width) as f64, (pixel / rig.width) as f64);
        let ground = if ray.y > 0.0 { HEIGHT_M / ray.y } else { f64::INFINITY };
        let wall = WALLS_M.map(|x| if x * ray.x > 0.0 { x / ray.x } else { f64::INFINITY });
        let car =
            if (ray.x * 9.0).abs() < 0.9 && (0.2..HEIGHT_M).contains(&(ray.y * 9.0)) { 9.0 } else { 80.0 };
        let depth = ground.min(wall[0]).min(wall[1]).min(car);
        let wild = noise(pixel, 1) < 30.0;
        let d = if wild {
            noise(pixel, 2) * 0.06
        } else {
            rig.disparity_px(depth) + noise(pixel, 3) * 1e-3 - 0.5
        };
        disparity.push(d.max(0.0) as f32);
        peak_ratio.push(if noise(pixel, 4) < 300.0 { 1.1 } else { 2.5 });
    }
    let left_right_difference_px = vec![0; disparity.len()];
    Matches {
        disparity: Disparity::new(rig.width, rig.height, disparity).unwrap(),
        peak_ratio,
        left_right_difference_px,
    }
}

/// A camera that looks forward, slightly turned, as on a car.
fn pose() -> Pose {
    Pose::from_parts(
        Vector3::new(3.17, 0.13, 0.02).into(),
        UnitQuaternion::from_euler_angles(0.01, 0.02, 0.05) * level_camera(),
    )
}

/// Costs that rise on both sides of the disparity as SAD of 7x7 windows does, under noise; every tenth column
/// has a second, nearly as good match. No cost where the windows do not fit into both images.
fn costs(rig: &StereoRig, matches: &Matches, disparities: usize) -> CostVolume {
    let mut costs = Vec::with_capacity(rig.width * rig.height * disparities);
    for y in 0..rig.height {
        let inside = (3..rig.height - 3).contains(&y);
        for d in 0..disparities {
            for x in 0..rig.width {
                let pixel = y * rig.width + x;
                let off = |centre: f64| (d as f64 - centre).abs();
                let winner = f64::from(matches.disparity.values()[pixel]);
                let second = if x % 10 == 0 { off(winner * 0.5) } else { 99.0 };
                let cost = 200.0
                    + 120.0 * off(winner).min(second).min(6.0)
                    + noise(pixel * disparities + d, 5) * 0.4;
                let fits = inside && x >= d + 3 && x + 3 < rig.width;
                costs.push(if fits { cost as u16 } else { NO_COST });
            }
        }
    }
    let scale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };
    CostVolume::new(rig.width, rig.height, 0, disparities, scale, costs).unwrap()
}

/// Images whose differences at the winners vary by about 100 grey levels^2.
fn images(rig: &StereoRig) -> [GrayImage; 2] {
    [6, 7].map(|salt| {
        let pixels = (0..rig.width * rig.height).map(|p| 100 + (noise(p, salt) * 0.0245) as u8).collect();
        GrayImage::new(rig.width, rig.height, pixels).unwrap()
    })
}

/// A rig with its principal point near the middle of the image.
fn rig(width: usize, height: usize, focal_px: f64, baseline_m: f64) -> StereoRig {
    let (centre_x_px, centre_y_px) = (width as f64 * 0.49, height as f64 * 0.46);
    StereoRig { width, height, focal_px, centre_x_px, centre_y_px, baseline_m }
}

fn frame(rig: &StereoRig) -> Frame {
    let [left, right] = images(rig);
    Frame::new(0, 0, *rig, left, right, pose(), None).unwrap()
}

fn bench_cost_curve(c: &mut Criterion) {
    let mut group = c.benchmark_group("cost_curve");
    group.sample_size(20);
    let rigs = [
        ("kitti_1242x375_128", rig(1242, 375, 721.5, 0.537), 128),
        ("vga_640x480_64", rig(640, 480, 500.0, 0.3), 64),
        ("qvga_320x240_32", rig(320, 240, 250.0, 0.3), 32),
    ];
    for (name, rig, disparities) in rigs {
        let (frame, matches) = (frame(&rig), road(&rig));
        let volume = costs(&rig, &matches, disparities);
        let matching = Matching { volume: Some(volume), ..Matching::from(matches) };
        let view = View::new(&frame, None, &matching);
        let spec = GridSpec::new(&GridSettings::default()).unwrap();
        let curve = |cost_unit| {
            let settings = CostCurveSettings { cost_unit, ..CostCurveSettings::default() };
            Box::new(CostCurve::new(spec, settings).unwrap()) as Box<dyn Mapper>
        };
        let bayes = CostCurveBayes::new(spec, CostCurveBayesSettings::default()).unwrap();
        let mappers = [
            ("", curve(CostUnit::GreyLevels)),
            ("/homogeneous", curve(CostUnit::Homogeneous)),
            ("/bayes", Box::new(bayes)),
        ];
        for (kind, mut mapper) in mappers {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                group.bench_function(format!("{name}{kind}/{threads}"), |b| {
                    b.iter(|| pool.install(|| mapper.integrate(&view)).unwrap());
                });
            }
        }
    }
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("integrate");
    let rigs = [("kitti_1242x375", rig(1242, 375, 721.5, 0.537)), ("vga_640x480", rig(640, 480, 500.0, 0.3))];
    for (name, rig) in rigs {
        let (frame, matching) = (frame(&rig), Matching::from(road(&rig)));
        let view = View::new(&frame, None, &matching);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let spec = GridSpec::new(&GridSettings::default()).unwrap();
            let mut mapper = WinnerTakeAll::new(spec, WinnerTakeAllSettings::default()).unwrap();
            group.bench_function(format!("{name}/{threads}"), |b| {
                b.iter(|| pool.install(|| mapper.integrate(&view)).unwrap());
            });
        }
    }
}

criterion_group!(benches, bench, bench_cost_curve);
criterion_main!(benches);
