use crate::{CoreError, Disparity, Matches};

/// Stands for "no measurement" where disparities are compared: below all of them.
pub const NO_MATCH: f32 = -1.0;

/// The limits that a match must keep to be believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchLimits {
    /// Smallest peak ratio; 1 lets all winners pass.
    pub peak_ratio: f64,
    /// Largest difference between the winners of the left and the right image, pixels; `None`: whatever it
    /// is.
    pub left_right_px: Option<u16>,
    /// Disparities from here on are too near, pixels.
    pub too_near_px: f64,
}

impl MatchLimits {
    /// Limits on nothing but the difference between left and right, pixels; `None`: no limits at all.
    pub fn left_right(left_right_px: Option<u16>) -> Self {
        Self { peak_ratio: 1.0, left_right_px, too_near_px: f64::INFINITY }
    }
}

/// Matches of one frame with the limits they must keep: the one filter of all methods, so that they are
/// compared under equal conditions. Pixels are flat indices, row by row.
#[derive(Debug, Clone, Copy)]
pub struct MatchFilter<'a> {
    matches: &'a Matches,
    least_ratio: f32,
    most_difference: u16,
    too_near: f32,
}

impl<'a> MatchFilter<'a> {
    /// The filter of these limits.
    pub fn new(matches: &'a Matches, limits: &MatchLimits) -> Self {
        Self {
            matches,
            least_ratio: next_single(limits.peak_ratio),
            most_difference: limits.left_right_px.unwrap_or(u16::MAX),
            too_near: next_single(limits.too_near_px),
        }
    }

    /// Whether the right image confirms a pixel's winner, or nobody asks it. A pixel without a winner counts
    /// as confirmed only if nobody asks.
    #[inline(always)]
    pub fn is_confirmed(&self, pixel: usize) -> bool {
        self.matches.left_right_difference_px[pixel] <= self.most_difference
    }

    /// The disparity of a believed match, or [`NO_MATCH`]. NaN fails every comparison; -0 becomes 0.
    #[inline(always)]
    pub fn at(&self, pixel: usize) -> f32 {
        let disparity = self.matches.disparity.values()[pixel];
        let believed = (self.matches.peak_ratio[pixel] >= self.least_ratio)
            & self.is_confirmed(pixel)
            & (disparity < self.too_near);
        if believed { disparity.abs() } else { NO_MATCH }
    }

    /// Fills a row with the disparities from the pixel `first` on, [`NO_MATCH`] where no match is believed.
    #[inline(always)]
    pub fn fill(&self, first: usize, row: &mut [f32]) {
        let pixels = first..first + row.len();
        let ratio = &self.matches.peak_ratio[pixels.clone()];
        let difference = &self.matches.left_right_difference_px[pixels.clone()];
        let disparity = &self.matches.disparity.values()[pixels];
        for (((to, &d), &ratio), &difference) in row.iter_mut().zip(disparity).zip(ratio).zip(difference) {
            let believed =
                (ratio >= self.least_ratio) & (difference <= self.most_difference) & (d < self.too_near);
            *to = if believed { d.abs() } else { NO_MATCH };
        }
    }

    /// The disparity image of the believed matches, NaN elsewhere.
    ///
    /// # Errors
    /// Never for matches of one size.
    pub fn disparity(&self) -> Result<Disparity, CoreError> {
        let (width, height) = (self.matches.disparity.width(), self.matches.disparity.height());
        let mut values = vec![0.0; width * height];
        self.fill(0, &mut values);
        values.iter_mut().filter(|v| **v == NO_MATCH).for_each(|v| *v = f32::NAN);
        Disparity::new(width, height, values)
    }
}

/// The least single that is not below a number, so that singles compare with it as with the number itself.
fn next_single(bound: f64) -> f32 {
    let single = bound as f32;
    if f64::from(single) < bound { single.next_up() } else { single }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_believed_matches_pass() {
        let disparity = Disparity::new(7, 1, vec![3.0, f32::NAN, 0.0, 3.0, 3.0, 9.0, 8.9]).unwrap();
        let matches = Matches {
            disparity,
            peak_ratio: vec![1.5, f32::NAN, 2.0, 1.4, f32::INFINITY, 2.0, 2.0],
            left_right_difference_px: vec![1, u16::MAX, 0, 0, 2, 0, 0],
        };
        let limits = MatchLimits { peak_ratio: 1.5, left_right_px: Some(1), too_near_px: 9.0 };
        let expected = [3.0, NO_MATCH, 0.0, NO_MATCH, NO_MATCH, NO_MATCH, 8.9];
        let filter = MatchFilter::new(&matches, &limits);
        let mut row = [0.0; 7];
        filter.fill(0, &mut row);
        assert_eq!(row, expected);
        assert_eq!(std::array::from_fn(|pixel| filter.at(pixel)), expected);
        let kept = filter.disparity().unwrap();
        assert_eq!(kept.valid_count(), 3);
        let all = MatchLimits::left_right(None);
        MatchFilter::new(&matches, &all).fill(0, &mut row);
        assert_eq!(row, [3.0, NO_MATCH, 0.0, 3.0, 3.0, 9.0, 8.9]);
    }

    /// The slow twin compares in double precision.
    #[test]
    fn limits_that_are_no_singles_compare_as_themselves() {
        for (limit, ratio) in [(1.1, 1.1_f32), (1.3, 1.3_f32), (1.2, 1.2_f32), (1.5, 1.5_f32), (1.7, 1.7_f32)]
        {
            let disparity = Disparity::new(1, 1, vec![2.0]).unwrap();
            let matches = Matches { peak_ratio: vec![ratio], ..Matches::from_disparity(disparity) };
            let limits = MatchLimits { peak_ratio: limit, ..MatchLimits::left_right(None) };
            let believed = MatchFilter::new(&matches, &limits).at(0) == 2.0;
            assert_eq!(believed, f64::from(ratio) >= limit, "{limit}");
        }
    }
}
