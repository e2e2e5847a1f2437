//! Ray tracing against a direct transcription: every cell of the sensor's box by itself, its corners
//! projected one by one, eqs 1 to 11 in double precision.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{CELL_M, RIG, Shot, cell_at, shot, spec};
use evigrid_grid::{LogOddsGrid, probability};
use evigrid_inverse_model::{
    Counters, InverseModelMapper, Measurement, NearPixels, RayPyramidSettings, RaySettings, SensorModel,
    TABLE_ERROR, WindowCube,
};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

const MAX_DEPTH_M: f64 = 7.0;
const MODEL: SensorModel = SensorModel {
    k: 0.1,
    min_probability: 0.35,
    disparity_error_px: 0.5,
    motion_error_m: 0.0,
    near: NearPixels::Limit,
    max_peak: 0.493_307_149_075_715,
    max_depth_m: MAX_DEPTH_M,
};

/// Pixels that are searched for the largest disparity.
#[derive(Debug, Clone, Copy)]
enum Search {
    Cube(f64),
    Pyramid,
}

/// A place whose image decides between two pixels or layers by its last digits is left out of the comparison.
const NEAR_TIE: f64 = 1e-6;

/// First and last cell of the aligned box around the camera and the corner pixels at the range limit, in the
/// grid.
fn sensor_box(shot: &Shot) -> [std::ops::Range<i64>; 3] {
    let (right, bottom) = ((RIG.width - 1) as f64, (RIG.height - 1) as f64);
    let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
    let mut points: Vec<Point3<f64>> = corners.map(|(x, y)| shot.point(x, y, MAX_DEPTH_M)).to_vec();
    points.push(shot.camera().into());
    let cells: Vec<[i64; 3]> = points.iter().map(|p| cell_at(p.coords.into())).collect();
    let shape = spec().shape().map(|n| n as i64);
    std::array::from_fn(|a| {
        let low = cells.iter().map(|c| c[a]).min().unwrap().clamp(0, shape[a]);
        let high = cells.iter().map(|c| c[a]).max().unwrap() + 1;
        low..high.clamp(low, shape[a])
    })
}

/// The largest disparity in a rectangle of image points, rounded to pixels and cut to the image, and the
/// number of its pixels; `None` if rounding hangs by a thread.
fn in_rectangle(shot: &Shot, x: [f64; 2], y: [f64; 2]) -> Option<(Option<f32>, u64)> {
    let tie = |v: f64| ((v + 0.5) - (v + 0.5).round()).abs() < NEAR_TIE;
    if x.iter().chain(&y).any(|&v| tie(v)) {
        return None;
    }
    let cut = |[low, high]: [f64; 2], size: usize| {
        (0..size).filter(move |&n| low.round() <= n as f64 && n as f64 <= high.round())
    };
    let pixels: Vec<_> = cut(y, RIG.height).flat_map(|v| cut(x, RIG.width).map(move |u| (u, v))).collect();
    let largest = pixels.iter().filter_map(|&(u, v)| shot.believed(u, v)).reduce(f32::max);
    Some((largest, pixels.len() as u64))
}

/// Step 2c: the window of the cube's corners.
fn in_window(shot: &Shot, centre: Vector3<f64>, edge_m: f64) -> Option<(Option<f32>, u64)> {
    let (mut x, mut y) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
    for n in 0..8 {
        let off = Vector3::from_fn(|a, _| if n >> a & 1 == 0 { -0.5 } else { 0.5 }) * edge_m;
        let corner = shot.pose.inverse_transform_point(&Point3::from(centre + off));
        if corner.z.abs() < NEAR_TIE {
            return None;
        }
        if corner.z < 0.0 {
            return in_rectangle(shot, [0.0, RIG.width as f64], [0.0, RIG.height as f64]);
        }
        let (u, v) = RIG.project(&corner)?;
        (x, y) = ([x[0].min(u), x[1].max(u)], [y[0].min(v), y[1].max(v)]);
    }
    in_rectangle(shot, x, y)
}

