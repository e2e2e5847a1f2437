//! Matching time: cost volume, winner, sub-pixel part, peak ratio and left-right difference of one pair.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::GrayImage;
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};

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
    let mut group = c.benchmark_group("match");
    group.sample_size(30);
    for (name, width, height, disparities) in
        [("kitti_1242x375_128", 1242, 375, 128), ("vga_640x480_64", 640, 480, 64)]
    {
        let (left, right) = pair(width, height);
        let settings = BlockMatchingSettings { disparities, ..Default::default() };
        for (kind, keep_volume) in [("", false), ("_volume_kept", true)] {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut matcher = BlockMatcher::new(settings).unwrap();
                let mut recycled = None;
                group.bench_function(format!("{name}{kind}/{threads}"), |b| {
                    b.iter(|| {
                        let run = || matcher.run(&left, &right, keep_volume, recycled.take());
                        recycled = Some(pool.install(run).unwrap());
                    });
                });
            }
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
