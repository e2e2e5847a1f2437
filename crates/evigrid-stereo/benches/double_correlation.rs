//! Double correlation: upright windows and windows that follow the ground.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::DisparityPlane;
use evigrid_stereo::{
    BlockMatchingSettings, DoubleCorrelationMatcher, DoubleCorrelationSettings, Extras, GroundSource,
    PairMatcher, PairTask,
};

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("double_correlation");
    group.sample_size(30);
    for (name, [width, height], disparities) in
        [("paper_512x320_64", [512, 320], 64), ("kitti_1242x375_128", [1242, 375], 128)]
    {
        let (left, right) = pair(width, height);
        let centre_px = [0.5 * width as f64, 0.5 * height as f64];
        let ground = DisparityPlane { at_centre_px: 0.0, per_column: 0.0, per_row: 0.2, centre_px };
        for source in [GroundSource::Mounting, GroundSource::VDisparity] {
            let settings = DoubleCorrelationSettings { ground: source, ..Default::default() };
            let block = BlockMatchingSettings { disparities, ..Default::default() };
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut matcher = DoubleCorrelationMatcher::new(settings, block).unwrap();
                let mut recycled = None;
                group.bench_function(format!("{name}_{source:?}/{threads}"), |b| {
                    b.iter(|| {
                        let wanted = Extras { costs: false, road: true };
                        let task = PairTask::new(&left, &right, wanted);
                        let task = PairTask { ground: Some(ground), recycled: recycled.take(), ..task };
                        recycled = Some(pool.install(|| matcher.run(task)).unwrap());
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
