//! Multi-scale matching time: block matching of every scale, texture, and filling in.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_stereo::{BlockMatchingSettings, MultiScaleMatcher, MultiScaleSettings};

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("multi_scale");
    group.sample_size(30);
    let (left, right) = pair(1242, 375);
    for scales in [2, 3] {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let settings = MultiScaleSettings { scales, ..Default::default() };
            let mut matcher = MultiScaleMatcher::new(settings, BlockMatchingSettings::default()).unwrap();
            let mut recycled = None;
            group.bench_function(format!("kitti_1242x375_128_{scales}_scales/{threads}"), |b| {
                b.iter(|| {
                    recycled = Some(pool.install(|| matcher.run(&left, &right, recycled.take())).unwrap());
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
