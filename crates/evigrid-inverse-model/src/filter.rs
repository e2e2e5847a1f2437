//! Which matches are believed.

use evigrid_core::Matches;

/// What stands for "no measurement" where disparities are compared: below all of them.
pub(crate) const INVALID: f32 = -1.0;

/// The matches of one frame and the limits they must keep. The same filters as those of `winner-take-all`, so that methods are
/// compared under equal conditions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Filter<'a> {
    disparity: &'a [f32],
    peak_ratio: &'a [f32],
    left_right_difference_px: &'a [u16],
    least_ratio: f32,
    most_difference: u16,
    /// Disparities from here on are too near.
    too_near: f32,
}

/// What a match must keep to be believed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Smallest peak ratio.
    pub peak_ratio: f64,
    /// Largest difference between left and right, pixels; `None`: whatever it is.
    pub left_right_px: Option<u16>,
    /// Disparities from here on are too near.
    pub too_near_px: f64,
}

impl<'a> Filter<'a> {
    pub fn new(matches: &'a Matches, limits: &Limits) -> Self {
        Self {
            disparity: matches.disparity.values(),
            peak_ratio: &matches.peak_ratio,
            left_right_difference_px: &matches.left_right_difference_px,
            least_ratio: next_single(limits.peak_ratio),
            most_difference: limits.left_right_px.unwrap_or(u16::MAX),
            too_near: next_single(limits.too_near_px),
        }
    }

    /// The disparity of a pixel, or [`INVALID`]. NaN fails every comparison; -0 becomes 0.
    #[inline(always)]
    pub fn at(&self, pixel: usize) -> f32 {
        let disparity = self.disparity[pixel];
        let believed = (self.peak_ratio[pixel] >= self.least_ratio)
            & (self.left_right_difference_px[pixel] <= self.most_difference)
            & (disparity < self.too_near);
        if believed { disparity.abs() } else { INVALID }
    }

    /// Fills a row of disparities, [`INVALID`] where there is none, from the pixel `first` on.
    #[inline(always)]
    pub fn fill(&self, first: usize, row: &mut [f32]) {
        let pixels = first..first + row.len();
        let (ratio, difference) =
            (&self.peak_ratio[pixels.clone()], &self.left_right_difference_px[pixels.clone()]);
        let disparity = &self.disparity[pixels];
        for (((to, &d), &ratio), &difference) in row.iter_mut().zip(disparity).zip(ratio).zip(difference) {
            let believed =
                (ratio >= self.least_ratio) & (difference <= self.most_difference) & (d < self.too_near);
            *to = if believed { d.abs() } else { INVALID };
        }
    }
}

/// The least single that is not below a number, so that singles compare with it as with the number itself.
fn next_single(bound: f64) -> f32 {
    let single = bound as f32;
    if f64::from(single) < bound { single.next_up() } else { single }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_core::Disparity;

    #[test]
    fn only_believed_matches_pass() {
        let disparity = Disparity::new(7, 1, vec![3.0, f32::NAN, 0.0, 3.0, 3.0, 9.0, 8.9]).unwrap();
        let matches = Matches {
            disparity,
            peak_ratio: vec![1.5, f32::NAN, 2.0, 1.4, f32::INFINITY, 2.0, 2.0],
            left_right_difference_px: vec![1, u16::MAX, 0, 0, 2, 0, 0],
        };
        let limits = Limits { peak_ratio: 1.5, left_right_px: Some(1), too_near_px: 9.0 };
        let expected = [3.0, INVALID, 0.0, INVALID, INVALID, INVALID, 8.9];
        let filter = Filter::new(&matches, &limits);
        let mut row = [0.0; 7];
        filter.fill(0, &mut row);
        assert_eq!(row, expected);
        assert_eq!(std::array::from_fn(|pixel| filter.at(pixel)), expected);
        let all = Limits { peak_ratio: 1.0, left_right_px: None, too_near_px: f64::INFINITY };
        Filter::new(&matches, &all).fill(0, &mut row);
        assert_eq!(row, [3.0, INVALID, 0.0, 3.0, 3.0, 9.0, 8.9]);
    }
}
