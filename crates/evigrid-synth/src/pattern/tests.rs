use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

use super::*;
use crate::random::{Sensor, stream};

const STRIPES: &str = r#"stripes = { along = "v", period_m = 0.5, width_m = 0.2, grey = 220 }"#;
const CHECKS: &str = "checks = { size_m = 0.3, grey = 220 }";
const BRICK: &str = "brick = { length_m = 0.4, height_m = 0.1, joint_m = 0.02, grey = 220, tint = 30 }";
const ROAD: &str = "road = { grey = 220, wear = 0, centre_lines_m = [-0.1, 0.1], edge_lines_m = [-3.2, 3.2], \
    crosswalks = [{ at_m = 12, length_m = 3, from_m = -3, to_m = 3, bar_m = 0.5, gap_m = 0.45 }], \
    stop_lines = [{ at_m = 9.5, width_m = 0.4, from_m = 0, to_m = -3.1 }] }";

const BASE: f32 = 70.0;
/// The greys of all patterns above lie within 40 to 220.
const CONTRAST: f64 = 180.0;

fn pattern(toml: &str) -> Pattern {
    #[derive(Deserialize)]
    struct Line {
        pattern: PatternSpec,
    }
    Pattern::new(toml::from_str::<Line>(&format!("pattern = {{ {toml} }}")).unwrap().pattern)
}

/// A footprint of the given lengths along u and v.
fn rectangle(extents: [f64; 2]) -> Footprint {
    let width_m = extents[0].min(extents[1]);
    Footprint { width_m, span_m: extents.map(|e| (e * e - width_m * width_m).sqrt()) }
}

fn grey(pattern: &Pattern, point: [f64; 2], extents: [f64; 2]) -> f64 {
    f64::from(pattern.apply(BASE, 0.0, point, &rectangle(extents), 3))
}

/// The mean over `n` by `n` points of an area.
fn mean_of_points(pattern: &Pattern, [u, v]: [f64; 2], extents: [f64; 2], n: u32) -> f64 {
    let at = |i: u32, x: f64, extent: f64| x + extent * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
    let points = (0..n * n).map(|i| [at(i % n, u, extents[0]), at(i / n, v, extents[1])]);
    points.map(|point| grey(pattern, point, [1e-7; 2])).sum::<f64>() / f64::from(n * n)
}

fn random() -> ChaCha8Rng {
    stream(1, 0, Sensor::Left, 0)
}

fn uniform(rng: &mut ChaCha8Rng, from: f64, to: f64) -> f64 {
    from + (to - from) * f64::from(rng.next_u32()) / 4_294_967_296.0
}

/// A random length of any size from `to` / 2^`octaves` to `to`.
fn log_uniform(rng: &mut ChaCha8Rng, octaves: f64, to: f64) -> f64 {
    let x = uniform(rng, 0.0, octaves);
    to / (1_u64 << x as u32) as f64 / (1.0 + x.fract())
}

/// Greys are the means over the area, up to one period of the pattern. All edges run along u or v. Each edge
/// moves the mean over a raster of n points by half a point at most, so by contrast / 2n.
#[test]
fn every_grey_is_the_mean_over_the_footprint() {
    let n = 300;
    for (toml, largest, edges) in
        [(STRIPES, [5.0, 0.5], 2), (CHECKS, [0.6, 0.6], 4), (BRICK, [0.4, 0.1], 8), (ROAD, [4.0, 2.0], 16)]
    {
        let pattern = pattern(toml);
        let mut rng = random();
        let (mut sum, mut cases) = (0.0, 0.0);
        for _ in 0..14 {
            let point = [uniform(&mut rng, 6.0, 15.0), uniform(&mut rng, -4.0, 4.0)];
            let extents = largest.map(|e| log_uniform(&mut rng, 6.0, e));
            let found = grey(&pattern, point, extents);
            let error = (found - mean_of_points(&pattern, point, extents, n)).abs();
            let bound = CONTRAST * f64::from(edges) / f64::from(2 * n);
            assert!(error <= bound + 1e-3, "{toml}: {found} at {point:?}, {extents:?}: off by {error}");
            (sum, cases) = (sum + error / bound, cases + 1.0);
        }
        assert!(sum / cases < 0.25, "{toml}: {}", sum / cases);
    }
}

