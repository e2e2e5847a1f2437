//! The multi-scale matcher against a slow, obvious twin, and on a pair with a wall that fine windows cannot
//! match.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::pair;
use evigrid_core::{GrayImage, Matches, Matching};
use evigrid_stereo::{
    BlockMatcher, BlockMatchingSettings, Extras, Matcher, MatcherKind, MultiScaleMatcher, MultiScaleSettings,
    PairTask, StereoSettings, texture,
};
use proptest::prelude::*;

/// Disparity, peak ratio and left-right difference of one pixel.
type Reading = (f32, f32, u16);

/// The twin: the matches of every scale, finest first, each with its width, height and hypotheses.
struct Twin {
    settings: MultiScaleSettings,
    scales: Vec<(Matches, BlockMatchingSettings, Vec<u32>)>,
}

fn halved(image: &GrayImage) -> GrayImage {
    let (width, height) = (image.width() / 2, image.height() / 2);
    let mean = |x: usize, y: usize| {
        let pixels = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| image.row(2 * y + j)[2 * x + i]);
        (pixels.map(f64::from).iter().sum::<f64>() / 4.0 + 0.5).floor() as u8
    };
    let pixels = (0..width * height).map(|i| mean(i % width, i / width)).collect();
    GrayImage::new(width, height, pixels).unwrap()
}

impl Twin {
    fn new(s: MultiScaleSettings, block: BlockMatchingSettings, left: &GrayImage, right: &GrayImage) -> Self {
        let (mut left, mut right, mut scales) = (left.clone(), right.clone(), Vec::new());
        let (first, last) =
            (block.min_disparity as f64, (block.min_disparity + block.disparities - 1) as f64);
        for scale in 0..s.scales {
            let step = f64::from(1 << scale);
            let (first, last) = ((first / step).floor() as usize, (last / step).ceil() as usize);
            let block =
                BlockMatchingSettings { min_disparity: first, disparities: last + 1 - first, ..block };
            let matcher = BlockMatcher::new(block).unwrap().with_uniqueness(s.uniqueness_percent as u32);
            let matches = { matcher }.run(&left, &right, false, None).unwrap().matches;
            scales.push((matches, block, texture(&left, 31, block.window).unwrap()));
            (left, right) = (halved(&left), halved(&right));
        }
        Self { settings: s, scales }
    }

    /// The finished reading of a pixel of a scale, in pixels of that scale.
    fn reading(&self, scale: usize, x: usize, y: usize) -> Option<Reading> {
        let (matches, block, texture) = self.scales.get(scale)?;
        let (width, height) = (matches.disparity.width(), matches.disparity.height());
        if x >= width || y >= height {
            return None;
        }
        let at = y * width + x;
        let own =
            (matches.disparity.values()[at], matches.peak_ratio[at], matches.left_right_difference_px[at]);
        let agrees = usize::from(own.2) <= self.settings.left_right_px;
        if !own.0.is_nan() && agrees && texture[at] as usize >= self.settings.texture_threshold {
            return Some(own);
        }
        let coarse = self.reading(scale + 1, x / 2, y / 2)?;
        // The centre of the pixel among the centres of the coarse pixels, and the four around it.
        let (u, v) = ((x as f64 - 0.5) / 2.0, (y as f64 - 0.5) / 2.0);
        let mut sum = [0.0_f32; 10];
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (i, j) = (u.floor() + f64::from(dx), v.floor() + f64::from(dy));
            let sixteenths = 16.0 * (1.0 - (u - i).abs()) * (1.0 - (v - j).abs());
            // The border of the coarse image is repeated outwards.
            let (i, j) = (i.clamp(0.0, (width / 2 - 1) as f64), j.clamp(0.0, (height / 2 - 1) as f64));
            let there = self.reading(scale + 1, i as usize, j as usize);
            let alike = there.map(|r| r.0).filter(|d| (d - coarse.0).abs() <= 1.0);
            sum[sixteenths as usize] += alike.unwrap_or(coarse.0);
        }
        // Weights 9, 3, 3 and 1 sixteenths; added in the matcher's order, so that not a bit differs.
        let disparity = (9.0 * sum[9] + 3.0 * sum[3] + sum[1]) / 16.0 * 2.0;
        let last = (block.min_disparity + block.disparities - 1) as f32;
        let is_tried = disparity >= block.min_disparity as f32 && disparity <= last;
        is_tried.then_some((disparity, coarse.1, coarse.2 * 2))
    }
}

