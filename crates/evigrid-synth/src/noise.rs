//! Fractal value noise over surface coordinates, filtered to the footprint of a pixel.

/// The part of a surface that one pixel covers: a parallelogram of width `width_m`, stretched along `span_m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Across the viewing direction, metres.
    pub width_m: f64,
    /// Along the direction in which the surface slants away, surface
    /// coordinates, metres; zero if seen face on.
    pub span_m: [f64; 2],
}

impl Footprint {
    /// Lengths along the two surface coordinates, metres. Seen at an angle a from the normal, a square pixel
    /// covers width / cos(a), and the span is width * tan(a): the root of the sum of the squares.
    pub fn extents(&self) -> [f64; 2] {
        self.span_m.map(|s| (self.width_m * self.width_m + s * s).sqrt())
    }

    /// Length along the direction in which the surface slants away, metres.
    pub fn length_m(&self) -> f64 {
        let [u, v] = self.span_m;
        (self.width_m * self.width_m + u * u + v * v).sqrt()
    }
}

/// How often an octave is sampled along the span of a slanted footprint.
pub const TAPS: usize = 4;

/// Standard deviation of one octave: lattice values are uniform on [-1, 1] (variance 1/3), and blending with
/// the smooth step keeps 26/35 of the variance per axis.
const OCTAVE_DEVIATION: f32 = 0.428_881;

/// A sum of octaves of value noise, each half as coarse as the one before, with standard deviation 1.
#[derive(Debug, Clone)]
pub struct FractalNoise {
    scale_m: f64,
    amplitudes: Vec<f32>,
}

impl FractalNoise {
    /// Noise whose coarsest lattice has cells of `scale_m` metres; each of the `octaves` is `roughness` times
    /// as strong as the one before.
    pub fn new(scale_m: f64, octaves: u32, roughness: f64) -> Self {
        let powers = std::iter::successors(Some(1.0), |a| Some(a * roughness));
        let raw: Vec<f64> = powers.take(octaves as usize).collect();
        let deviation = f64::from(OCTAVE_DEVIATION) * raw.iter().map(|a| a * a).sum::<f64>().sqrt();
        Self { scale_m, amplitudes: raw.iter().map(|a| (a / deviation) as f32).collect() }
    }

    /// The noise at (u, v), metres. Octaves too fine for the footprint fade out, so that two cameras that see
    /// the same point agree on its grey.
    pub fn sample(&self, [u, v]: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let [span_u, span_v] = footprint.span_m;
        let stretch_m = (span_u * span_u + span_v * span_v).sqrt();
        let finest_m = footprint.width_m.max(stretch_m / TAPS as f64);
        let mut cell_m = self.scale_m;
        let (mut p, mut s) = ([u / cell_m, v / cell_m], [span_u / cell_m, span_v / cell_m]);
        let mut sum = 0.0;
        for (octave, amplitude) in (0_u32..).zip(&self.amplitudes) {
            let weight = fade(cell_m / finest_m);
            if weight == 0.0 {
                break;
            }
            let seed = seed.wrapping_add(octave.wrapping_mul(0x632b_e5ab));
            // A footprint well inside one cell needs no averaging.
            let value = if stretch_m * 4.0 < cell_m {
                value_noise([p[0]], [p[1]], seed)[0]
            } else {
                mean_along(p, s, seed)
            };
            sum += amplitude * weight * value;
            cell_m *= 0.5;
            (p, s) = (refine(p), refine(s));
        }
        sum
    }
}

/// 0 where a lattice cell is smaller than the footprint, 1 where it is more than twice as large.
pub fn fade(cells_per_footprint: f64) -> f32 {
    smooth_step((cells_per_footprint - 1.0).clamp(0.0, 1.0) as f32)
}

/// The coordinates of the next finer octave: doubled, and turned so that the lattices do not line up.
fn refine([u, v]: [f64; 2]) -> [f64; 2] {
    [2.0 * (0.8 * u - 0.6 * v), 2.0 * (0.6 * u + 0.8 * v)]
}

/// The mean over evenly spaced points of the span centred at `p`.
fn mean_along(p: [f64; 2], span: [f64; 2], seed: u32) -> f32 {
    let [u, v] = along_span(p, span);
    value_noise(u, v, seed).iter().sum::<f32>() / TAPS as f32
}

/// The two coordinates of evenly spaced points of the span centred at `p`.
pub fn along_span(p: [f64; 2], span: [f64; 2]) -> [[f64; TAPS]; 2] {
    let at = |i: usize| (i as f64 + 0.5) / TAPS as f64 - 0.5;
    [0, 1].map(|axis| std::array::from_fn(|i| p[axis] + at(i) * span[axis]))
}

