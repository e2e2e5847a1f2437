use crate::CoreError;
use crate::error::require_length;

/// A disparity image of the left camera, row-major, in pixels: NaN = no measurement, 0 = infinitely far.
#[derive(Debug, Clone)]
pub struct Disparity {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Disparity {
    /// A disparity image of `width` x `height` pixels from its rows.
    ///
    /// # Errors
    /// If the length does not fit, or a value is negative or infinite (NaN is allowed: no measurement).
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Result<Self, CoreError> {
        require_length("disparity image", &[width, height], values.len())?;
        match values.iter().find(|v| v.is_infinite() || **v < 0.0) {
            None => Ok(Self { width, height, values }),
            Some(&v) => Err(CoreError::Domain {
                what: "disparity",
                expected: "NaN or a finite number from 0 px",
                found: f64::from(v),
            }),
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All disparities, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The disparities of row `y`.
    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..(y + 1) * self.width]
    }

    /// Gives the buffer back, so that the next frame can fill it.
    pub fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// How many pixels carry a measurement.
    pub fn valid_count(&self) -> usize {
        self.values.iter().filter(|v| !v.is_nan()).count()
    }
}

/// The winner of every pixel of the left image, and how sure it is. No filter is applied: each method applies
/// its own ([`crate::MatchFilter`]).
#[derive(Debug, Clone)]
pub struct Matches {
    /// Disparity of the winner (lowest cost), with sub-pixel part; NaN where no hypothesis had a cost.
    pub disparity: Disparity,
    /// Peak ratio c_m2 / c_m1 per pixel (Brandao et al., section IV): second smallest over smallest local
    /// minimum of the cost curve; infinite if there is only one minimum; NaN where there is no winner. At
    /// least 1.
    pub peak_ratio: Vec<f32>,
    /// |winner of the pixel - winner of the right-image pixel it points to|, whole pixels, row-major;
    /// `u16::MAX` where either has no winner.
    pub left_right_difference_px: Vec<u16>,
}

impl Matches {
    /// Matches that come from elsewhere as a bare disparity image: peak ratio infinite, left-right difference
    /// 0 wherever there is a disparity.
    pub fn from_disparity(disparity: Disparity) -> Self {
        let known = |v: &f32| !v.is_nan();
        let peak_ratio =
            disparity.values().iter().map(|v| if known(v) { f32::INFINITY } else { f32::NAN }).collect();
        let left_right_difference_px =
            disparity.values().iter().map(|v| if known(v) { 0 } else { u16::MAX }).collect();
        Self { disparity, peak_ratio, left_right_difference_px }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_disparities_are_refused() {
        assert!(Disparity::new(2, 1, vec![0.0, f32::NAN]).is_ok());
        for bad in [f32::INFINITY, -1.0, f32::NEG_INFINITY] {
            assert!(Disparity::new(2, 1, vec![1.0, bad]).is_err(), "{bad}");
        }
        assert!(Disparity::new(2, 2, vec![1.0; 3]).is_err());
        assert!(Disparity::new(0, 2, vec![]).is_err());
    }

    #[test]
    fn a_foreign_disparity_passes_every_filter() {
        let m = Matches::from_disparity(Disparity::new(2, 1, vec![f32::NAN, 3.0]).unwrap());
        assert!(m.peak_ratio[0].is_nan() && m.peak_ratio[1] == f32::INFINITY);
        assert_eq!(m.left_right_difference_px, [u16::MAX, 0]);
        assert_eq!(m.disparity.valid_count(), 1);
    }
}
