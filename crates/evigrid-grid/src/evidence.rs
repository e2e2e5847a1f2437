use std::sync::atomic::{AtomicI32, Ordering};

use rayon::prelude::*;

use crate::{Clamp, LogOddsGrid};

/// No evidence in this frame. Lower than the key of every number.
const NONE: i32 = i32::MIN;

/// Cells fused by one task; large enough to hide the cost of starting it.
const CELLS_PER_TASK: usize = 1 << 14;

/// The evidence of ONE frame: per cell the largest log-odds that any ray of the frame offers ("obstacle
/// priority": Andert 2009, section IV; Brandao et al., section IV). Rays may be drawn from many threads at
/// once; a maximum does not depend on their order, so the result is the same for any number of threads.
#[derive(Debug)]
pub struct FrameEvidence {
    keys: Vec<AtomicI32>,
}

impl FrameEvidence {
    /// Empty evidence for a grid of `cell_count` cells.
    pub fn new(cell_count: usize) -> Self {
        Self { keys: (0..cell_count).map(|_| AtomicI32::new(NONE)).collect() }
    }

    /// The order-preserving integer of a log-odds value. Tables of inverse models store keys, so that drawing
    /// compares integers. The value must not be NaN.
    pub fn key(log_odds: f32) -> i32 {
        let bits = log_odds.to_bits() as i32;
        bits ^ (((bits >> 31) as u32) >> 1) as i32
    }

    /// The log-odds of a key: the inverse of [`Self::key`].
    pub fn log_odds(key: i32) -> f32 {
        f32::from_bits((key ^ (((key >> 31) as u32) >> 1) as i32) as u32)
    }

    /// Offers evidence for a cell; the cell keeps the larger.
    #[inline]
    pub fn offer(&self, flat: usize, key: i32) {
        let slot = &self.keys[flat];
        // Most rays of a frame offer a cell what it already has: look before the locked write.
        if slot.load(Ordering::Relaxed) < key {
            slot.fetch_max(key, Ordering::Relaxed);
        }
    }

    /// Whether no ray has met a cell so far.
    #[inline]
    pub fn is_empty(&self, flat: usize) -> bool {
        self.keys[flat].load(Ordering::Relaxed) == NONE
    }

    /// The evidence for a cell so far; `None` if no ray met it.
    pub fn get(&self, flat: usize) -> Option<f32> {
        Some(self.keys[flat].load(Ordering::Relaxed)).filter(|&k| k != NONE).map(Self::log_odds)
    }

    /// Adds the frame's evidence to a map, l_t = clamp(l_{t-1} + evidence), where untouched cells start at
    /// the prior 0.5 (log-odds 0), and empties it for the next frame.
    pub fn fuse_into(&mut self, map: &mut LogOddsGrid, clamp: Clamp) {
        self.fuse_from(0.0, map, clamp);
    }

    /// As [`Self::fuse_into`], where untouched cells start at the log-odds of another prior.
    pub fn fuse_from(&mut self, prior: f32, map: &mut LogOddsGrid, clamp: Clamp) {
        let keys = self.keys.par_chunks_mut(CELLS_PER_TASK);
        let values = map.values_mut().par_chunks_mut(CELLS_PER_TASK);
        keys.zip(values).for_each(|(keys, values)| {
            for (slot, value) in keys.iter_mut().zip(values) {
                let key = *slot.get_mut();
                if key != NONE {
                    *slot.get_mut() = NONE;
                    *value = clamp.add(if value.is_nan() { prior } else { *value }, Self::log_odds(key));
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{GridSettings, GridSpec};

    #[test]
    fn keys_keep_the_order_of_numbers() {
        let numbers = [f32::NEG_INFINITY, -5.0, -0.4, -1e-30, 0.0, 1e-30, 0.85, 5.0, f32::INFINITY];
        for pair in numbers.windows(2) {
            assert!(FrameEvidence::key(pair[0]) < FrameEvidence::key(pair[1]), "{pair:?}");
        }
        for n in numbers {
            assert_eq!(FrameEvidence::log_odds(FrameEvidence::key(n)), n);
            assert!(FrameEvidence::key(n) > NONE);
        }
    }

    #[test]
    fn obstacles_win_within_a_frame_and_frames_add_up() {
        let settings = GridSettings { x_m: [0.0, 0.4], y_m: [0.0, 0.2], z_m: [0.0, 0.2], cell_size_m: 0.2 };
        let mut map = LogOddsGrid::unknown(GridSpec::new(&settings).unwrap());
        let mut evidence = FrameEvidence::new(2);
        let clamp = Clamp { min: -2.0, max: 3.5 };
        for _ in 0..2 {
            for log_odds in [-0.4, 0.85, -1.0] {
                evidence.offer(0, FrameEvidence::key(log_odds));
            }
            assert_eq!((evidence.get(0), evidence.get(1)), (Some(0.85), None));
            evidence.fuse_into(&mut map, clamp);
            assert_eq!(evidence.get(0), None);
        }
        assert_eq!(map.log_odds(0), Some(1.7));
        assert_eq!(map.log_odds(1), None);
        for _ in 0..9 {
            evidence.offer(1, FrameEvidence::key(-0.4));
            evidence.fuse_into(&mut map, clamp);
        }
        assert_eq!(map.log_odds(1), Some(-2.0));
    }
}
