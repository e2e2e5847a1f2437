//! Semi-global matching against a slow, obvious twin that follows the definitions word for word.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{GrayImage, NO_COST};
use evigrid_stereo::{Matching, PixelCost, SemiGlobalMatcher, SemiGlobalSettings};
use proptest::prelude::*;

/// What is matched, and how.
#[derive(Debug, Clone, Copy)]
struct Case<'a> {
    s: SemiGlobalSettings,
    min_disparity: i64,
    disparities: i64,
    uniqueness_percent: i64,
    left: &'a GrayImage,
    right: &'a GrayImage,
}

/// A pixel of an image whose border is repeated outwards.
fn pixel(image: &GrayImage, x: i64, y: i64) -> i64 {
    let inside = |v: i64, n: usize| v.clamp(0, n as i64 - 1) as usize;
    i64::from(image.row(inside(y, image.height()))[inside(x, image.width())])
}

fn sobel(image: &GrayImage, x: i64, y: i64, cap: i64) -> i64 {
    let column = |x: i64| pixel(image, x, y - 1) + 2 * pixel(image, x, y) + pixel(image, x, y + 1);
    (column(x + 1) - column(x - 1)).clamp(-cap, cap) + cap
}

/// Birchfield and Tomasi's cost of two functions of x.
fn birchfield_tomasi(left: &dyn Fn(i64) -> i64, right: &dyn Fn(i64) -> i64, x: i64, xr: i64) -> i64 {
    let one_way = |value: i64, other: &dyn Fn(i64) -> i64, at: i64| {
        let halves = [other(at), (other(at) + other(at - 1)) / 2, (other(at) + other(at + 1)) / 2];
        let (low, high) = (*halves.iter().min().unwrap(), *halves.iter().max().unwrap());
        (value - high).max(low - value).max(0)
    };
    one_way(left(x), right, xr).min(one_way(right(xr), left, x))
}

fn pixel_cost(case: &Case<'_>, x: i64, y: i64, d: i64) -> i64 {
    let (width, cap) = (case.left.width() as i64, case.s.sobel_cap as i64);
    let inside = |x: i64| x.clamp(0, width - 1);
    let xr = (x - d).max(0);
    match case.s.pixel_cost {
        PixelCost::AbsoluteDifference => (pixel(case.left, x, y) - pixel(case.right, xr, y)).abs(),
        PixelCost::BirchfieldTomasi => {
            let slopes = birchfield_tomasi(
                &|x| sobel(case.left, inside(x), y, cap),
                &|x| sobel(case.right, inside(x), y, cap),
                x,
                xr,
            );
            let greys = birchfield_tomasi(&|x| pixel(case.left, x, y), &|x| pixel(case.right, x, y), x, xr);
            slopes + greys / 4
        }
        PixelCost::Census => {
            let darker = |image: &GrayImage, x: i64, dx: i64, dy: i64| {
                pixel(image, x + dx, y + dy) < pixel(image, x, y)
            };
            let offsets = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
            offsets.filter(|&(dx, dy)| darker(case.left, x, dx, dy) != darker(case.right, xr, dx, dy)).count()
                as i64
        }
    }
}

/// Block costs of all hypotheses of all pixels, `[y][x][d]`.
fn block_costs(case: &Case<'_>) -> Vec<Vec<Vec<i64>>> {
    let (width, height) = (case.left.width() as i64, case.left.height() as i64);
    let radius = case.s.block as i64 / 2;
    let shift = cost_shift(&case.s);
    let sum = |x: i64, y: i64, d: i64| {
        let mut sum = 0;
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                sum += pixel_cost(case, (x + dx).clamp(0, width - 1), (y + dy).clamp(0, height - 1), d);
            }
        }
        sum >> shift
    };
    let curve = |x: i64, y: i64| {
        let known = (0..case.disparities).map(|k| case.min_disparity + k).filter(|d| x - d >= 0);
        known.map(|d| sum(x, y, d)).collect()
    };
    (0..height).map(|y| (0..width).map(|x| curve(x, y)).collect()).collect()
}

/// The smallest power of two with which eight path costs fit into 16 bits.
fn cost_shift(s: &SemiGlobalSettings) -> usize {
    let pixel = match s.pixel_cost {
        PixelCost::AbsoluteDifference => 255,
        PixelCost::BirchfieldTomasi => 2 * s.sobel_cap + 63,
        PixelCost::Census => 24,
    };
    (0..).find(|k| 8 * (((pixel * s.block * s.block) >> k) + (s.p2 >> k)) < 65535).unwrap()
}

