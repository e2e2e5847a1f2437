//! Time of one frame of winner-take-all mapping: inverse model, drawing and fusion.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::{Disparity, GrayImage, Matches, Pose, StereoRig};
use evigrid_cost_curve::{WinnerTakeAll, WinnerTakeAllSettings};
use evigrid_grid::{GridSettings, GridSpec, Mapper, View};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Camera above the road, metres, and walls on either side.
const HEIGHT_M: f64 = 1.65;
const WALLS_M: [f64; 2] = [-4.2, 6.5];

/// A whole number below 1000 that looks random, from a pixel's index.
fn noise(pixel: usize, salt: u64) -> f64 {
    let mut h =
        (pixel as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((h >> 40) % 1000) as f64
}

/// A road between walls under the sky, a car 9 m ahead; disparities off by up to half a pixel, 3 % of them wild, and
/// 30 % of the pixels without a clear winner.
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
    let level = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    let level = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(level));
    Pose::from_parts(
        Vector3::new(3.17, 0.13, 0.02).into(),
        UnitQuaternion::from_euler_angles(0.01, 0.02, 0.05) * level,
    )
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("integrate");
    let rig = |width, height, focal_px, baseline_m| {
        let (centre_x_px, centre_y_px) = (width as f64 * 0.49, height as f64 * 0.46);
        StereoRig { width, height, focal_px, centre_x_px, centre_y_px, baseline_m }
    };
    let rigs = [("kitti_1242x375", rig(1242, 375, 721.5, 0.537)), ("vga_640x480", rig(640, 480, 500.0, 0.3))];
    for (name, rig) in rigs {
        let matches = road(&rig);
        let left = GrayImage::new(rig.width, rig.height, vec![0; rig.width * rig.height]).unwrap();
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let spec = GridSpec::new(&GridSettings::default()).unwrap();
            let mut mapper = WinnerTakeAll::new(spec, WinnerTakeAllSettings::default()).unwrap();
            let view =
                View { rig: &rig, map_from_left: &pose(), left: &left, matches: &matches, volume: None };
            group.bench_function(format!("{name}/{threads}"), |b| {
                b.iter(|| pool.install(|| mapper.integrate(&view)));
            });
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
