//! Double correlation against a slow, obvious twin, and on ground and walls of known geometry.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use evigrid_core::{DisparityPlane, GrayImage, Matching};
use evigrid_stereo::{
    BlockMatchingSettings, DoubleCorrelationMatcher, DoubleCorrelationSettings, Extras, GroundSource,
    PairMatcher, PairTask,
};
use proptest::prelude::*;

const EVERYTHING: Extras = Extras { costs: false, road: true };

fn run(
    settings: DoubleCorrelationSettings,
    block: BlockMatchingSettings,
    [left, right]: [&GrayImage; 2],
    ground: Option<DisparityPlane>,
) -> Matching {
    let mut matcher = DoubleCorrelationMatcher::new(settings, block).unwrap();
    matcher.run(PairTask { left, right, wanted: EVERYTHING, ground, recycled: None }).unwrap()
}

/// Sum of absolute differences of the window around (x, y), whose row `y + dy` is compared `shift(dy)` columns further
/// left, between pixels by interpolation; `None` where it does not lie in both images.
fn sad(
    [left, right]: [&GrayImage; 2],
    radius: i64,
    [x, y]: [i64; 2],
    shift: impl Fn(i64) -> f64,
) -> Option<i64> {
    let (w, h) = (left.width() as i64, left.height() as i64);
    let is_in = |x: i64| x - radius >= 0 && x + radius < w;
    let fits = |dy: i64| {
        let (least, most) = (shift(dy).floor() as i64, shift(dy).ceil() as i64);
        x - most - radius >= 0 && x - least + radius < w
    };
    if y < radius || y + radius >= h || !is_in(x) || !(-radius..=radius).all(fits) {
        return None;
    }
    let at = |image: &GrayImage, x: i64, y: i64| i64::from(image.row(y as usize)[x.clamp(0, w - 1) as usize]);
    let between = |x: f64, y: i64| {
        let weight = ((x - x.floor()) * 256.0).round() as i64;
        let (a, b) = (at(right, x.floor() as i64, y), at(right, x.floor() as i64 + 1, y));
        ((256 - weight) * a + weight * b + 128) / 256
    };
    let pixels = (-radius..=radius).flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy)));
    let difference =
        |(dx, dy)| (at(left, x + dx, y + dy) - between((x + dx) as f64 - shift(dy), y + dy)).abs();
    Some(pixels.map(difference).sum())
}

/// Winner and class of one pixel as the definition says: the lower one of both costs for every disparity, the lowest
/// of all, the smallest disparity of those.
fn twin(
    s: &DoubleCorrelationSettings,
    block: &BlockMatchingSettings,
    images: [&GrayImage; 2],
    ground: &DisparityPlane,
    [x, y]: [i64; 2],
) -> Option<(i64, bool)> {
    let radius = s.window as i64 / 2;
    let of_row = |y: i64| ground.at(0.0, y as f64).round() as i64;
    let tolerance =
        (s.road_tolerance_px + s.road_tolerance_share * (of_row(y) as f64).max(0.0)).ceil() as i64;
    let costs = (block.min_disparity..block.min_disparity + block.disparities).map(|d| d as i64).map(|d| {
        let upright = sad(images, radius, [x, y], |_| d as f64);
        let residual = d - of_row(y);
        // The twin of a window that would reach beyond the right image is left out, as by its lowest row.
        let road = (residual.abs() <= tolerance)
            .then(|| sad(images, radius, [x, y], |dy| ground.at(0.0, (y + dy) as f64) + residual as f64))
            .flatten();
        (d, upright, road)
    });
    let lower = |upright: Option<i64>, road: Option<i64>| upright.into_iter().chain(road).min();
    let best = costs.filter_map(|(d, upright, road)| Some((lower(upright, road)?, d, road)));
    let (cost, d, road) = best.min_by_key(|(cost, d, _)| (*cost, *d))?;
    Some((d, road == Some(cost)))
}

