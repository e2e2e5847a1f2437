//! Random numbers that do not depend on who draws them when.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The use of a random stream.
#[derive(Debug, Clone, Copy)]
pub enum Sensor {
    /// The left camera; a row is an image row.
    Left,
    /// The right camera; a row is an image row.
    Right,
    /// A laser scanner by its number; a row is a beam.
    Laser(usize),
    /// The reported poses.
    Pose,
    /// The cameras' exposure.
    Exposure,
}

impl Sensor {
    fn number(self) -> u64 {
        match self {
            Self::Left => 0,
            Self::Right => 1,
            Self::Pose => 2,
            Self::Exposure => 3,
            Self::Laser(scanner) => 4 + scanner as u64,
        }
    }
}

/// The random stream of one row of one sensor in one frame. Streams of different arguments are independent,
/// so rows can be computed in any order by any number of threads.
pub fn stream(seed: u64, frame: usize, sensor: Sensor, row: usize) -> ChaCha8Rng {
    let mut key = [0; 32];
    let words = [seed, frame as u64, sensor.number(), row as u64];
    for (bytes, word) in key.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    ChaCha8Rng::from_seed(key)
}

/// A nearly normal number of mean 0 and standard deviation 1: the sum of eight uniform ones, which needs no
/// logarithm and never exceeds 4.9.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let parts = |v: u64| (v & 0xffff) + (v >> 16 & 0xffff) + (v >> 32 & 0xffff) + (v >> 48);
    let sum = parts(rng.next_u64()) + parts(rng.next_u64());
    // A uniform number on 0..=65535 has mean 32767.5 and variance (65536^2 - 1) / 12.
    (sum as f64 - 8.0 * 32767.5) / 53_509.919_921_45
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_is_nearly_normal() {
        let mut rng = stream(1, 2, Sensor::Laser(0), 3);
        let draws: Vec<f64> = (0..200_000).map(|_| normal(&mut rng)).collect();
        let mean = |f: &dyn Fn(f64) -> f64| draws.iter().map(|&v| f(v)).sum::<f64>() / draws.len() as f64;
        assert!(mean(&|v| v).abs() < 0.01);
        assert!((mean(&|v| v * v) - 1.0).abs() < 0.01);
        // Share within one standard deviation: 0.6827 for the normal distribution.
        assert!((mean(&|v| f64::from(v.abs() < 1.0)) - 0.6827).abs() < 0.01);
    }

    #[test]
    fn every_argument_makes_another_stream() {
        let first = |mut rng: ChaCha8Rng| rng.next_u64();
        let base = first(stream(1, 1, Sensor::Left, 1));
        assert_eq!(base, first(stream(1, 1, Sensor::Left, 1)));
        for other in [
            stream(2, 1, Sensor::Left, 1),
            stream(1, 2, Sensor::Left, 1),
            stream(1, 1, Sensor::Right, 1),
            stream(1, 1, Sensor::Left, 2),
        ] {
            assert_ne!(base, first(other));
        }
    }
}
