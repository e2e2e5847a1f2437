//! Statistics of a whole stereo pair: the noise of its grey values, and the costs of its free space.

use evigrid_core::{CostVolume, Disparity, GrayImage, MatchFilter, MatchLimits, Matches, NO_COST};
use rayon::prelude::*;

/// The least variance of a difference of two grey values, grey levels^2: rounding either to a whole level has
/// a variance of 1/12. Eq. 7 of Brandao et al. divides by the variance, which identical images would make 0.
pub const PIXEL_VARIANCE_FLOOR: f64 = 1.0 / 6.0;
/// The least mean of the absolute difference of two grey values, grey levels: rounding both to whole levels
/// leaves 1/3.
pub const MEAN_DIFFERENCE_FLOOR: f64 = 1.0 / 3.0;
/// The least variance of the costs of free space, in units of the volume^2: that of rounding to whole
/// numbers.
const COST_VARIANCE_FLOOR: f64 = 1.0 / 12.0;

/// Mean and variance of the costs that are measured where space is free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeSpaceCosts {
    /// Mean, in units of the volume.
    pub mean: f64,
    /// Variance, in units of the volume^2.
    pub variance: f64,
}

/// The winning hypothesis of a pixel, whole pixels, from its disparity with sub-pixel part; `None` without a
/// winner. Of two equally good neighbours, between which the sub-pixel part is one half, the smaller won.
#[inline]
fn winner(disparity: f32) -> Option<usize> {
    (!disparity.is_nan()).then(|| (disparity - 0.5).ceil().max(0.0) as usize)
}

/// Variance sigma^2 of a stereo pair (Brandao et al., eq. 10), grey levels^2: that of the difference
/// I2(x, y) - I1(x + d', y) over all pixels with a winner d', where I1 is the left image; no less than
/// [`PIXEL_VARIANCE_FLOOR`]. The printed sum is taken as a mean, as the text says: "variance".
pub fn pixel_variance(left: &GrayImage, right: &GrayImage, winners: &Disparity) -> f64 {
    let row_sums = |y: usize| {
        let (left, right) = (left.row(y), right.row(y));
        let mut sums = Sums::default();
        for (x, d) in winners.row(y).iter().enumerate() {
            // A winner's window lies in both images; a disparity from elsewhere may point out of one.
            if let Some(facing) = winner(*d).and_then(|d| x.checked_sub(d)) {
                sums.add(i64::from(right[facing]) - i64::from(left[x]));
            }
        }
        sums
    };
    let sums = (0..winners.height()).into_par_iter().map(row_sums).reduce(Sums::default, Sums::plus);
    sums.mean_and_variance().map_or(PIXEL_VARIANCE_FLOOR, |(_, variance)| variance.max(PIXEL_VARIANCE_FLOOR))
}

/// Scale b of Laplacian noise that is most likely, grey levels: the mean |I2(x, y) - I1(x + d', y)| over all
/// pixels with a winner d' that the right image confirms within `left_right_px` pixels (`None`: nobody asks
/// it). No less than [`MEAN_DIFFERENCE_FLOOR`].
pub fn mean_difference(
    left: &GrayImage,
    right: &GrayImage,
    matches: &Matches,
    left_right_px: Option<u16>,
) -> f64 {
    let filter = MatchFilter::new(matches, &MatchLimits::left_right(left_right_px));
    let width = left.width();
    let row_sums = |y: usize| {
        let (left, right) = (left.row(y), right.row(y));
        let mut sums = Sums::default();
        for (x, d) in matches.disparity.row(y).iter().enumerate() {
            let confirmed = filter.is_confirmed(y * width + x);
            if let Some(facing) = winner(*d).and_then(|d| x.checked_sub(d)).filter(|_| confirmed) {
                sums.add(i64::from(right[facing].abs_diff(left[x])));
            }
        }
        sums
    };
    let sums = (0..left.height()).into_par_iter().map(row_sums).reduce(Sums::default, Sums::plus);
    sums.mean_and_variance().map_or(MEAN_DIFFERENCE_FLOOR, |(mean, _)| mean.max(MEAN_DIFFERENCE_FLOOR))
}

/// The costs of visible free space (Brandao et al., section III-C, Fig. 3): those of all hypotheses nearer
/// than the pixel's winner, in which the true disparity is unknown. `None` if there are none.
pub fn free_space_costs(volume: &CostVolume, winners: &Disparity) -> Option<FreeSpaceCosts> {
    let row_sums = |y: usize| {
        let mut sums = Sums::default();
        for (index, costs) in volume.row(y).chunks_exact(volume.width()).enumerate() {
            let d = volume.min_disparity() + index;
            for (&cost, &disparity) in costs.iter().zip(winners.row(y)) {
                let nearer = winner(disparity).is_some_and(|winner| d > winner);
                if nearer && cost != NO_COST {
                    sums.add(i64::from(cost));
                }
            }
        }
        sums
    };
    let sums = (0..volume.height()).into_par_iter().map(row_sums).reduce(Sums::default, Sums::plus);
    let (mean, variance) = sums.mean_and_variance()?;
    Some(FreeSpaceCosts { mean, variance: variance.max(COST_VARIANCE_FLOOR) })
}

/// Sums of whole numbers, which do not depend on the order.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: u64,
    sum: i64,
    squares: u64,
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, value: i64) {
        self.count += 1;
        self.sum += value;
        self.squares += (value * value) as u64;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    fn mean_and_variance(self) -> Option<(f64, f64)> {
        let n = self.count as f64;
        let mean = self.sum as f64 / n;
        (self.count > 0).then(|| (mean, (self.squares as f64 / n - mean * mean).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_core::CostScale;

    #[test]
    fn variance_of_the_winners_differences_by_hand() {
        let image = |pixels: &[u8]| GrayImage::new(4, 1, pixels.to_vec()).unwrap();
        let (left, right) = (image(&[10, 20, 30, 40]), image(&[22, 33, 40, 50]));
        let of = |d: [f32; 4]| pixel_variance(&left, &right, &Disparity::new(4, 1, d.to_vec()).unwrap());
        let none = f32::NAN;
        // right[0] - left[1] = 2; right[1] - left[2] = 3, where 1.5 is a tie that 1 has won;
        // right[3] - left[3] = 10.
        assert!((of([none, 0.8, 1.5, 0.0]) - (113.0 / 3.0 - 25.0)).abs() < 1e-12);
        // One pixel has no variance, none has no mean, and x - d outside the image is no difference.
        for d in [[none, 0.8, none, none], [none; 4], [3.0, 3.0, 3.0, none]] {
            assert_eq!(of(d), PIXEL_VARIANCE_FLOOR);
        }
    }

    #[test]
    fn free_space_is_nearer_than_the_winner() {
        // Hypotheses 1, 2, 3 of two pixels.
        let scale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };
        let volume = CostVolume::new(2, 1, 1, 3, scale, vec![5, 9, 100, 9, NO_COST, 30]).unwrap();
        let of = |d: [f32; 2]| free_space_costs(&volume, &Disparity::new(2, 1, d.to_vec()).unwrap());
        assert_eq!(of([1.0, 1.5]).unwrap().mean, (100.0 + 9.0 + 30.0) / 3.0);
        assert_eq!(of([1.3, f32::NAN]), Some(FreeSpaceCosts { mean: 100.0, variance: 1.0 / 12.0 }));
        assert_eq!(of([3.0, f32::NAN]), None);
    }
}