fn check(
    s: DoubleCorrelationSettings,
    block: BlockMatchingSettings,
    images: [&GrayImage; 2],
    ground: DisparityPlane,
) {
    let out = run(s, block, images, Some(ground));
    let split = out.road.as_ref().unwrap();
    let (width, height) = (images[0].width(), images[0].height());
    for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
        let at = y * width + x;
        let found = [&out.matches.disparity, &split.road, &split.obstacles].map(|d| d.values()[at]);
        let expected = twin(&s, &block, images, &ground, [x as i64, y as i64]);
        let none = f32::NAN;
        let expected = match expected {
            None => [none; 3],
            Some((d, true)) => [d as f32, d as f32, none],
            Some((d, false)) => [d as f32, none, d as f32],
        };
        assert!(
            found.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan()),
            "{x} {y}: {found:?} {expected:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    #[test]
    fn all_pixels_are_those_of_the_twin(
        (width, height) in (12_usize..50, 9_usize..30),
        radius in 1_usize..4,
        (min_disparity, disparities) in (0_usize..3, 1_usize..14),
        (per_row, at_centre_px) in (0.05_f64..0.6, -3.0_f64..6.0),
        (tolerance, share) in (0.0_f64..2.0, 0.0_f64..0.3),
        (shift, grey_levels, seed) in (0_usize..6, 1_u8..200, any::<u64>()),
    ) {
        let (left, right) = pair(width, height, shift, grey_levels, seed);
        let settings = DoubleCorrelationSettings {
            window: 2 * radius + 1,
            road_tolerance_px: tolerance,
            road_tolerance_share: share,
            ..Default::default()
        };
        let block = BlockMatchingSettings { window: 7, min_disparity, disparities };
        let centre_px = [0.5 * width as f64, 0.5 * height as f64];
        let ground = DisparityPlane { at_centre_px, per_column: 0.0, per_row, centre_px };
        check(settings, block, [&left, &right], ground);
    }
}

/// A pair in which every left pixel has the disparity `of(x, y)`, whole.
fn scene(width: usize, height: usize, of: impl Fn(usize, usize) -> usize) -> [GrayImage; 2] {
    // Texture of some pixels' width, which halving the image does not wipe out.
    let (_, fine) = pair(width + 4, height + 4, 0, 250, 7);
    let blurred = |x: usize, y: usize| {
        let sum: u32 = (0..25).map(|n| u32::from(fine.row(y + n / 5)[x + n % 5])).sum();
        (sum / 4).saturating_sub(656).min(255) as u8
    };
    let right = (0..width * height).map(|i| blurred(i % width, i / width)).collect();
    let right = GrayImage::new(width, height, right).unwrap();
    let left = (0..width * height).map(|i| {
        let (x, y) = (i % width, i / width);
        right.row(y)[x.saturating_sub(of(x, y))]
    });
    [GrayImage::new(width, height, left.collect()).unwrap(), right]
}

/// Ground from row 40 on, and a wall at 14 px above it and in front of it.
fn ground_and_wall(x: usize, y: usize) -> usize {
    let ground = GROUND.at(x as f64, y as f64).round().max(0.0) as usize;
    let is_wall = (120..180).contains(&x) && y < 75;
    if is_wall || y < 40 { 14 } else { ground }
}

const GROUND: DisparityPlane =
    DisparityPlane { at_centre_px: 0.0, per_column: 0.0, per_row: 0.4, centre_px: [120.0, 40.0] };
const BLOCK: BlockMatchingSettings = BlockMatchingSettings { window: 7, min_disparity: 0, disparities: 48 };

#[test]
fn ground_is_road_and_walls_are_obstacles() {
    let [left, right] = scene(240, 120, ground_and_wall);
    let out = run(
        DoubleCorrelationSettings { window: 11, ..Default::default() },
        BLOCK,
        [&left, &right],
        Some(GROUND),
    );
    let split = out.road.unwrap();
    let at = |x: usize, y: usize| {
        [&split.road, &split.obstacles].map(|d| Some(d.row(y)[x]).filter(|d| !d.is_nan()))
    };
    // Away from edges by half a window, and from columns whose match lies outside of the right image.
    for (x, y) in (70..230).flat_map(|x| (47..112).map(move |y| (x, y))) {
        let expected = ground_and_wall(x, y) as f32;
        if !(114..186).contains(&x) {
            assert_eq!(at(x, y), [Some(expected), None], "{x} {y}");
        } else if (126..174).contains(&x) && y < 69 {
            assert_eq!(at(x, y), [None, Some(14.0)], "{x} {y}");
        }
    }
    assert_eq!((split.tried, split.ground), (0..48, GROUND));
}

