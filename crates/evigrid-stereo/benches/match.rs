//! Matching time: cost volume, winner, sub-pixel part, peak ratio and left-right difference of one pair.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};

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