/// Value noise on the integer lattice, in [-1, 1], at several points at once
/// (plain loops, for the vectoriser).
fn value_noise<const N: usize>(u: [f64; N], v: [f64; N], seed: u32) -> [f32; N] {
    let (mut i, mut j, mut wu, mut wv) = ([0; N], [0; N], [0.0; N], [0.0; N]);
    for k in 0..N {
        (i[k], wu[k]) = split(u[k]);
        (j[k], wv[k]) = split(v[k]);
    }
    let mut value = [0.0; N];
    for k in 0..N {
        let corner = |di: u32, dj: u32| unit(hash(i[k].wrapping_add(di), j[k].wrapping_add(dj), seed));
        let (wu, wv) = (smooth_step(wu[k]), smooth_step(wv[k]));
        let low = corner(0, 0) + wu * (corner(1, 0) - corner(0, 0));
        let high = corner(0, 1) + wu * (corner(1, 1) - corner(0, 1));
        value[k] = low + wv * (high - low);
    }
    value
}

/// The whole part (the low bits of it, in two's complement) and the fractional part of a number. Adding
/// 1.5 * 2^52 leaves the nearest whole number in the low bits, which is much faster than a checked
/// conversion. A whole number x may come out as (x - 1, 1) instead of (x, 0), which is the same place.
pub fn split(x: f64) -> (u32, f32) {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    let shifted = (x - 0.5) + SHIFT;
    (shifted.to_bits() as u32, (x - (shifted - SHIFT)) as f32)
}

pub fn smooth_step(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// A number that looks random, from two lattice coordinates and a seed.
pub fn hash(i: u32, j: u32, seed: u32) -> u32 {
    let h = i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca77).wrapping_add(seed);
    let h = (h ^ h >> 15).wrapping_mul(0x2c1b_3c6d);
    let h = (h ^ h >> 12).wrapping_mul(0x297a_2d39);
    h ^ h >> 15
}

/// A hash as a number in [-1, 1).
pub fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 8_388_608.0) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Footprint = Footprint { width_m: 1e-6, span_m: [0.0, 0.0] };

    fn samples(noise: &FractalNoise, footprint: &Footprint) -> Vec<f32> {
        let at = |i: i32| [f64::from(i % 300) * 0.731, f64::from(i / 300) * 0.917];
        (0..60_000).map(|i| noise.sample(at(i), footprint, 5)).collect()
    }

    fn mean_and_deviation(values: &[f32]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
        let variance = values.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / n;
        (mean, variance.sqrt())
    }

    #[test]
    fn the_noise_has_mean_zero_and_unit_deviation() {
        for octaves in [1, 4, 8] {
            let (mean, deviation) =
                mean_and_deviation(&samples(&FractalNoise::new(0.4, octaves, 0.7), &POINT));
            assert!(mean.abs() < 0.02, "{octaves}: {mean}");
            assert!((deviation - 1.0).abs() < 0.02, "{octaves}: {deviation}");
        }
    }

    #[test]
    fn the_noise_is_continuous() {
        let noise = FractalNoise::new(1.0, 3, 0.6);
        for i in -400..400 {
            let u = f64::from(i) * 0.01;
            let at = |u| noise.sample([u, 0.3 * u], &POINT, 9);
            assert!((at(u) - at(u + 1e-7)).abs() < 1e-5, "{u}");
        }
    }

    #[test]
    fn what_is_finer_than_a_pixel_vanishes_smoothly() {
        let noise = FractalNoise::new(1.0, 6, 0.7);
        let deviation =
            |width_m| mean_and_deviation(&samples(&noise, &Footprint { width_m, span_m: [0.0, 0.0] })).1;
        let widths = [0.01, 0.03, 0.1, 0.3, 0.7, 1.1];
        let found = widths.map(deviation);
        assert!(found.windows(2).all(|w| w[0] > w[1]), "{found:?}");
        assert_eq!(found[5], 0.0);
    }

    #[test]
    fn a_slanted_footprint_averages_along_its_span() {
        // Averaging over two cells along u, but none along v, takes part of the deviation of one octave.
        let noise = FractalNoise::new(1.0, 1, 0.5);
        let slanted = Footprint { width_m: 0.01, span_m: [1.9, 0.0] };
        let (_, deviation) = mean_and_deviation(&samples(&noise, &slanted));
        assert!(deviation > 0.4 && deviation < 0.8, "{deviation}");
    }

    #[test]
    fn a_slanted_pixel_is_as_long_as_one_over_the_cosine() {
        // 60 degrees from the normal: cosine 1/2, tangent sqrt(3).
        let slanted =
            Footprint { width_m: 0.1, span_m: [0.1 * 3_f64.sqrt() * 0.6, -0.1 * 3_f64.sqrt() * 0.8] };
        assert!((slanted.length_m() - 0.2).abs() < 1e-12);
        let [u, v] = slanted.extents();
        assert!(
            (u * u - 0.01 * (1.0 + 3.0 * 0.36)).abs() < 1e-12
                && (v * v - 0.01 * (1.0 + 3.0 * 0.64)).abs() < 1e-12
        );
    }

    #[test]
    fn negative_numbers_split_downwards() {
        assert_eq!(split(-0.25), (u32::MAX, 0.75));
        assert_eq!(split(2.5), (2, 0.5));
        assert_eq!(split(-6.75), (u32::MAX - 6, 0.25));
        let (whole, fraction) = split(-2.0);
        assert!(
            (whole.wrapping_add(2) as f32) + fraction == 0.0 || (whole == u32::MAX - 2 && fraction == 1.0)
        );
    }
}
