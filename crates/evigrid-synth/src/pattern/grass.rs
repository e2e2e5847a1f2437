use serde::Deserialize;

use crate::noise::{Footprint, FractalNoise, TAPS, along_span, fade, hash, smooth_step, split, unit};
use crate::number::{NonNegative, Positive};

/// Blades of grass seen from above: streaks of light and dark that lean the same way within a clump, and
/// larger tufts of them that are left to see from further away.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrassSpec {
    /// Length of a blade, metres.
    length_m: Positive,
    /// Width of a blade, metres.
    width_m: Positive,
    /// Size of the clumps in which blades lean the same way, metres.
    clump_m: Positive,
    /// Standard deviation of the blades and tufts, grey levels. The material's own noise comes on top.
    contrast: NonNegative,
}

/// Streaks of one size.
struct Level {
    /// Their length and width relative to those of a blade.
    length: f64,
    width: f64,
    /// Their standard deviation relative to that of the whole.
    strength: f32,
}

/// From tufts to blades. The squares of the strengths sum up to 1.
const LEVELS: [Level; 4] = [
    Level { length: 2.6, width: 9.0, strength: 0.4 },
    Level { length: 1.8, width: 4.5, strength: 0.5 },
    Level { length: 1.3, width: 2.1, strength: 0.5 },
    Level { length: 1.0, width: 1.0, strength: 0.583_095 },
];

/// The ways in which blades lean as unit vectors, 37 degrees apart; the middle
/// one, 37 degrees from u, prevails.
const LEANS: [[f64; 2]; 5] = [[-0.352, 0.936], [0.28, 0.96], [0.8, 0.6], [1.0, 0.0], [0.8, -0.6]];

/// Standard deviation of streaks of one size: x * |x| of a number x that is uniform on [-1, 1] has variance
/// 1/5, and blending with the smooth step keeps 26/35 of the variance per axis.
const STREAK_DEVIATION: f32 = 0.332_213;

/// Grass on a surface.
#[derive(Debug, Clone)]
pub struct Grass {
    spec: GrassSpec,
    clumps: FractalNoise,
}

impl Grass {
    /// The grass that `spec` describes.
    pub fn new(spec: GrassSpec) -> Self {
        let clumps = FractalNoise::new(spec.clump_m.0, 2, 0.6);
        Self { spec, clumps }
    }

    /// Grey levels that the blades add at (u, v).
    pub fn sample(&self, point: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        // The lean is taken at the middle of the footprint. It comes to rest at the prevailing one before the
        // footprint gets longer than a clump.
        let whole = Footprint { width_m: footprint.length_m(), span_m: [0.0; 2] };
        let middle = 0.5 * (LEANS.len() - 1) as f32;
        let lean = middle + 1.1 * self.clumps.sample(point, &whole, seed);
        let (first, share) = split(f64::from(lean.clamp(0.0, 2.0 * middle - 1e-3)));
        let second = share;
        let norm = ((1.0 - second) * (1.0 - second) + second * second).sqrt();
        let mut sum = 0.0;
        for (lean, weight) in [(first, 1.0 - second), (first + 1, second)] {
            if weight > 0.0 {
                sum += weight * self.leaning(lean as usize, point, footprint, seed);
            }
        }
        self.spec.contrast.0 as f32 * sum / norm
    }

    /// The blades and tufts of one lean, with standard deviation 1.
    fn leaning(&self, lean: usize, [u, v]: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let [a, b] = LEANS[lean % LEANS.len()];
        let turned = |[u, v]: [f64; 2]| [a * u + b * v, a * v - b * u];
        let (point, span) = (turned([u, v]), turned(footprint.span_m));
        let mut sum = 0.0;
        for (index, level) in (0_u32..).zip(&LEVELS) {
            let size = [level.length * self.spec.length_m.0, level.width * self.spec.width_m.0];
            let finest = span.map(|s| footprint.width_m.max(s.abs() / TAPS as f64));
            let weight = fade(size[0] / finest[0]) * fade(size[1] / finest[1]);
            if weight > 0.0 {
                let scaled = |[x, y]: [f64; 2]| [x / size[0], y / size[1]];
                let seed = hash(index, lean as u32, seed);
                sum += level.strength * weight * mean_streaks(scaled(point), scaled(span), seed);
            }
        }
        sum / STREAK_DEVIATION
    }
}

/// The mean over the span, in cells.
fn mean_streaks([x, y]: [f64; 2], span: [f64; 2], seed: u32) -> f32 {
    // A footprint well inside one cell needs no averaging.
    if span[0].abs().max(span[1].abs()) < 0.25 {
        return streaks([x], [y], seed)[0];
    }
    let [x, y] = along_span([x, y], span);
    streaks(x, y, seed).iter().sum::<f32>() / TAPS as f32
}

/// Noise in rows of height 1 along x, each of cells of length 1 that begin anywhere; at several points at
/// once (plain loops, for the vectoriser).
fn streaks<const N: usize>(x: [f64; N], y: [f64; N], seed: u32) -> [f32; N] {
    let (mut row, mut across) = ([0_u32; N], [0.0; N]);
    for k in 0..N {
        (row[k], across[k]) = split(y[k]);
    }
    let low = row_values(x, row, seed);
    let high = row_values(x, row.map(|row| row.wrapping_add(1)), seed);
    std::array::from_fn(|k| low[k] + smooth_step(across[k]) * (high[k] - low[k]))
}

