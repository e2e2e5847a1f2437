//! Time to add one scan of 115,000 points to the reference grid of the paper.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::{LaserScan, Pose};
use evigrid_grid::{GridSettings, GridSpec};
use evigrid_truth::{LaserTruth, TruthSettings};
use nalgebra::{UnitQuaternion, Vector3};

/// 64 beams in a street: ground 1.7 m below, walls 8 m to either side, nothing beyond 70 m.
fn street_scan() -> LaserScan {
    let mut points = Vec::new();
    for beam in 0..64 {
        let pitch = (2.0 - 26.8 * f64::from(beam) / 63.0).to_radians();
        for step in 0..1797 {
            let yaw = f64::from(step) / 1797.0 * std::f64::consts::TAU;
            let (dx, dy, dz) = (pitch.cos() * yaw.cos(), pitch.cos() * yaw.sin(), pitch.sin());
            let ground = if dz < 0.0 { -1.7 / dz } else { f64::INFINITY };
            let range = ground.min(8.0 / dy.abs()).min(70.0);
            points.push([dx * range, dy * range, dz * range].map(|v| v as f32));
        }
    }
    let pose = Pose::from_parts(Vector3::new(-0.27, 0.0, 0.08).into(), UnitQuaternion::identity());
    LaserScan::new(points, pose).unwrap()
}

fn bench(c: &mut Criterion) {
    let scan = street_scan();
    let mut group = c.benchmark_group("truth");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let spec = GridSpec::new(&GridSettings::default()).unwrap();
        let mut truth = LaserTruth::new(spec, TruthSettings::default()).unwrap();
        group.bench_function(format!("scan_of_115000/{threads}"), |b| {
            b.iter(|| pool.install(|| truth.add_scan(&scan)));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
