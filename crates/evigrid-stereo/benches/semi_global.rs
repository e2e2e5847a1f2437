//! Semi-global matching time: block costs, 8 or 4 paths, winner, sub-pixel part, peak ratio and left-right
//! difference.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_stereo::{PixelCost, SemiGlobalMatcher, SemiGlobalSettings};

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
            let mut matcher = SemiGlobalMatcher::new(settings, 0..128).unwrap();
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