/// The noise in the middle of rows.
fn row_values<const N: usize>(x: [f64; N], row: [u32; N], seed: u32) -> [f32; N] {
    let (mut cell, mut along) = ([0_u32; N], [0.0; N]);
    for k in 0..N {
        let start = unit(hash(row[k], 0x1b87_3593, seed));
        (cell[k], along[k]) = split(x[k] + f64::from(start));
    }
    let mut value = [0.0; N];
    for k in 0..N {
        let tone = |cell: u32| {
            let tone = unit(hash(cell, row[k], seed));
            tone * tone.abs()
        };
        let (before, after) = (tone(cell[k]), tone(cell[k].wrapping_add(1)));
        value[k] = before + smooth_step(along[k]) * (after - before);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Footprint = Footprint { width_m: 1e-6, span_m: [0.0; 2] };

    fn grass() -> Grass {
        Grass::new(
            toml::from_str("length_m = 0.12\nwidth_m = 0.008\nclump_m = 0.35\ncontrast = 1.0").unwrap(),
        )
    }

    fn points() -> impl Iterator<Item = [f64; 2]> {
        (0..40_000).map(|i| [f64::from(i % 200) * 0.731, f64::from(i / 200) * 0.917])
    }

    fn deviation(values: impl Iterator<Item = f32>) -> f64 {
        let squares: Vec<f64> = values.map(|v| f64::from(v * v)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    #[test]
    fn blades_vary_by_their_contrast_about_zero() {
        let grass = grass();
        let values: Vec<f32> = points().map(|p| grass.sample(p, &POINT, 5)).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        // 40000 nearly independent values of deviation 1.
        assert!(mean.abs() < 0.02, "{mean}");
        assert!((deviation(values.into_iter()) - 1.0).abs() < 0.02);
    }

    #[test]
    fn blades_are_long_and_narrow() {
        let grass = grass();
        for (lean, [a, b]) in LEANS.into_iter().enumerate() {
            let change = |[du, dv]: [f64; 2]| {
                let step = |[u, v]: [f64; 2]| [u + 0.02 * du, v + 0.02 * dv];
                let at = |p| grass.leaning(lean, p, &POINT, 5);
                deviation(points().map(|p| at(p) - at(step(p))))
            };
            let (along, across) = (change([a, b]), change([-b, a]));
            assert!(across > 3.0 * along, "{lean}: {along} {across}");
        }
    }

    #[test]
    fn every_lean_occurs_and_the_middle_one_prevails_far_away() {
        let grass = grass();
        let far = Footprint { width_m: 0.01, span_m: [0.5, 0.0] };
        for p in points().take(1000) {
            let prevailing = grass.leaning(2, p, &far, 5);
            assert!((grass.sample(p, &far, 5) - prevailing).abs() < 1e-6);
        }
        let mut found = [0; 5];
        for p in points().take(4000) {
            let value = grass.sample(p, &POINT, 5);
            let misfit = |lean: &usize| (grass.leaning(*lean, p, &POINT, 5) - value).abs();
            found[(0..5).min_by(|a, b| misfit(a).total_cmp(&misfit(b))).unwrap()] += 1;
        }
        assert!(found.iter().all(|&n| n > 300), "{found:?}");
    }

    #[test]
    fn grass_is_continuous() {
        let grass = grass();
        for p in points().take(4000) {
            let near = [p[0] + 1e-8, p[1] - 1e-8];
            assert!((grass.sample(p, &POINT, 5) - grass.sample(near, &POINT, 5)).abs() < 1e-3, "{p:?}");
        }
    }

    #[test]
    fn what_is_finer_than_a_pixel_vanishes_smoothly() {
        let grass = grass();
        let found = [0.001, 0.005, 0.01, 0.02, 0.04, 0.08].map(|width_m| {
            deviation(points().map(|p| grass.sample(p, &Footprint { width_m, span_m: [0.0; 2] }, 5)))
        });
        assert!(found.windows(2).all(|w| w[0] > w[1]), "{found:?}");
        assert_eq!(found[5], 0.0);
    }

    /// The filter keeps what an image can show, and fades out whole sizes of streaks at once. So it is not
    /// the mean over the footprint, but much nearer to it than the grey of a point.
    #[test]
    fn grass_is_about_the_mean_over_the_footprint() {
        let grass = grass();
        for (width_m, span_m) in [
            (0.004, [0.02, 0.01]),
            (0.02, [0.1, 0.0]),
            (0.02, [0.0, 0.1]),
            (0.04, [0.1, 0.1]),
            (0.05, [0.3, 0.1]),
        ] {
            let footprint = Footprint { width_m, span_m };
            let mean = |[u, v]: [f64; 2]| {
                let offset = |k: i32| (f64::from(k % 12) + 0.5) / 12.0 - 0.5;
                let at = |i: i32| {
                    let along = offset(i / 144);
                    let [du, dv] = [offset(i), offset(i / 12)].map(|d| d * width_m);
                    [u + du + along * span_m[0], v + dv + along * span_m[1]]
                };
                (0..1728).map(|i| grass.sample(at(i), &POINT, 5)).sum::<f32>() / 1728.0
            };
            let sampled = || points().step_by(397);
            let error = deviation(sampled().map(|p| grass.sample(p, &footprint, 5) - mean(p)));
            let point_error = deviation(sampled().map(|p| grass.sample(p, &POINT, 5) - mean(p)));
            assert!(error < 0.7 * point_error, "{width_m}, {span_m:?}: {error} {point_error}");
        }
    }
}
