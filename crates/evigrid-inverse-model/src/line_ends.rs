//! The lines that were drawn already in an image.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// The cells in which some line ended, within the sensor's box. Lines that end in one cell have the same
/// cells, so that their free space needs to be drawn once only.
#[derive(Debug, Default)]
pub(crate) struct LineEnds {
    low: [i64; 3],
    size: [i64; 3],
    bits: Vec<AtomicU64>,
}

/// Largest box whose cells are remembered, 16 MiB; with a larger one every line is drawn whole.
const MOST_CELLS: i128 = 1 << 27;

impl LineEnds {
    /// Forgets all ends and begins an image with this sensor's box.
    pub fn reset(&mut self, sensor_box: &[Range<i64>; 3]) {
        self.low = std::array::from_fn(|a| sensor_box[a].start);
        self.size = std::array::from_fn(|a| (sensor_box[a].end - sensor_box[a].start).max(0));
        let cells: i128 = self.size.iter().map(|&n| i128::from(n)).product();
        if cells > MOST_CELLS {
            self.size = [0; 3];
        }
        let words = self.size.iter().product::<i64>() as usize / 64 + 1;
        self.bits.iter_mut().for_each(|word| *word.get_mut() = 0);
        self.bits.resize_with(words, AtomicU64::default);
    }

    /// Whether this is the first line that ends in a cell. Two threads may both be told so, which costs time
    /// alone.
    #[inline(always)]
    pub fn is_first(&self, end: &[i64; 3]) -> bool {
        let place: [i64; 3] = std::array::from_fn(|a| end[a] - self.low[a]);
        if (0..3).any(|a| place[a] < 0 || place[a] >= self.size[a]) {
            return true;
        }
        let number = (place[0] * self.size[1] + place[1]) * self.size[2] + place[2];
        let (word, bit) = (&self.bits[number as usize / 64], 1 << (number as u64 % 64));
        if word.load(Ordering::Relaxed) & bit != 0 {
            return false;
        }
        word.fetch_or(bit, Ordering::Relaxed);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_end_is_new_once() {
        let mut ends = LineEnds::default();
        for sensor_box in [[-3..5, 0..9, 2..4], [0..2, 0..3, 0..4]] {
            ends.reset(&sensor_box);
            for again in [true, false] {
                for x in sensor_box[0].clone() {
                    for y in sensor_box[1].clone() {
                        assert_eq!(ends.is_first(&[x, y, sensor_box[2].start]), again);
                    }
                }
            }
            // What lies outside is not remembered.
            assert!(ends.is_first(&[9, 0, 0]) && ends.is_first(&[9, 0, 0]));
        }
        ends.reset(&[0..1 << 40, 0..1 << 40, 0..1 << 40]);
        assert!(ends.is_first(&[1, 1, 1]) && ends.is_first(&[1, 1, 1]));
    }
}