/// Eq. 13 of Hirschmueller (2008): path costs of direction (dx, dy), added to the sums.
fn add_paths(case: &Case<'_>, costs: &[Vec<Vec<i64>>], (dx, dy): (i64, i64), sums: &mut [Vec<Vec<i64>>]) {
    let (width, height) = (case.left.width() as i64, case.left.height() as i64);
    let shift = cost_shift(&case.s);
    let mut paths: Vec<Vec<Vec<i64>>> = vec![vec![vec![]; width as usize]; height as usize];
    let rows: Vec<i64> = if dy < 0 { (0..height).rev().collect() } else { (0..height).collect() };
    let columns: Vec<i64> = if dx < 0 { (0..width).rev().collect() } else { (0..width).collect() };
    for &y in &rows {
        for &x in &columns {
            let (px, py) = (x - dx, y - dy);
            let inside = (0..width).contains(&px) && (0..height).contains(&py);
            let before = if inside { paths[py as usize][px as usize].clone() } else { vec![] };
            let step = (pixel(case.left, x, y) - pixel(case.left, px, py)).abs().max(1) as usize;
            let p2 = if case.s.adapt_p2 { (case.s.p2 / step).max(case.s.p1) } else { case.s.p2 };
            let (p1, p2) = ((case.s.p1 >> shift) as i64, (p2 >> shift) as i64);
            let path = |d: usize, cost: i64| {
                let Some(&lowest) = before.iter().min() else { return cost };
                let mut best = lowest + p2;
                for (e, &value) in before.iter().enumerate() {
                    let penalty = match d.abs_diff(e) {
                        0 => 0,
                        1 => p1,
                        _ => continue,
                    };
                    best = best.min(value + penalty);
                }
                cost + best - lowest
            };
            let curve: Vec<i64> =
                costs[y as usize][x as usize].iter().enumerate().map(|(d, &cost)| path(d, cost)).collect();
            for (sum, value) in sums[y as usize][x as usize].iter_mut().zip(&curve) {
                *sum += value;
            }
            paths[y as usize][x as usize] = curve;
        }
    }
}

/// Sums of all paths, `[y][x][d]`, for the hypotheses that exist.
fn path_sums(case: &Case<'_>) -> Vec<Vec<Vec<i64>>> {
    let costs = block_costs(case);
    let mut sums: Vec<Vec<Vec<i64>>> =
        costs.iter().map(|row| row.iter().map(|curve| vec![0; curve.len()]).collect()).collect();
    let straight = [(1, 0), (-1, 0), (0, 1), (0, -1)];
    let diagonal = [(1, 1), (-1, 1), (1, -1), (-1, -1)];
    for direction in straight.into_iter().chain(diagonal).take(case.s.paths) {
        add_paths(case, &costs, direction, &mut sums);
    }
    sums
}

fn winner(curve: &[i64]) -> Option<usize> {
    let lowest = curve.iter().min()?;
    curve.iter().position(|c| c == lowest)
}

/// Local minima of a curve: plateaus are merged, ends may be minima.
fn local_minima(curve: &[i64]) -> Vec<i64> {
    let mut values = curve.to_vec();
    values.dedup();
    let rises = |i: usize, j: usize| values.get(j).is_none_or(|v| *v > values[i]);
    let mut minima: Vec<i64> = (0..values.len())
        .filter(|&i| (i == 0 || rises(i, i - 1)) && rises(i, i + 1))
        .map(|i| values[i])
        .collect();
    minima.sort_unstable();
    minima
}

