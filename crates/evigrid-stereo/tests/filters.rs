//! Pre- and post-filters against slow, obvious twins.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{CostScale, Disparity, DisparityPlane, GrayImage, Matching, NO_COST};
use evigrid_stereo::{
    BlockMatcher, BlockMatchingSettings, Extras, GraphCutMatcher, GraphCutSettings, Matcher, MatcherKind,
    PairTask, PreFilter, SemiGlobalMatcher, SemiGlobalSettings, StereoSettings, speckles, texture,
};
use proptest::prelude::*;

/// Asks for the cost volume.
const COSTS: Extras = Extras { costs: true, road: false };

fn random(seed: u64) -> impl FnMut() -> u8 {
    let mut state = seed | 1;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u8
    }
}

fn image(width: usize, height: usize, seed: u64) -> GrayImage {
    let mut random = random(seed);
    GrayImage::new(width, height, (0..width * height).map(|_| random()).collect()).unwrap()
}

/// A pixel of an image whose border is repeated outwards.
fn pixel(image: &GrayImage, x: i64, y: i64) -> i64 {
    let inside = |v: i64, n: usize| v.clamp(0, n as i64 - 1) as usize;
    i64::from(image.row(inside(y, image.height()))[inside(x, image.width())])
}

fn sobel(image: &GrayImage, x: i64, y: i64, cap: i64) -> i64 {
    let column = |x: i64| pixel(image, x, y - 1) + 2 * pixel(image, x, y) + pixel(image, x, y + 1);
    (column(x + 1) - column(x - 1)).clamp(-cap, cap)
}

/// The sum of `value` over the window around a pixel, at places inside the image.
fn window_sum(image: &GrayImage, x: i64, y: i64, window: i64, value: &dyn Fn(i64, i64) -> i64) -> i64 {
    let (right, bottom, r) = (image.width() as i64 - 1, image.height() as i64 - 1, window / 2);
    let offsets = (-r..=r).flat_map(|dy| (-r..=r).map(move |dx| (dx, dy)));
    offsets.map(|(dx, dy)| value((x + dx).clamp(0, right), (y + dy).clamp(0, bottom))).sum()
}

proptest! {
    #[test]
    fn pre_filters_and_texture_equal_their_slow_twins(
        (width, height) in (1..20_usize, 1..12_usize), radius in 0..6_usize, cap in 1..128_usize, seed: u64,
    ) {
        let image = image(width, height, seed);
        let (window, c) = (2 * radius + 1, cap as i64);
        let [sobel_x, normalized] =
            [PreFilter::SobelX, PreFilter::Normalized].map(|f| f.apply(&image, cap, window).unwrap());
        prop_assert_eq!(&PreFilter::None.apply(&image, cap, window).unwrap(), &image);
        let texture = texture(&image, cap, window).unwrap();
        for (y, x) in (0..height as i64).flat_map(|y| (0..width as i64).map(move |x| (y, x))) {
            prop_assert_eq!(pixel(&sobel_x, x, y), sobel(&image, x, y, c) + c);
            let sum = window_sum(&image, x, y, window as i64, &|x, y| pixel(&image, x, y));
            let response = pixel(&image, x, y) - sum / (window * window) as i64;
            prop_assert_eq!(pixel(&normalized, x, y), response.clamp(-c, c) + c);
            let sum = window_sum(&image, x, y, window as i64, &|x, y| sobel(&image, x, y, c).abs());
            prop_assert_eq!(i64::from(texture[y as usize * width + x as usize]), sum);
        }
    }

    #[test]
    fn speckles_equal_their_slow_twin(
        (width, height) in (1..16_usize, 1..12_usize), most in 0..8_usize, step in 0..4_u8, seed: u64,
    ) {
        let mut random = random(seed);
        let mut value = || match random() % 6 { 0 => f32::NAN, v => f32::from(v) };
        let values: Vec<f32> = (0..width * height).map(|_| value()).collect();
        let image = Disparity::new(width, height, values.clone()).unwrap();
        let found = speckles(&image, most, f32::from(step));
        // Labels spread to neighbours until none changes.
        let mut labels: Vec<usize> = (0..values.len()).collect();
        loop {
            let before = labels.clone();
            for (i, j) in (0..values.len()).flat_map(|i| (0..values.len()).map(move |j| (i, j))) {
                let beside = i.abs_diff(j) == 1 && i / width == j / width || i.abs_diff(j) == width;
                if beside && (values[i] - values[j]).abs() <= f32::from(step) {
                    labels[i] = labels[i].min(labels[j]);
                }
            }
            if labels == before { break }
        }
        for i in 0..values.len() {
            let size = labels.iter().filter(|&&label| label == labels[i]).count();
            prop_assert_eq!(found[i], !values[i].is_nan() && size <= most);
        }
    }

    #[test]
    fn uniqueness_of_block_matching_equals_its_slow_twin(
        percent in 1..60_u32, disparities in 1..24_usize, shift in 0..6_usize, seed: u64,
    ) {
        let right = image(40, 9, seed);
        let mut noise = random(seed ^ 7);
        let pixels = (0..40 * 9).map(|i| match noise() % 4 {
            0 => noise(),
            _ => right.row(i / 40)[(i % 40).saturating_sub(shift)],
        });
        let left = GrayImage::new(40, 9, pixels.collect()).unwrap();
        let settings = BlockMatchingSettings { window: 3, min_disparity: 1, disparities };
        let matcher = || BlockMatcher::new(settings).unwrap();
        let all = matcher().run(&left, &right, true, None).unwrap();
        let unique = matcher().with_uniqueness(percent).run(&left, &right, true, None).unwrap();
        prop_assert_eq!(&all.volume, &unique.volume);
        for (y, x) in (0..9).flat_map(|y| (0..40).map(move |x| (y, x))) {
            let curve: Vec<u16> = all.volume.as_ref().unwrap().curve(x, y).collect();
            let lowest = *curve.iter().min().unwrap();
            let best = curve.iter().position(|c| *c == lowest).unwrap();
            let rivals = curve.iter().enumerate().filter(|(d, c)| d.abs_diff(best) > 1 && **c != NO_COST);
            let kept = lowest != NO_COST
                && rivals.map(|(_, c)| u32::from(*c)).all(|c| c * (100 - percent) >= 100 * u32::from(lowest));
            let at = y * 40 + x;
            let (before, after) = (all.matches.disparity.values()[at], unique.matches.disparity.values()[at]);
            prop_assert_eq!(after.to_bits(), if kept { before } else { f32::NAN }.to_bits());
            prop_assert_eq!(unique.matches.peak_ratio[at].is_nan(), !kept);
            prop_assert_eq!(unique.matches.left_right_difference_px[at] == u16::MAX, !kept);
        }
    }
}

