//! The pairs that matchers are tested on, and what a winner's neighbours and rivals make of it.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

use evigrid_core::{GrayImage, Matching};

/// A textured right image and a left image that is it, shifted, with noise: some structure and many ties.
pub fn pair(width: usize, height: usize, shift: usize, grey_levels: u8, seed: u64) -> (GrayImage, GrayImage) {
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

/// The lowest point of the parabola through three costs, from the middle one; 0 without a parabola.
pub fn parabola_offset(costs: [i64; 3]) -> f64 {
    let [a, b, c] = costs.map(|v| v as f64);
    if a - 2.0 * b + c > 0.0 { (a - c) / (2.0 * (a - 2.0 * b + c)) } else { 0.0 }
}

/// Checks disparity and peak ratio of pixel (x, y), given the disparity and its curve of costs.
pub fn check_match(out: &Matching, x: usize, y: usize, expected: f64, curve: &[i64]) {
    let at = y * out.matches.disparity.width() + x;
    let disparity = f64::from(out.matches.disparity.values()[at]);
    assert!((disparity - expected).abs() < 1e-4, "({x}, {y}): {disparity}, expected {expected}");
    let ratio = match local_minima(curve)[..] {
        [_] => f64::INFINITY,
        [0, 0, ..] => 1.0,
        [first, second, ..] => second as f64 / first as f64,
        [] => unreachable!("a curve with a winner has a minimum"),
    };
    let found = f64::from(out.matches.peak_ratio[at]);
    assert!(found == ratio || (found - ratio).abs() < 1e-5 * ratio, "({x}, {y}): {found}, expected {ratio}");
}
