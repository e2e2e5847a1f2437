//! Semi-global matching against a slow, obvious twin that follows the definitions word for word.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../common/mod.rs"]
mod common;
mod twin;

use common::pair;
use evigrid_core::{GrayImage, Matching};
use evigrid_stereo::{PixelCost, SemiGlobalMatcher, SemiGlobalSettings};
use proptest::prelude::*;
use twin::{Case, check_pixel, path_sums};

fn run(case: &Case<'_>, recycled: Option<Matching>) -> Matching {
    let (min_disparity, disparities) = (case.min_disparity as usize, case.disparities as usize);
    let matcher = SemiGlobalMatcher::new(case.s, min_disparity..min_disparity + disparities).unwrap();
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
            let mut matcher = SemiGlobalMatcher::new(s, 0..20).unwrap();
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
    let refuse = |s| SemiGlobalMatcher::new(s, 0..16).unwrap_err().to_string();
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
    let few = SemiGlobalMatcher::new(base, 0..0).unwrap_err().to_string();
    assert!(few.contains("stereo.disparities"), "{few}");
    let ((left, _), (_, other)) = (pair(10, 6, 1, 9, 1), pair(11, 6, 1, 9, 1));
    assert!(SemiGlobalMatcher::new(base, 0..16).unwrap().run(&left, &other, false, None).is_err());
}