#[test]
fn the_ground_of_a_frame_is_found_in_it() {
    for (per_column, at_centre_px) in [(0.0, 0.0), (0.02, 3.0), (-0.03, -5.0)] {
        let truth = DisparityPlane { at_centre_px, per_column, per_row: 0.36, centre_px: [200.0, 60.0] };
        let of = |x: usize, y: usize| {
            let ground = truth.at(x as f64, y as f64).round().max(0.0) as usize;
            let is_wall = (250..300).contains(&x) && y < 140;
            if is_wall { 20 } else { ground }
        };
        let [left, right] = scene(400, 220, of);
        let settings = DoubleCorrelationSettings { ground: GroundSource::VDisparity, ..Default::default() };
        let block = BlockMatchingSettings { disparities: 80, ..BLOCK };
        let found = run(settings, block, [&left, &right], None).road.unwrap().ground;
        for (x, y) in [(60.0, 80.0), (380.0, 80.0), (60.0, 210.0), (380.0, 210.0)] {
            let (found, truth) = (found.at(x, y), truth.at(x, y));
            assert!((found - truth).abs() < 0.4, "{x} {y}: {found}, {truth}");
        }
    }
}

#[test]
fn without_ground_there_is_an_error_or_the_mounting() {
    let [left, right] = scene(200, 120, |_, _| 9);
    let settings = DoubleCorrelationSettings { ground: GroundSource::VDisparity, ..Default::default() };
    let mut matcher = DoubleCorrelationMatcher::new(settings, BLOCK).unwrap();
    let task = |ground| PairTask { left: &left, right: &right, wanted: EVERYTHING, ground, recycled: None };
    let error = matcher.run(task(None)).unwrap_err().to_string();
    assert!(error.contains("input.mounting") && error.ends_with("found neither"), "{error}");
    let out = matcher.run(task(Some(GROUND))).unwrap();
    assert_eq!(out.road.unwrap().ground, GROUND);
    // Obstacles alone; a horizon below the image leaves no road at all.
    let above = DisparityPlane { centre_px: [100.0, 500.0], ..GROUND };
    let settings = DoubleCorrelationSettings::default();
    let split = run(settings, BLOCK, [&left, &right], Some(above)).road.unwrap();
    assert_eq!(split.road.valid_count(), 0);
    assert!(split.obstacles.valid_count() > 10_000);
}

#[test]
fn threads_and_used_buffers_change_nothing() {
    let [left, right] = scene(240, 120, ground_and_wall);
    let other = pair(240, 120, 3, 200, 5);
    let settings = DoubleCorrelationSettings { sub_pixel: true, ..Default::default() };
    let runs = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut matcher = DoubleCorrelationMatcher::new(settings, BLOCK).unwrap();
        pool.install(|| {
            let ground = Some(GROUND);
            let task =
                PairTask { left: &other.0, right: &other.1, wanted: EVERYTHING, ground, recycled: None };
            let recycled = Some(matcher.run(task).unwrap());
            let task = PairTask { left: &left, right: &right, wanted: EVERYTHING, ground, recycled };
            let split = matcher.run(task).unwrap().road.unwrap();
            [split.road, split.obstacles].map(|d| d.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>())
        })
    });
    assert_eq!(runs[0], runs[1]);
    let fresh = run(settings, BLOCK, [&left, &right], Some(GROUND)).road.unwrap();
    assert_eq!(runs[0][0], fresh.road.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>());
}

#[test]
fn impossible_settings_are_refused() {
    let refuse = |s| DoubleCorrelationMatcher::new(s, BLOCK).unwrap_err().to_string();
    let base = DoubleCorrelationSettings::default();
    let error = refuse(DoubleCorrelationSettings { window: 20, ..base });
    assert_eq!(error, "stereo.double_correlation.window: expected an odd number from 1 to 255, found 20");
    let error = refuse(DoubleCorrelationSettings { road_tolerance_px: f64::NAN, ..base });
    assert!(error.contains("road_tolerance_px"), "{error}");
    let error = refuse(DoubleCorrelationSettings { road_tolerance_share: 2.0, ..base });
    assert!(error.ends_with("found 2"), "{error}");
}