#[test]
fn without_filters_the_named_matcher_is_the_matcher() {
    let (left, right) = (image(60, 20, 1), image(60, 20, 2));
    let settings = StereoSettings { disparities: 20, ..Default::default() };
    let bits =
        |m: &Matching| -> Vec<u32> { m.matches.disparity.values().iter().map(|v| v.to_bits()).collect() };
    let block = BlockMatcher::new(settings.block()).unwrap().run(&left, &right, true, None).unwrap();
    let named = Matcher::new(settings).unwrap().run(PairTask::new(&left, &right, COSTS)).unwrap();
    assert_eq!((bits(&named), &named.volume), (bits(&block), &block.volume));
    let semi_global = StereoSettings { matcher: MatcherKind::SemiGlobal, ..settings };
    let named = Matcher::new(semi_global)
        .unwrap()
        .run(PairTask { recycled: Some(named), ..PairTask::new(&left, &right, COSTS) })
        .unwrap();
    let mut plain = SemiGlobalMatcher::new(settings.semi_global, 0..20).unwrap();
    let plain = plain.run(&left, &right, true, None).unwrap();
    assert_eq!((bits(&named), &named.volume), (bits(&plain), &plain.volume));
    let graph_cuts = StereoSettings { matcher: MatcherKind::GraphCuts, ..settings };
    let named = Matcher::new(graph_cuts)
        .unwrap()
        .run(PairTask { recycled: Some(named), ..PairTask::new(&left, &right, COSTS) })
        .unwrap();
    let plain = GraphCutMatcher::new(settings.graph_cuts, 0..20).unwrap();
    let plain = plain.run(&left, &right, None).unwrap();
    assert_eq!((bits(&named), &named.volume), (bits(&plain), &plain.volume));
}

#[test]
fn matchers_give_the_extras_that_they_offer_and_no_others() {
    let (left, right) = (image(60, 30, 1), image(60, 30, 2));
    let centre_px = [30.0, 10.0];
    let ground = DisparityPlane { at_centre_px: 0.0, per_column: 0.0, per_row: 0.2, centre_px };
    // Exact disparities come from a world, not from a pair.
    for matcher in MatcherKind::ALL.into_iter().filter(|&kind| kind != MatcherKind::Exact) {
        let settings = StereoSettings { matcher, disparities: 20, ..Default::default() };
        let run = |wanted| {
            let task = PairTask { ground: Some(ground), ..PairTask::new(&left, &right, wanted) };
            Matcher::new(settings).unwrap().run(task).unwrap()
        };
        let all = run(Extras { costs: true, road: true });
        let given = Extras { costs: all.volume.is_some(), road: all.road.is_some() };
        assert_eq!(given, matcher.offers(), "{}", matcher.name());
        let plain = run(Extras::default());
        assert!(plain.volume.is_none() && plain.road.is_none(), "{}", matcher.name());
    }
}

