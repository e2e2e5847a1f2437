/// Heights of the points in a cell, counted in steps of [`STEP_M`], so that its size does not grow with the length
/// of a recording.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heights {
    /// The step of the first count.
    lowest: i32,
    counts: Vec<u32>,
    count: u32,
    /// From how far the first of them was seen, metres.
    range_m: f64,
}

/// Heights that were seen from more than this farther away do not count, metres: what a car drives between two
/// scans. Beams are off by tenths of a degree, and recorded poses rise and sink by centimetres within a second, so
/// that scans from farther away blur a cell.
const FARTHER_M: f64 = 1.0;
/// Resolution of the heights, metres: half a deviation of the laser.
const STEP_M: f64 = 0.01;
/// Heights farther from 0 are no heights of ground, metres.
const LIMIT_M: f64 = 1000.0;

impl Heights {
    /// Adds a height that was seen from so far, metres. One that is not finite, or out of all reason, is dropped, and
    /// so is one from farther away than the others by more than [`FARTHER_M`]. One from nearer by more than that
    /// drops all others.
    pub fn add(&mut self, height_m: f64, range_m: f64) {
        let farther_m = if self.count == 0 { 0.0 } else { range_m - self.range_m };
        if !height_m.is_finite() || height_m.abs() > LIMIT_M || farther_m > FARTHER_M {
            return;
        }
        if farther_m < -FARTHER_M {
            (self.counts, self.count) = (Vec::new(), 0);
        }
        if self.count == 0 {
            self.range_m = range_m;
        }
        let step = (height_m / STEP_M).floor() as i32;
        if self.counts.is_empty() {
            self.lowest = step;
        }
        if step < self.lowest {
            let more = (self.lowest - step) as usize;
            self.counts.splice(0..0, std::iter::repeat_n(0, more));
            self.lowest = step;
        }
        let at = (step - self.lowest) as usize;
        if at >= self.counts.len() {
            self.counts.resize(at + 1, 0);
        }
        self.counts[at] = self.counts[at].saturating_add(1);
        self.count = self.count.saturating_add(1);
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The height that a share of the points (0 to 1) lies below, metres; within a step it rises evenly. NaN
    /// without points.
    pub fn at_share(&self, share: f64) -> f64 {
        let wanted = share * f64::from(self.count);
        let mut below = 0.0;
        for (at, &count) in self.counts.iter().enumerate() {
            let next = below + f64::from(count);
            if count > 0 && next >= wanted {
                let within = ((wanted - below) / f64::from(count)).clamp(0.0, 1.0);
                return (f64::from(self.lowest) + at as f64 + within) * STEP_M;
            }
            below = next;
        }
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against sorting: at most a step off.
        #[test]
        fn shares_are_those_of_the_sorted_heights(
            mut heights in prop::collection::vec(-3.0..3.0_f64, 1..60),
            share in 0.0..1.0_f64,
        ) {
            let mut cell = Heights::default();
            heights.iter().for_each(|&height| cell.add(height, 5.0));
            heights.sort_by(f64::total_cmp);
            let wanted = (share * heights.len() as f64).ceil() as usize;
            let expected = heights[wanted.max(1) - 1];
            prop_assert_eq!(cell.count() as usize, heights.len());
            prop_assert!((cell.at_share(share) - expected).abs() <= STEP_M + 1e-9);
        }
    }

    #[test]
    fn what_is_no_height_is_dropped() {
        let mut cell = Heights::default();
        [f64::NAN, f64::INFINITY, 1e30].into_iter().for_each(|height| cell.add(height, 5.0));
        assert!(cell.count() == 0 && cell.at_share(0.5).is_nan());
    }

    #[test]
    fn what_was_seen_from_nearer_counts() {
        let mut cell = Heights::default();
        for (height, range, count) in
            [(1.0, 20.0, 1), (1.1, 20.9, 2), (2.0, 21.1, 2), (3.0, 16.0, 1), (3.1, 15.2, 2)]
        {
            cell.add(height, range);
            assert_eq!(cell.count(), count, "{range}");
        }
        assert!((cell.at_share(0.1) - 3.0).abs() < 0.011);
    }
}
