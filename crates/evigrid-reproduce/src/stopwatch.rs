//! How long something takes.

use anyhow::Result;
use evigrid_eval::Clock;

/// Times something that is done again and again, after once that does not count.
#[derive(Clone, Copy)]
pub struct Stopwatch<'a> {
    pub clock: &'a dyn Clock,
    pub repetitions: usize,
}

impl Stopwatch<'_> {
    /// Seconds of the median and of the fastest run.
    pub fn time(&self, mut run: impl FnMut() -> Result<()>) -> Result<[f64; 2]> {
        run()?;
        let mut times = Vec::new();
        for _ in 0..self.repetitions {
            let start = self.clock.now_ms();
            run()?;
            times.push((self.clock.now_ms() - start) / 1e3);
        }
        times.sort_by(f64::total_cmp);
        Ok([times.len() / 2, 0].map(|at| times.get(at).copied().unwrap_or(f64::NAN)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that moves on by one, two, three ... milliseconds.
    #[derive(Default)]
    struct Counting(std::sync::atomic::AtomicU32);

    impl Clock for Counting {
        fn now_ms(&self) -> f64 {
            let n = f64::from(self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
            0.5 * n * (n + 1.0)
        }
    }

    #[test]
    fn the_median_and_the_fastest_count_and_the_first_run_does_not() {
        let (clock, mut runs) = (Counting::default(), 0);
        let times = Stopwatch { clock: &clock, repetitions: 3 }.time(|| {
            runs += 1;
            Ok(())
        });
        // Between readings 0 and 1, 2 and 3, 4 and 5: 1, 3 and 5 ms.
        assert_eq!((times.unwrap(), runs), ([0.003, 0.001], 4));
    }
}
