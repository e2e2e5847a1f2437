use std::time::Instant;

/// Where times come from. Handed in, so that tests can make time-dependent output exact.
pub trait Clock: Send + Sync {
    /// Milliseconds since some fixed moment; never falls.
    fn now_ms(&self) -> f64;
}

/// The machine's monotonic clock.
#[derive(Debug)]
pub struct RealClock(Instant);

impl Default for RealClock {
    fn default() -> Self {
        Self(Instant::now())
    }
}

impl Clock for RealClock {
    fn now_ms(&self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1e3
    }
}