fn check(s: MultiScaleSettings, block: BlockMatchingSettings, left: &GrayImage, right: &GrayImage) {
    let out = MultiScaleMatcher::new(s, block).unwrap().run(left, right, None).unwrap();
    assert!(out.volume.is_none() && out.road.is_none());
    let twin = Twin::new(s, block, left, right);
    for (y, x) in (0..left.height()).flat_map(|y| (0..left.width()).map(move |x| (y, x))) {
        let at = y * left.width() + x;
        let Matches { disparity, peak_ratio, left_right_difference_px: left_right } = &out.matches;
        let found = (disparity.values()[at].to_bits(), peak_ratio[at].to_bits(), left_right[at]);
        let (d, ratio, difference) = twin.reading(0, x, y).unwrap_or((f32::NAN, f32::NAN, u16::MAX));
        assert_eq!(found, (d.to_bits(), ratio.to_bits(), difference), "({x}, {y}): expected {d}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    #[test]
    fn equals_the_slow_twin(
        (width, height) in (20..60_usize, 20..40_usize),
        radius in 0..3_usize,
        min_disparity in 0..6_usize,
        disparities in 1..20_usize,
        shift in 0..12_usize,
        grey_levels in 1..6_u8,
        (scales, left_right_px) in (2..4_usize, 0..4_usize),
        (uniqueness_percent, texture_threshold) in (0..40_usize, 0..1200_usize),
        seed: u64,
    ) {
        let window = 2 * radius + 1;
        let (left, right) = pair(width, height, shift, grey_levels, seed);
        let s = MultiScaleSettings { scales, left_right_px, uniqueness_percent, texture_threshold };
        check(s, BlockMatchingSettings { window, min_disparity, disparities }, &left, &right);
    }
}

/// Largest disparity of the wall, and its place in the left image.
const WALL_DISPARITY: usize = 9;
const BLANK: [std::ops::Range<usize>; 2] = [60..72, 30..42];

/// A textured wall that stands askew (its disparity falls from 9 to 5 px down the image) with a blank square
/// on it. Its texture is coarse, so that it survives a halving; each image has noise of its own, 0 to 4 grey
/// levels.
fn wall(width: usize, height: usize) -> (GrayImage, GrayImage) {
    let coarse: Vec<f64> = {
        let (noise, _) = pair(width, height, 0, 200, 5);
        noise.pixels().iter().map(|&v| f64::from(v)).collect()
    };
    // The grey level at a place of the left image, between its pixels.
    let grey = |x: f64, y: usize| {
        let (i, part) = ((x / 3.0).floor().max(0.0) as usize, (x / 3.0).fract());
        let at = |i: usize| coarse[(y / 3) * width + i];
        if BLANK[0].contains(&(x.max(0.0) as usize)) && BLANK[1].contains(&y) {
            128.0
        } else {
            at(i) * (1.0 - part) + at(i + 1) * part
        }
    };
    let image = |shift: &dyn Fn(usize) -> f64, seed| {
        let (noise, _) = pair(width, height, 0, 4, seed);
        let pixel = |(i, &noise): (usize, &u8)| {
            let (x, y) = (i % width, i / width);
            (grey(x as f64 + shift(y), y) + f64::from(noise / 63)) as u8
        };
        GrayImage::new(width, height, noise.pixels().iter().enumerate().map(pixel).collect()).unwrap()
    };
    (image(&|_| 0.0, 1), image(&|y| wall_disparity(y, height), 2))
}

fn wall_disparity(y: usize, height: usize) -> f64 {
    WALL_DISPARITY as f64 - 4.0 * y as f64 / height as f64
}

#[test]
fn a_blank_patch_is_filled_in_and_what_was_matched_stays() {
    let (width, height) = (140, 80);
    let (left, right) = wall(width, height);
    let block = BlockMatchingSettings { disparities: 24, ..Default::default() };
    let s = MultiScaleSettings { texture_threshold: 300, ..Default::default() };
    let run = |s| MultiScaleMatcher::new(s, block).unwrap().run(&left, &right, None).unwrap().matches;
    let two = run(s);
    let fine = Twin::new(MultiScaleSettings { scales: 1, ..s }, block, &left, &right);
    let (mut gaps, mut filled, mut worst) = (0, 0, 0.0_f64);
    for (y, x) in BLANK[1].clone().flat_map(|y| BLANK[0].clone().map(move |x| (y, x))) {
        if fine.reading(0, x, y).is_none() {
            let found = two.disparity.row(y)[x];
            (gaps, filled) = (gaps + 1, filled + usize::from(!found.is_nan()));
            worst = worst.max((f64::from(found) - wall_disparity(y, height)).abs());
        }
    }
    assert!(gaps > 20 && filled == gaps, "{filled} of {gaps} gaps are filled");
    assert!(worst < 0.6, "{worst}");
    let mut matched = 0;
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        if let Some((d, ..)) = fine.reading(0, x, y) {
            matched += 1;
            assert_eq!(two.disparity.row(y)[x].to_bits(), d.to_bits(), "({x}, {y})");
        }
    }
    assert!(two.disparity.valid_count() >= matched + gaps);
    let three = run(MultiScaleSettings { scales: 3, ..s });
    assert!(three.disparity.valid_count() >= two.disparity.valid_count());
}

#[test]
fn where_no_scale_sees_texture_there_is_no_reading() {
    let blank = GrayImage::new(64, 48, vec![90; 64 * 48]).unwrap();
    for scales in [2, 3] {
        let s = MultiScaleSettings { scales, uniqueness_percent: 0, ..Default::default() };
        let matches =
            MultiScaleMatcher::new(s, BlockMatchingSettings { disparities: 12, ..Default::default() })
                .unwrap()
                .run(&blank, &blank, None)
                .unwrap()
                .matches;
        assert_eq!(matches.disparity.valid_count(), 0);
        assert!(matches.peak_ratio.iter().all(|v| v.is_nan()));
        assert!(matches.left_right_difference_px.iter().all(|&v| v == u16::MAX));
    }
}

fn bits(m: &Matching) -> (Vec<u32>, Vec<u16>) {
    let values = m.matches.disparity.values().iter().chain(&m.matches.peak_ratio);
    (values.map(|v| v.to_bits()).collect(), m.matches.left_right_difference_px.clone())
}

#[test]
fn threads_and_recycled_buffers_do_not_change_a_byte() {
    let (left, right) = pair(90, 37, 4, 90, 11);
    let (other_left, other_right) = pair(70, 50, 9, 90, 12);
    let block = BlockMatchingSettings { disparities: 20, ..Default::default() };
    let settings = MultiScaleSettings { scales: 3, ..Default::default() };
    let matcher = || MultiScaleMatcher::new(settings, block).unwrap();
    let fresh = matcher().run(&left, &right, None).unwrap();
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let out = pool.install(|| {
            let mut matcher = matcher();
            let first = matcher.run(&other_left, &other_right, None).unwrap();
            matcher.run(&left, &right, Some(first)).unwrap()
        });
        assert!(bits(&out) == bits(&fresh), "{threads} threads");
    }
}

