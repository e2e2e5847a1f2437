//! The stages of a frame on the paper's camera and grid: 512x320, disparities up to 64, 100x100 cells.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::{GroundPlane, Mounting, StereoRig};
use evigrid_grid::PlanSpec;
use evigrid_udisparity::{
    Filter, GroundView, LevelView, Pixels, Smoother, UDisparityGrid, VisibilityFilteredSettings,
    map_to_ground,
};

const RIG: StereoRig = StereoRig {
    width: 512,
    height: 320,
    focal_px: 410.0,
    centre_x_px: 255.5,
    centre_y_px: 159.5,
    baseline_m: 0.22,
};
const DISPARITIES: usize = 64;

/// Road below the horizon, and boxes at some disparities.
fn pixels() -> Pixels {
    let mut pixels = Pixels { width: RIG.width, height: RIG.height, ..Pixels::default() };
    for (y, x) in (0..RIG.height).flat_map(|y| (0..RIG.width).map(move |x| (y, x))) {
        let road = (0.22 / 1.2 * (y as f64 - 159.5)).round().max(0.0) as u16;
        let near = 4 + (x / 64 * 7 % 23) as u16;
        let is_box = (100..170 + x / 8).contains(&y);
        pixels.obstacles.push(if is_box { near } else { 0 });
        pixels.road.push(if is_box { 0 } else { road });
    }
    pixels
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("u-disparity");
    let settings = VisibilityFilteredSettings::default().0;
    let ground = GroundPlane::below(&Mounting::over_middle(1.2, 0.0)).disparities(&RIG);
    let view = LevelView::new(&RIG, &ground).unwrap();
    let plan = PlanSpec::of_area([0.0, 20.0], [-10.0, 10.0], 0.2).unwrap();
    // Turned a little, as most frames are.
    let ahead = [0.3_f64.cos(), 0.3_f64.sin()];
    let place = GroundView {
        camera_m: [0.05, 0.03],
        ahead,
        focal_px: RIG.focal_px,
        centre_x_px: RIG.centre_x_px,
        baseline_m: RIG.baseline_m,
    };
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let pixels = pixels();
        let mut grid = UDisparityGrid::new(&view, settings.top_m, DISPARITIES, settings.parameters(), false);
        group.bench_function(format!("grid/{threads}"), |b| {
            b.iter(|| pool.install(|| grid.fill(&pixels)));
        });
        let mut smoother = Smoother::new(settings.sigma_u_px, settings.sigma_d_px, RIG.width);
        group.bench_function(format!("gaussian/{threads}"), |b| {
            b.iter(|| {
                pool.install(|| smoother.run(grid.total()).len());
            });
        });
        let smooth = smoother.run(grid.total()).to_vec();
        let mut out = vec![0.0; plan.cell_count()];
        group.bench_function(format!("ground/{threads}"), |b| {
            b.iter(|| pool.install(|| map_to_ground(&smooth, RIG.width, &place, &plan, &mut out)));
        });
        let mut filter = Filter::new(settings.filter_settings(), plan.shape(), plan.cell_size_m());
        let mut stamp_ns = 0;
        group.bench_function(format!("filter/{threads}"), |b| {
            b.iter(|| {
                stamp_ns += 80_000_000;
                pool.install(|| filter.step(stamp_ns, [1, 0], &out)).unwrap();
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
