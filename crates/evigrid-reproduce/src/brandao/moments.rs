//! How whole numbers are distributed, and how far from normally.

/// Counts by value.
#[derive(Debug, Clone)]
pub struct Counts(Vec<u64>);

impl Counts {
    /// No values yet, none of which will be above `largest`.
    pub fn up_to(largest: usize) -> Self {
        Self(vec![0; largest + 1])
    }

    /// One more value.
    pub fn add(&mut self, value: usize) {
        if let Some(count) = self.0.get_mut(value) {
            *count += 1;
        }
    }

    /// How many values there are.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Share of the values from `from` to before `to`.
    pub fn share(&self, from: usize, to: usize) -> f64 {
        let end = to.min(self.0.len());
        self.0[from.min(end)..end].iter().sum::<u64>() as f64 / self.total() as f64
    }

    /// Mean, variance and so on. NaN without values.
    pub fn moments(&self) -> Moments {
        let total = self.total() as f64;
        let expected = |f: &dyn Fn(f64) -> f64| {
            self.0.iter().enumerate().map(|(value, &n)| n as f64 * f(value as f64)).sum::<f64>() / total
        };
        let mean = expected(&|v| v);
        let variance = expected(&|v| (v - mean).powi(2));
        let deviation = variance.sqrt();
        let mut moments = Moments {
            mean,
            variance,
            skewness: expected(&|v| ((v - mean) / deviation).powi(3)),
            excess_kurtosis: expected(&|v| ((v - mean) / deviation).powi(4)) - 3.0,
            distance_to_normal: 0.0,
        };
        moments.distance_to_normal = self.distance_to(&moments);
        moments
    }

    /// Largest difference between the cumulative shares and those of the normal distribution.
    fn distance_to(&self, normal: &Moments) -> f64 {
        let (total, mut below, mut largest) = (self.total() as f64, 0, 0.0);
        for (value, n) in self.0.iter().enumerate() {
            below += n;
            // A whole number stands for all that rounds to it.
            largest = f64::max(largest, (below as f64 / total - normal.below(value as f64 + 0.5)).abs());
        }
        largest
    }
}

/// Moments and other numbers that describe a distribution.
#[derive(Debug, Clone, Copy)]
pub struct Moments {
    pub mean: f64,
    pub variance: f64,
    /// 0 for a normal distribution; above: a long tail of large values.
    pub skewness: f64,
    /// 0 for a normal distribution.
    pub excess_kurtosis: f64,
    /// Largest difference of the cumulative distribution from the normal one with this
    /// mean and variance (Kolmogorov).
    pub distance_to_normal: f64,
}

impl Moments {
    /// Share of a normal distribution with this mean and variance that is below a value.
    pub fn below(&self, value: f64) -> f64 {
        0.5 * (1.0 + erf((value - self.mean) / (2.0 * self.variance).sqrt()))
    }
}

/// The error function, within 1.5e-7 (Abramowitz and Stegun, 7.1.26).
fn erf(x: f64) -> f64 {
    const A: [f64; 5] = [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let sum = A.iter().rev().fold(0.0, |sum, a| (sum + a) * t);
    (1.0 - sum * (-x * x).exp()).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_by_hand() {
        let mut counts = Counts::up_to(10);
        [1, 1, 1, 5].into_iter().for_each(|v| counts.add(v));
        let m = counts.moments();
        // Deviations -1, -1, -1, 3: variance 12/4, third moment 24/4, fourth 84/4.
        assert_eq!((m.mean, m.variance), (2.0, 3.0));
        assert!((m.skewness - 6.0 / 3.0_f64.powf(1.5)).abs() < 1e-12, "{m:?}");
        assert!((m.excess_kurtosis - (21.0 / 9.0 - 3.0)).abs() < 1e-12);
        assert_eq!(counts.share(1, 5), 0.75);
        assert_eq!(counts.share(5, 99), 0.25);
    }

    #[test]
    fn what_is_drawn_from_a_normal_distribution_is_near_one() {
        // Quantiles of mean 500, deviation 50, by the cumulative distribution itself.
        let normal = Moments {
            mean: 500.0,
            variance: 2500.0,
            skewness: 0.0,
            excess_kurtosis: 0.0,
            distance_to_normal: 0.0,
        };
        let mut counts = Counts::up_to(1000);
        for value in 0..=1000 {
            let share = normal.below(value as f64 + 0.5) - normal.below(value as f64 - 0.5);
            (0..(share * 1e6) as usize).for_each(|_| counts.add(value));
        }
        let m = counts.moments();
        assert!(m.distance_to_normal < 1e-3 && m.skewness.abs() < 0.01, "{m:?}");
        assert!((normal.below(550.0) - 0.841_344_7).abs() < 1e-6);
    }
}