/// Float arithmetic: a share of a footprint of 1 mm some 10 m from the origin is good to
/// 1e-16 * 10 / 1e-3 = 1e-12, a grey in f32 to 1e-5.
const ROUNDING: f64 = 1e-4;

#[test]
fn a_footprint_longer_than_a_period_shows_the_mean_of_a_period() {
    for (toml, period, expected) in [
        (STRIPES, [0.5, 0.5], 70.0 + 0.4 * 150.0),
        (CHECKS, [0.6, 0.6], 145.0),
        (BRICK, [8.0 * 0.4, 8.0 * 0.1], 220.0 - 150.0 * 0.95 * 0.8),
    ] {
        let pattern = pattern(toml);
        let mut rng = random();
        for _ in 0..300 {
            let point = [uniform(&mut rng, -9.0, 9.0), uniform(&mut rng, -9.0, 9.0)];
            let extents = period.map(|p| p * uniform(&mut rng, 1.001, 9.0));
            let found = grey(&pattern, point, extents);
            assert!((found - expected).abs() < ROUNDING, "{toml}: {found} {point:?} {extents:?}");
        }
    }
}

/// When an area moves by a share d of its length along u and v, at most 2 d of it changes.
#[test]
fn greys_have_no_jumps() {
    for toml in [STRIPES, CHECKS, BRICK, ROAD] {
        let pattern = pattern(toml);
        let mut rng = random();
        for _ in 0..20_000 {
            let point = [uniform(&mut rng, 6.0, 15.0), uniform(&mut rng, -4.0, 4.0)];
            let extents = [1.0, 1.0].map(|e| log_uniform(&mut rng, 9.0, e));
            let moved = [point[0] + 0.01 * extents[0].min(0.1), point[1] + 0.01 * extents[1].min(0.1)];
            let jump = (grey(&pattern, point, extents) - grey(&pattern, moved, extents)).abs();
            assert!(jump <= 0.02 * CONTRAST + ROUNDING, "{toml}: {jump} at {point:?}, {extents:?}");
            let larger = grey(&pattern, point, extents.map(|e| e * 1.01));
            let jump = (grey(&pattern, point, extents) - larger).abs();
            assert!(jump <= 0.02 * CONTRAST + ROUNDING, "{toml}: {jump} at {point:?}, {extents:?} * 1.01");
        }
    }
}

#[test]
fn checks_alternate() {
    let checks = pattern("checks = { size_m = 1, grey = 200 }");
    let at = |point| grey(&checks, point, [0.01; 2]);
    assert_eq!([at([0.5, 0.5]), at([1.5, 0.5]), at([1.5, -0.5])], [200.0, 70.0, 200.0]);
}

#[test]
fn bricks_of_the_next_row_are_shifted_by_half() {
    let brick = pattern("brick = { length_m = 0.4, height_m = 0.1, joint_m = 0.02, grey = 250, tint = 0 }");
    for (point, expected) in [
        ([0.01, 0.05], 250.0),
        ([0.21, 0.05], 70.0),
        ([0.01, 0.15], 70.0),
        ([0.21, 0.15], 250.0),
        ([0.21, 0.01], 250.0),
    ] {
        assert!((grey(&brick, point, [1e-4; 2]) - expected).abs() < ROUNDING, "{point:?}");
    }
}

#[test]
fn a_brick_has_one_tint_and_its_neighbours_have_others() {
    let brick = pattern(BRICK);
    let at = |point| grey(&brick, point, [1e-3; 2]);
    assert!((at([0.03, 0.03]) - at([0.39, 0.09])).abs() < ROUNDING);
    let tints: Vec<f64> = (0..200).map(|i| at([0.2 + 0.4 * f64::from(i), 0.05]) - 70.0).collect();
    let deviation = (tints.iter().map(|t| t * t).sum::<f64>() / 200.0).sqrt();
    // Uniform on -30 to 30: 30 / sqrt(3), and its mean square is good to 2 / sqrt(5 * 200) of itself.
    assert!((deviation - 17.32).abs() < 1.2, "{deviation}");
    assert!(tints.iter().all(|t| t.abs() <= 30.0));
}