fn check_pixel(case: &Case<'_>, sums: &[Vec<i64>], out: &Matching, x: usize, y: usize) {
    let curve = &sums[x];
    let volume = out.volume.as_ref().unwrap();
    let paths = case.s.paths as i64;
    let mut stored: Vec<i64> = curve.iter().map(|sum| (sum + paths / 2) / paths).collect();
    stored.resize(case.disparities as usize, i64::from(NO_COST));
    let found: Vec<i64> = volume.curve(x, y).map(i64::from).collect();
    assert_eq!(found, stored, "volume at ({x}, {y})");

    let at = y * case.left.width() + x;
    let disparity = f64::from(out.matches.disparity.values()[at]);
    let unique = |best: &usize| {
        let far = curve.iter().enumerate().filter(|(d, _)| d.abs_diff(*best) > 1);
        far.map(|(_, sum)| sum).all(|sum| sum * (100 - case.uniqueness_percent) >= 100 * curve[*best])
    };
    let Some(best) = winner(curve).filter(unique) else {
        assert!(disparity.is_nan() && out.matches.peak_ratio[at].is_nan(), "({x}, {y})");
        assert_eq!(out.matches.left_right_difference_px[at], u16::MAX);
        return;
    };
    let whole = case.min_disparity as usize + best;
    let mut expected = whole as f64;
    if best > 0 && best + 1 < curve.len() {
        let [a, b, c] = [curve[best - 1], curve[best], curve[best + 1]].map(|v| v as f64);
        if a - 2.0 * b + c > 0.0 {
            expected += (a - c) / (2.0 * (a - 2.0 * b + c));
        }
    }
    assert!((disparity - expected).abs() < 1e-4, "({x}, {y}): {disparity}, expected {expected}");

    let ratio = match local_minima(curve)[..] {
        [_] => f64::INFINITY,
        [0, 0, ..] => 1.0,
        [first, second, ..] => second as f64 / first as f64,
        [] => unreachable!("a curve with a winner has a minimum"),
    };
    let found = f64::from(out.matches.peak_ratio[at]);
    assert!(found == ratio || (found - ratio).abs() < 1e-5 * ratio, "({x}, {y}): {found}, expected {ratio}");

    // The right image's pixel x - d sees the left image's sums along x - d + d'.
    let right_x = x - whole;
    let right_curve: Vec<i64> = (0..case.disparities as usize)
        .map_while(|k| sums.get(right_x + case.min_disparity as usize + k).map(|curve| curve[k]))
        .collect();
    let difference = winner(&right_curve).unwrap().abs_diff(best);
    assert_eq!(usize::from(out.matches.left_right_difference_px[at]), difference, "({x}, {y})");
}

fn run(case: &Case<'_>, recycled: Option<Matching>) -> Matching {
    let (min_disparity, disparities) = (case.min_disparity as usize, case.disparities as usize);
    let matcher = SemiGlobalMatcher::new(case.s, min_disparity, disparities).unwrap();
    let mut matcher = matcher.with_uniqueness(case.uniqueness_percent as u32);
    matcher.run(case.left, case.right, true, recycled).unwrap()
}

fn check(case: &Case<'_>) {
    let out = run(case, None);
    let sums = path_sums(case);
    for (y, sums) in sums.iter().enumerate() {
        for x in 0..case.left.width() {
            check_pixel(case, sums, &out, x, y);
        }
    }
}

/// A textured right image and a left image that is it, shifted, with noise: some structure and many ties.
fn pair(width: usize, height: usize, shift: usize, grey_levels: u8, seed: u64) -> (GrayImage, GrayImage) {
    let mut state = seed | 1;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u8
    };
    let step = 255 / grey_levels.max(1);
    let right: Vec<u8> = (0..width * height).map(|_| random() % (grey_levels + 1) * step).collect();
    let left = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            if random() % 8 == 0 { random() } else { right[y * width + x.saturating_sub(shift)] }
        })
        .collect();
    (GrayImage::new(width, height, left).unwrap(), GrayImage::new(width, height, right).unwrap())
}

