//! The block matcher against a slow, obvious twin that follows the definitions word for word.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{check_match, pair, parabola_offset};
use evigrid_core::{GrayImage, Matching, NO_COST};
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};
use proptest::prelude::*;

/// Cost curve of one pixel: `None` where the window does not lie in both images.
fn curve(s: &BlockMatchingSettings, left: &GrayImage, right: &GrayImage, x: i64, y: i64) -> Vec<Option<i64>> {
    let (w, h, r) = (left.width() as i64, left.height() as i64, s.window as i64 / 2);
    let pixel = |image: &GrayImage, x: i64, y: i64| i64::from(image.row(y as usize)[x as usize]);
    let fits = |x: i64| x - r >= 0 && x + r < w && y - r >= 0 && y + r < h;
    (s.min_disparity..s.min_disparity + s.disparities)
        .map(|d| {
            let xr = x - d as i64;
            (fits(x) && fits(xr)).then(|| {
                let offsets = (-r..=r).flat_map(|dy| (-r..=r).map(move |dx| (dx, dy)));
                offsets
                    .map(|(dx, dy)| (pixel(left, x + dx, y + dy) - pixel(right, xr + dx, y + dy)).abs())
                    .sum()
            })
        })
        .collect()
}

/// Index of the lowest cost, smaller disparity first.
fn winner(curve: &[Option<i64>]) -> Option<usize> {
    let lowest = curve.iter().flatten().min()?;
    curve.iter().position(|c| c.as_ref() == Some(lowest))
}

fn check_pixel(
    s: &BlockMatchingSettings,
    left: &GrayImage,
    right: &GrayImage,
    out: &Matching,
    x: usize,
    y: usize,
) {
    let curve_of = |x: i64| curve(s, left, right, x, y as i64);
    let here = curve_of(x as i64);
    let volume = out.volume.as_ref().unwrap();
    let shift = (0..).find(|k| (255 * s.window * s.window) >> k < 65535).unwrap();
    let stored: Vec<_> = here.iter().map(|c| c.map(|c| c >> shift)).collect();
    let costs: Vec<_> = volume.curve(x, y).map(|c| (c != NO_COST).then_some(i64::from(c))).collect();
    assert_eq!(costs, stored, "costs at ({x}, {y})");

    let at = y * left.width() + x;
    let disparity = out.matches.disparity.values()[at];
    let Some(best) = winner(&stored) else {
        assert!(disparity.is_nan() && out.matches.peak_ratio[at].is_nan());
        assert_eq!(out.matches.left_right_difference_px[at], u16::MAX);
        return;
    };
    let whole = s.min_disparity + best;
    let mut expected = whole as f64;
    if best > 0 && best + 1 < stored.len() && stored[best - 1].is_some() && stored[best + 1].is_some() {
        expected += parabola_offset([best - 1, best, best + 1].map(|k| stored[k].unwrap()));
    }
    let measured: Vec<i64> = stored.iter().copied().flatten().collect();
    check_match(out, x, y, expected, &measured);

    // The right image's pixel x - d sees the left image's costs along x - d + d'.
    let right_x = x - whole;
    let right_curve: Vec<_> = (0..s.disparities)
        .map(|k| {
            let x = right_x + s.min_disparity + k;
            (x < left.width()).then(|| curve_of(x as i64)[k].map(|c| c >> shift)).flatten()
        })
        .collect();
    let difference = winner(&right_curve).unwrap().abs_diff(best);
    assert_eq!(usize::from(out.matches.left_right_difference_px[at]), difference, "({x}, {y})");
}

fn check(s: BlockMatchingSettings, left: &GrayImage, right: &GrayImage) {
    let out = BlockMatcher::new(s).unwrap().run(left, right, true, None).unwrap();
    for y in 0..left.height() {
        for x in 0..left.width() {
            check_pixel(&s, left, right, &out, x, y);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn equals_the_slow_twin(
        (width, height) in (3..40_usize, 3..14_usize),
        radius in 0..3_usize,
        min_disparity in 0..6_usize,
        disparities in 1..24_usize,
        shift in 0..12_usize,
        grey_levels in 1..6_u8,
        seed: u64,
    ) {
        let window = (2 * radius + 1).min((width.min(height) - 1) / 2 * 2 + 1);
        let (left, right) = pair(width, height, shift, grey_levels, seed);
        check(BlockMatchingSettings { window, min_disparity, disparities }, &left, &right);
    }
}

#[test]
fn windows_of_every_kind_equal_the_slow_twin() {
    let (left, right) = pair(60, 40, 5, 200, 7);
    for window in [1, 3, 5, 7, 9, 11, 13, 15, 17, 21, 33] {
        check(BlockMatchingSettings { window, min_disparity: 1, disparities: 9 }, &left, &right);
    }
}

#[test]
fn a_shifted_image_is_found_with_its_shift() {
    let (_, right) = pair(80, 20, 0, 250, 3);
    let pixels = (0..80 * 20).map(|i| right.row(i / 80)[(i % 80_usize).saturating_sub(6)]).collect();
    let left = GrayImage::new(80, 20, pixels).unwrap();
    let settings = BlockMatchingSettings { disparities: 16, ..Default::default() };
    let out = BlockMatcher::new(settings).unwrap().run(&left, &right, false, None).unwrap().matches;
    for y in 3..17 {
        for x in 20..77 {
            let at = y * 80 + x;
            assert!((out.disparity.values()[at] - 6.0).abs() < 0.2);
            assert_eq!(out.peak_ratio[at], f32::INFINITY, "cost 0 at the true disparity only");
            assert_eq!(out.left_right_difference_px[at], 0);
        }
    }
}

#[test]
fn threads_and_recycled_buffers_do_not_change_a_byte() {
    let (left, right) = pair(90, 37, 4, 90, 11);
    let (other_left, other_right) = pair(70, 50, 9, 90, 12);
    let settings = BlockMatchingSettings { disparities: 20, ..Default::default() };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut matcher = BlockMatcher::new(settings).unwrap();
            let first = matcher.run(&other_left, &other_right, true, None).unwrap();
            matcher.run(&left, &right, true, Some(first)).unwrap()
        })
    };
    let fresh = BlockMatcher::new(settings).unwrap().run(&left, &right, true, None).unwrap();
    for threads in [1, 2, 5] {
        let out = run(threads);
        let bits = |m: &Matching| {
            let values = m.matches.disparity.values().iter().chain(&m.matches.peak_ratio);
            values.map(|v| v.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&out), bits(&fresh));
        assert_eq!(out.matches.left_right_difference_px, fresh.matches.left_right_difference_px);
        assert_eq!(out.volume, fresh.volume);
    }
}

#[test]
fn impossible_settings_and_images_are_refused() {
    let base = BlockMatchingSettings::default();
    let refuse = |s| BlockMatcher::new(s).unwrap_err().to_string();
    assert_eq!(
        refuse(BlockMatchingSettings { window: 4, ..base }),
        "stereo.window: expected an odd number from 1 to 255, found 4"
    );
    assert!(refuse(BlockMatchingSettings { disparities: 0, ..base }).contains("stereo.disparities"));
    let (left, right) = pair(10, 6, 1, 9, 1);
    let error = BlockMatcher::new(base).unwrap().run(&left, &right, false, None).unwrap_err();
    assert_eq!(error.to_string(), "stereo.window: expected a window within the 10x6 image, found 7");
    let (_, other) = pair(11, 6, 1, 9, 1);
    assert!(BlockMatcher::new(base).unwrap().run(&left, &other, false, None).is_err());
}
