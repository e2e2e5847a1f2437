//! Semi-global matching time: block costs, 8 or 4 paths, winner, sub-pixel part, peak ratio and left-right difference.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::GrayImage;
use evigrid_stereo::{PixelCost, SemiGlobalMatcher, SemiGlobalSettings};

/// A textured pair whose disparity grows downwards, as on a road.
fn pair(width: usize, height: usize) -> (GrayImage, GrayImage) {
    let noise = |x: usize, y: usize| {
        let mut h =
            (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (h >> 56) as u8
    };
    let left = (0..width * height).map(|i| noise(i % width, i / width)).collect();
    let right = (0..width * height).map(|i| noise(i % width + i / width * 60 / height, i / width)).collect();
    (GrayImage::new(width, height, left).unwrap(), GrayImage::new(width, height, right).unwrap())
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("semi_global");
    group.sample_size(20);
    let base = SemiGlobalSettings::default();
    let kinds = [
        ("", base, false),
        ("_volume_kept", base, true),
        ("_4_paths", SemiGlobalSettings { paths: 4, ..base }, false),
        ("_census", SemiGlobalSettings { pixel_cost: PixelCost::Census, p1: 30, p2: 120, ..base }, false),
    ];
    let (left, right) = pair(1242, 375);
    for (kind, settings, keep_volume) in kinds {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut matcher = SemiGlobalMatcher::new(settings, 0, 128).unwrap();
            let mut recycled = None;
            group.bench_function(format!("kitti_1242x375_128{kind}/{threads}"), |b| {
                b.iter(|| {
                    let run = || matcher.run(&left, &right, keep_volume, recycled.take());
                    recycled = Some(pool.install(run).unwrap());
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