#[test]
fn volumes_carry_the_unit_of_their_costs() {
    let (left, right) = (image(60, 20, 1), image(60, 20, 2));
    let scale = |settings| {
        let volume = Matcher::new(settings).unwrap().run(PairTask::new(&left, &right, COSTS)).unwrap().volume;
        volume.unwrap().scale()
    };
    let block = StereoSettings { disparities: 20, ..Default::default() };
    assert_eq!(scale(block), CostScale { window_pixels: 49.0, grey_levels: 1.0 });
    let large = StereoSettings { window: 17, ..block };
    assert_eq!(scale(large), CostScale { window_pixels: 289.0, grey_levels: 2.0 });
    let semi_global = StereoSettings { matcher: MatcherKind::SemiGlobal, ..block };
    assert_eq!(scale(semi_global), CostScale { window_pixels: 25.0, grey_levels: 1.0 });
    let large = SemiGlobalSettings { block: 15, ..Default::default() };
    let large = StereoSettings { semi_global: large, ..semi_global };
    assert_eq!(scale(large), CostScale { window_pixels: 225.0, grey_levels: 4.0 });
}

#[test]
fn filters_of_the_named_matcher_drop_matches() {
    let (left, right) = (image(60, 20, 1), image(60, 20, 2));
    let base = StereoSettings { disparities: 20, ..Default::default() };
    let count = |settings| {
        let mut matcher = Matcher::new(settings).unwrap();
        matcher.run(PairTask::new(&left, &right, Extras::default())).unwrap().matches.disparity.valid_count()
    };
    let all = count(base);
    assert_eq!(count(StereoSettings { texture_threshold: 100_000, ..base }), 0);
    assert_eq!(count(StereoSettings { speckle_pixels: 1200, ..base }), 0);
    assert!(count(StereoSettings { speckle_pixels: 3, ..base }) < all);
    assert!(count(StereoSettings { uniqueness_percent: 15, ..base }) < all);
}

/// A pre-filter named in the settings is what both images go through.
#[test]
fn the_named_pre_filter_is_applied_to_both_images() {
    let (left, right) = (image(60, 20, 1), image(60, 20, 2));
    let base = StereoSettings { disparities: 20, ..Default::default() };
    for pre_filter in [PreFilter::SobelX, PreFilter::Normalized] {
        let settings = StereoSettings { pre_filter, ..base };
        let [l, r] = [&left, &right]
            .map(|image| pre_filter.apply(image, base.pre_filter_cap, base.pre_filter_window).unwrap());
        let expected = BlockMatcher::new(base.block()).unwrap().run(&l, &r, true, None).unwrap();
        let found = Matcher::new(settings).unwrap().run(PairTask::new(&left, &right, COSTS)).unwrap();
        assert_eq!(found.volume, expected.volume);
        let plain = Matcher::new(base).unwrap().run(PairTask::new(&left, &right, COSTS)).unwrap();
        assert_ne!(found.volume, plain.volume);
    }
}

#[test]
fn pairs_that_are_too_large_are_refused() {
    let side = image(1024, 1024, 1);
    let mut matcher = SemiGlobalMatcher::new(Default::default(), 0..4096).unwrap();
    let error = matcher.run(&side, &side, false, None).unwrap_err().to_string();
    assert_eq!(
        error,
        "semi-global matching: expected at most 2147483648 costs, found 1024x1024 pixels with 4096 disparities"
    );
    let side = image(4096, 1025, 1);
    let matcher = GraphCutMatcher::new(GraphCutSettings::default(), 0..16).unwrap();
    let error = matcher.run(&side, &side, None).unwrap_err().to_string();
    assert_eq!(error, "graph cuts: expected an image of at most 4194304 pixels, found 4096x1025");
}

#[test]
fn impossible_settings_are_refused() {
    let base = StereoSettings::default();
    let refuse = |s: StereoSettings| s.checked().unwrap_err().to_string();
    assert_eq!(
        refuse(StereoSettings { uniqueness_percent: 100, ..base }),
        "stereo.uniqueness_percent: expected a number from 0 to 99, found 100"
    );
    assert!(refuse(StereoSettings { pre_filter_cap: 128, ..base }).contains("stereo.pre_filter_cap"));
    assert!(refuse(StereoSettings { pre_filter_window: 4, ..base }).contains("stereo.pre_filter_window"));
    assert_eq!(
        refuse(StereoSettings { speckle_step_px: f32::NAN, ..base }),
        "stereo.speckle_step_px: expected a finite number from 0, found NaN"
    );
    let lambda = GraphCutSettings { lambda: -1.0, ..Default::default() };
    assert_eq!(
        refuse(StereoSettings { graph_cuts: lambda, ..base }),
        "stereo.graph_cuts.lambda: expected a number from 0 to 10000, found -1"
    );
    assert_eq!(
        refuse(StereoSettings { window: 8, ..base }),
        "stereo.window: expected an odd number from 1 to 255, found 8"
    );
}