#[test]
fn a_road_has_its_markings_where_they_are_described() {
    let road = pattern(ROAD);
    let is_paint = |u, v| match grey(&road, [u, v], [1e-3; 2]) {
        g if (g - 220.0).abs() < ROUNDING => true,
        g if (g - 70.0).abs() < ROUNDING => false,
        g => panic!("{g} at {u}, {v}"),
    };
    // Dashes of 3 m every 9 m.
    for (u, expected) in
        [(0.1, true), (2.9, true), (3.1, false), (8.9, false), (9.1, true), (-0.1, false), (-6.1, true)]
    {
        assert_eq!([is_paint(u, 0.1), is_paint(u, -0.1)], [expected; 2], "{u}");
    }
    assert!(!is_paint(0.1, 0.0) && !is_paint(0.1, 0.17) && is_paint(0.1, 0.15));
    // Solid lines, not cut by the crosswalk, which ends before them.
    for u in [-50.0, 3.3, 12.0] {
        assert!(is_paint(u, 3.2) && is_paint(u, -3.2) && !is_paint(u, 3.3), "{u}");
    }
    // Bars of 0.5 m every 0.95 m from v = -3, the last one cut at 3; u = 10.5 to 13.5. Lines stop there.
    for (v, expected) in [
        (-2.99, true),
        (-2.51, true),
        (-2.49, false),
        (-2.06, false),
        (-2.04, true),
        (-0.155, false),
        (2.69, false),
        (2.99, true),
        (3.01, false),
    ] {
        assert_eq!(is_paint(11.0, v), expected, "{v}");
    }
    assert!(
        is_paint(10.51, -2.9) && !is_paint(10.49, -2.9) && is_paint(13.49, -2.9) && !is_paint(13.51, -2.9)
    );
    // The stop line, whose ends may come in either order.
    assert!(is_paint(9.31, -1.0) && is_paint(9.69, -3.05) && !is_paint(9.71, -1.0) && !is_paint(9.5, 1.0));
}

#[test]
fn paint_is_worn_in_patches_and_shows_the_road_softened() {
    let paint = |wear: f64, texture: f32, i: u32| {
        let road = pattern(&format!("road = {{ grey = 200, edge_lines_m = [0], wear = {wear} }}"));
        let point = Footprint { width_m: 1e-3, span_m: [0.0; 2] };
        road.apply(100.0 + texture, texture, [0.37 * f64::from(i), 0.0], &point, 1)
    };
    assert_eq!(paint(0.0, 0.0, 5), 200.0);
    assert_eq!(paint(0.0, 10.0, 5), 204.0);
    let worn: Vec<f32> = (0..3000).map(|i| paint(0.2, 0.0, i)).collect();
    let mean = worn.iter().sum::<f32>() / 3000.0;
    let deviation = (worn.iter().map(|g| (g - mean) * (g - mean)).sum::<f32>() / 3000.0).sqrt();
    // A fifth of the contrast of 100 is gone, 0.6 of that varies. Neighbouring points
    // are alike: about 1000 patches.
    assert!((mean - 180.0).abs() < 1.5 && (deviation - 12.0).abs() < 1.0, "{mean} {deviation}");
}

#[test]
fn impossible_patterns_are_refused() {
    for (toml, message) in [
        ("road = { grey = 200, wear = 1.5 }", "a share from 0 to 1"),
        ("road = { grey = 200, dash_m = 0 }", "a positive number"),
        ("road = { grey = 200, crosswalks = [{ at_m = 1 }] }", "missing field `length_m`"),
        ("road = { grey = 200, lanes = 2 }", "unknown field `lanes`"),
        ("grass = { length_m = 0.1, width_m = 0.01, clump_m = 0.3 }", "missing field `contrast`"),
        ("stripes = { along = \"w\", period_m = 1, width_m = 1, grey = 1 }", "unknown variant `w`"),
        ("moss = {}", "unknown variant `moss`"),
    ] {
        let error = toml::from_str::<PatternSpec>(toml).unwrap_err().to_string();
        assert!(error.contains(message), "{toml}: {error}");
    }
}