#[test]
fn the_named_matcher_takes_window_disparities_and_cap_of_the_settings() {
    let (left, right) = pair(90, 40, 4, 5, 3);
    let multi_scale = MultiScaleSettings { texture_threshold: 490, ..Default::default() };
    let settings = StereoSettings {
        matcher: MatcherKind::MultiScale,
        window: 5,
        min_disparity: 2,
        disparities: 12,
        pre_filter_cap: 20,
        multi_scale,
        ..Default::default()
    };
    let named = Matcher::new(settings).unwrap().run(PairTask::new(&left, &right, Extras::default())).unwrap();
    let plain = MultiScaleMatcher::new(multi_scale, settings.block()).unwrap();
    let capped = plain.with_texture_cap(20).run(&left, &right, None).unwrap();
    assert!(bits(&named) == bits(&capped));
    let other = StereoSettings { pre_filter_cap: 31, ..settings };
    let other = Matcher::new(other).unwrap().run(PairTask::new(&left, &right, Extras::default())).unwrap();
    assert!(bits(&named) != bits(&other));
}

#[test]
fn impossible_settings_and_images_are_refused() {
    let base = MultiScaleSettings::default();
    let refuse =
        |multi_scale| StereoSettings { multi_scale, ..Default::default() }.checked().unwrap_err().to_string();
    for scales in [0, 1, 4] {
        let expected = format!("stereo.multi_scale.scales: expected 2 or 3, found {scales}");
        assert_eq!(refuse(MultiScaleSettings { scales, ..base }), expected);
    }
    assert_eq!(
        refuse(MultiScaleSettings { left_right_px: 4097, ..base }),
        "stereo.multi_scale.left_right_px: expected a number from 0 to 4096, found 4097"
    );
    assert_eq!(
        refuse(MultiScaleSettings { uniqueness_percent: 100, ..base }),
        "stereo.multi_scale.uniqueness_percent: expected a number from 0 to 99, found 100"
    );
    let block = BlockMatchingSettings::default();
    assert!(MultiScaleMatcher::new(base, BlockMatchingSettings { window: 4, ..block }).is_err());
    let run = |scales, (left, right): (GrayImage, GrayImage)| {
        let s = MultiScaleSettings { scales, ..base };
        MultiScaleMatcher::new(s, block)
            .unwrap()
            .run(&left, &right, None)
            .map(|_| ())
            .map_err(|e| e.to_string())
    };
    assert_eq!(run(2, pair(20, 15, 1, 9, 1)), Ok(()));
    let small = "stereo.window: expected a window within the 5x3 image of the coarsest scale, found 7";
    assert_eq!(run(3, pair(20, 15, 1, 9, 1)), Err(small.to_owned()));
    assert!(run(2, pair(1, 1, 0, 9, 1)).is_err());
    let unlike = run(2, (pair(40, 30, 1, 9, 1).0, pair(41, 30, 1, 9, 1).1)).unwrap_err();
    assert!(unlike.contains("right image"), "{unlike}");
}
