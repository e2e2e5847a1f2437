//! Time to render a stereo pair of `safety-1` (two images of 640x480: 614400 primary rays), its true
//! disparity, and a sweep of the street's 64-beam scanner.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use evigrid_core::Pose;
use evigrid_replay::Sequence;
use evigrid_synth::{LeftViewTruth, SyntheticSequence, World};

fn bench(c: &mut Criterion) {
    let world = World::builtin("safety-1").unwrap();
    let street = SyntheticSequence::new(World::builtin("street").unwrap());
    let sequence = SyntheticSequence::new(world.clone());
    let mut group = c.benchmark_group("synth");
    group.sample_size(20);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        group.throughput(Throughput::Elements(2 * 640 * 480));
        group.bench_function(format!("safety-1_pair_640x480/{threads}"), |b| {
            b.iter(|| pool.install(|| sequence.frame(100, &Pose::identity()).unwrap()));
        });
        group.throughput(Throughput::Elements(640 * 480));
        group.bench_function(format!("safety-1_true_disparity_640x480/{threads}"), |b| {
            b.iter(|| pool.install(|| LeftViewTruth::new(&world, 100)));
        });
        group.throughput(Throughput::Elements(2 * 640 * 256 + 64 * 900));
        group.bench_function(format!("street_pair_640x256_and_scan/{threads}"), |b| {
            b.iter(|| pool.install(|| street.frame(5, &Pose::identity()).unwrap()));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