fn settings() -> impl Strategy<Value = SemiGlobalSettings> {
    let cost = prop_oneof![
        Just(PixelCost::AbsoluteDifference),
        Just(PixelCost::BirchfieldTomasi),
        Just(PixelCost::Census)
    ];
    (0..4_usize, cost, 1..97_usize, 0..400_usize, 0..2000_usize, any::<bool>(), prop_oneof![Just(4), Just(8)])
        .prop_map(|(radius, pixel_cost, sobel_cap, p1, more, adapt_p2, paths)| SemiGlobalSettings {
            block: 2 * radius + 1,
            pixel_cost,
            sobel_cap,
            p1,
            p2: p1 + more,
            adapt_p2,
            paths,
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]
    #[test]
    fn equals_the_slow_twin(
        s in settings(),
        (width, height) in (1..40_usize, 1..14_usize),
        min_disparity in 0..6_i64,
        disparities in 1..45_i64,
        uniqueness_percent in prop_oneof![Just(0), 1..60_i64],
        shift in 0..12_usize,
        grey_levels in 1..200_u8,
        seed: u64,
    ) {
        let (left, right) = &pair(width, height, shift, grey_levels, seed);
        check(&Case { s, min_disparity, disparities, uniqueness_percent, left, right });
    }
}

#[test]
fn costs_too_large_for_16_bits_equal_the_slow_twin() {
    let (left, right) = &pair(50, 12, 5, 3, 7);
    let base = SemiGlobalSettings { pixel_cost: PixelCost::AbsoluteDifference, ..Default::default() };
    for s in [
        SemiGlobalSettings { block: 15, ..base },
        SemiGlobalSettings { p1: 3000, p2: 7000, ..base },
        SemiGlobalSettings { p1: 65535, p2: 65535, ..base },
        SemiGlobalSettings { p1: 0, p2: 0, ..base },
    ] {
        check(&Case { s, min_disparity: 1, disparities: 40, uniqueness_percent: 0, left, right });
    }
}

#[test]
fn threads_and_recycled_buffers_do_not_change_a_byte() {
    let (left, right) = &pair(90, 37, 4, 90, 11);
    let (other_left, other_right) = &pair(70, 50, 9, 90, 12);
    let s = SemiGlobalSettings::default();
    let case = Case { s, min_disparity: 0, disparities: 20, uniqueness_percent: 0, left, right };
    let fresh = run(&case, None);
    let bits = |m: &Matching| {
        let values = m.matches.disparity.values().iter().chain(&m.matches.peak_ratio);
        values.map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let out = pool.install(|| {
            let mut matcher = SemiGlobalMatcher::new(s, 0, 20).unwrap();
            let first = matcher.run(other_left, other_right, true, None).unwrap();
            let second = matcher.run(left, right, true, Some(first)).unwrap();
            matcher.run(left, right, true, Some(second)).unwrap()
        });
        assert_eq!(bits(&out), bits(&fresh));
        assert_eq!(out.matches.left_right_difference_px, fresh.matches.left_right_difference_px);
        assert_eq!(out.volume, fresh.volume);
    }
}

#[test]
fn a_plane_without_texture_takes_the_disparity_of_its_edges() {
    // A grey plane between two textured strips that are shifted by 6 pixels.
    let (_, right) = pair(80, 20, 0, 250, 3);
    let plane = |x: usize, v: u8| if (30..50).contains(&x) { 128 } else { v };
    let pixels = |shift: usize| {
        let at = |i: usize| {
            let x = (i % 80).saturating_sub(shift);
            plane(x, right.row(i / 80)[x])
        };
        GrayImage::new(80, 20, (0..80 * 20).map(at).collect()).unwrap()
    };
    let (left, right) = (&pixels(6), &pixels(0));
    let case = Case {
        s: SemiGlobalSettings::default(),
        min_disparity: 0,
        disparities: 16,
        uniqueness_percent: 0,
        left,
        right,
    };
    let out = run(&case, None).matches;
    for y in 0..20 {
        for x in 20..75 {
            let found = out.disparity.row(y)[x];
            assert!((found - 6.0).abs() < 0.6, "({x}, {y}): {found}");
        }
    }
}

#[test]
fn impossible_settings_and_images_are_refused() {
    let base = SemiGlobalSettings::default();
    let refuse = |s| SemiGlobalMatcher::new(s, 0, 16).unwrap_err().to_string();
    assert_eq!(
        refuse(SemiGlobalSettings { block: 4, ..base }),
        "stereo.semi_global.block: expected an odd number from 1 to 15, found 4"
    );
    assert_eq!(
        refuse(SemiGlobalSettings { p2: 199, ..base }),
        "stereo.semi_global.p2: expected a number from semi_global.p1 to 65535, found 199"
    );
    assert!(refuse(SemiGlobalSettings { paths: 5, ..base }).contains("4 or 8, found 5"));
    assert!(refuse(SemiGlobalSettings { sobel_cap: 97, ..base }).contains("sobel_cap"));
    let few = SemiGlobalMatcher::new(base, 0, 0).unwrap_err().to_string();
    assert!(few.contains("stereo.disparities"), "{few}");
    let ((left, _), (_, other)) = (pair(10, 6, 1, 9, 1), pair(11, 6, 1, 9, 1));
    assert!(SemiGlobalMatcher::new(base, 0, 16).unwrap().run(&left, &other, false, None).is_err());
}
