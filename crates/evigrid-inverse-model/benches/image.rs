//! Time of one image by each method, all of it: filters, pyramid, drawing, fusion (Andert 2009, Table I).
#![allow(clippy::unwrap_used, missing_docs)]

use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use evigrid_core::{Disparity, Frame, GrayImage, Matches, Matching, Pose, View, level_camera};
use evigrid_grid::{GridSettings, GridSpec, Mapper};
use evigrid_inverse_model::{
    ANDERT_RIG as RIG, InverseModelMapper, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings,
};
use nalgebra::Vector3;

/// Posts from 6 to 25 m: distance, lateral place, radius and height above the ground, metres.
const POSTS: [[f64; 4]; 11] = [
    [7.2, 2.45, 0.2, 5.4],
    [7.6, 0.15, 0.19, 4.6],
    [6.35, -1.4, 0.18, 6.2],
    [9.6, -3.2, 0.2, 6.0],
    [11.5, -0.6, 0.16, 4.6],
    [13.5, 4.6, 0.16, 5.6],
    [17.0, 1.6, 0.14, 5.0],
    [20.5, 5.6, 0.14, 6.0],
    [21.0, -1.2, 0.14, 5.4],
    [22.5, -4.6, 0.14, 6.4],
    [23.5, 2.9, 0.14, 5.8],
];

/// A camera 3 m above a meadow with posts, a wall and a box, a wood behind the range; disparities off by up
/// to a quarter of a pixel, no measurement in the sky, in patches and in one pixel of twenty. About 194000 of
/// the 307200 pixels have one.
fn posts() -> Matches {
    let noise = |n: usize| {
        let h = (n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((h >> 40) % 1000) as f64 * 1e-3
    };
    let disparity = (0..RIG.width * RIG.height).map(|n| {
        let (x, y) = (n % RIG.width, n / RIG.width);
        let ray = RIG.ray(x as f64, y as f64);
        let mut depth = if ray.y > 0.0 { 3.0 / ray.y } else { f64::INFINITY };
        let mut stand = |at: f64, left: f64, half: f64, height: f64| {
            if (ray.x * at + left).abs() < half && ray.y * at > 3.0 - height && ray.y * at < 3.0 {
                depth = depth.min(at);
            }
        };
        POSTS.iter().for_each(|&[at, left, radius, height]| stand(at, left, radius, height));
        stand(15.0, -5.0, 3.0, 4.2);
        stand(20.0, 6.4, 2.5, 3.9);
        stand(8.0, 1.35, 0.8, 2.3);
        stand(11.8, 2.6, 1.2, 2.9);
        stand(40.0, 0.0, 60.0, 6.5);
        let patch = noise(x / 20 + 1000 * (y / 20) + 77) < 0.04;
        let none = depth.is_infinite() || patch || noise(n) < 0.05;
        if none { f32::NAN } else { (RIG.disparity_px(depth) + 0.5 * noise(n + 999_983) - 0.25) as f32 }
    });
    Matches::from_disparity(Disparity::new(RIG.width, RIG.height, disparity.collect()).unwrap())
}

/// A grid that the sensor's box just fits into, looking along x with the camera in the middle of a cell.
fn spec(cell_size_m: f64) -> GridSpec {
    let settings = GridSettings { x_m: [-0.5, 26.0], y_m: [-12.5, 12.5], z_m: [-9.5, 9.5], cell_size_m };
    GridSpec::new(&settings).unwrap()
}

fn mapper(method: &str, spec: GridSpec) -> InverseModelMapper {
    match method {
        "line" => InverseModelMapper::line(spec, LineSettings::default()),
        "line-pyramid" => InverseModelMapper::line_pyramid(spec, LinePyramidSettings::default()),
        "ray" => InverseModelMapper::ray(spec, RaySettings::default()),
        _ => InverseModelMapper::ray_pyramid(spec, RayPyramidSettings::default()),
    }
    .unwrap()
}

fn bench(c: &mut Criterion) {
    let matches = posts();
    eprintln!("{} valid pixels", matches.disparity.valid_count());
    let pose = Pose::from_parts(Vector3::new(0.1, 0.1, 0.1).into(), level_camera());
    let grey = || GrayImage::new(RIG.width, RIG.height, vec![0; RIG.width * RIG.height]).unwrap();
    let frame = Frame::new(0, 0, RIG, grey(), grey(), pose, None).unwrap();
    let matching = Matching::from(matches);
    let view = View::new(&frame, None, &matching);
    let mut group = c.benchmark_group("image");
    for cell_size_m in [1.0, 0.5, 0.25] {
        for method in ["line", "line-pyramid", "ray", "ray-pyramid"] {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut mapper = mapper(method, spec(cell_size_m));
                group.bench_function(format!("{method}/{cell_size_m}/{threads}"), |b| {
                    // From within the pool, as a run does: waking it is not part of an image.
                    b.iter_custom(|images| {
                        pool.install(|| {
                            let start = Instant::now();
                            (0..images).for_each(|_| mapper.integrate(&view).unwrap());
                            start.elapsed()
                        })
                    });
                });
                if threads == 1 {
                    eprintln!("{method} {cell_size_m}: {:?}", mapper.counters());
                }
            }
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