/// Section VI-C: the four pixels of the fitting layer, whose pixels stand for blocks of 2^i by 2^i.
fn in_pyramid(shot: &Shot, u: f64, v: f64, depth: f64) -> Option<(Option<f32>, u64)> {
    let exact = (CELL_M * RIG.focal_px / depth).log2();
    let tie = |v: f64| (v - v.round()).abs() < NEAR_TIE;
    if tie(exact) || tie(u) || tie(v) {
        return None;
    }
    let i = (exact.floor() as i32).clamp(0, 5);
    let last = |size: usize| size.div_ceil(1 << i) - 1;
    let place = |v: f64, size: usize| {
        let first = (v.max(0.0) as usize) >> i;
        [first, (first + 1).min(last(size))]
    };
    let block = |n: usize, size: usize| n << i..((n + 1) << i).min(size);
    let mut largest: Option<f32> = None;
    for y in place(v, RIG.height).into_iter().flat_map(|n| block(n, RIG.height)) {
        for x in place(u, RIG.width).into_iter().flat_map(|n| block(n, RIG.width)) {
            largest = largest.into_iter().chain(shot.believed(x, y)).reduce(f32::max);
        }
    }
    Some((largest, 4))
}

fn check(shot: &Shot, search: Search, found: &LogOddsGrid, counters: &Counters) -> Result<(), TestCaseError> {
    let spec = spec();
    let around = sensor_box(shot);
    let (mut used, mut ties) = (0, 0);
    for flat in 0..spec.cell_count() {
        let centre = Vector3::from(spec.centre_m(flat));
        let voxel = spec.voxel(flat).map(|v| v as i64);
        let seen = shot.pose.inverse_transform_point(&centre.into());
        let point = RIG.project(&seen).filter(|&(u, v)| {
            let inside = |v: f64, size: usize| v >= -0.5 && v < size as f64 - 0.5;
            inside(u, RIG.width) && inside(v, RIG.height)
        });
        let point = point.filter(|_| (0..3).all(|a| around[a].contains(&voxel[a])));
        let Some((u, v)) = point else {
            prop_assert_eq!(found.log_odds(flat), None, "cell {} is not seen", flat);
            continue;
        };
        let searched = match search {
            Search::Cube(edge_m) => in_window(shot, centre, edge_m),
            Search::Pyramid => in_pyramid(shot, u, v, seen.z),
        };
        let Some((disparity, pixels)) = searched else {
            ties += 1;
            continue;
        };
        used += pixels;
        let measured = disparity.and_then(|d| MODEL.measure(&RIG, (u, v), f64::from(d)));
        let l = (centre - shot.camera()).norm();
        let log_odds = measured.map_or(0.0, |m: Measurement| m.max_log_odds(l, CELL_M).clamp(-5.0, 5.0));
        let p = found.log_odds(flat).map_or(0.5, |l| probability(f64::from(l)));
        let off = (p - probability(log_odds)).abs();
        prop_assert!(off < TABLE_ERROR + 2e-4, "cell {flat}: P {p}, expected log-odds {log_odds}");
    }
    let cells: u64 = around.iter().map(|r| r.clone().count() as u64).product();
    prop_assert_eq!(counters.coordinate_transfers, cells + 5);
    prop_assert_eq!((counters.cells_drawn, counters.different_cells), (cells, cells));
    prop_assert!(
        ties > 0 || counters.used_pixels == used,
        "{} pixels, expected {used}",
        counters.used_pixels
    );
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn rays_are_traced_by_the_book(shot in shot(), metre: bool) {
        let (window, edge_m) = if metre { (WindowCube::Metre, 1.0) } else { (WindowCube::Cell, CELL_M) };
        let settings = RaySettings { max_depth_m: MAX_DEPTH_M, window, ..RaySettings::default() };
        let mut mapper = InverseModelMapper::ray(spec(), settings).unwrap();
        let (found, counters) = shot.with(|view| mapper.single_image(view));
        check(&shot, Search::Cube(edge_m), &found, &counters)?;
    }

    #[test]
    fn pyramids_of_rays_are_traced_by_the_book(shot in shot()) {
        let settings = RayPyramidSettings { max_depth_m: MAX_DEPTH_M, ..RayPyramidSettings::default() };
        let mut mapper = InverseModelMapper::ray_pyramid(spec(), settings).unwrap();
        let (found, counters) = shot.with(|view| mapper.single_image(view));
        check(&shot, Search::Pyramid, &found, &counters)?;
        prop_assert_eq!(counters.used_pixels % 4, 0);
    }
}
