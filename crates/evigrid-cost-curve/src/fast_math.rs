//! The exponential as a short polynomial over floats that a compiler turns into vector code. It uses
//! additions, multiplications and divisions alone, which round the same on every processor.

use std::f32::consts::{LN_2, LOG2_E};

/// The largest relative error of this crate's polynomial for e^-x, x from 0 to 87, beside that of its
/// argument's rounding (6e-8 of the argument); asserted in the tests.
pub const EXP2_ERROR: f64 = 4e-7;

/// The number 1.5 * 2^23. Added to one from -126 to 0, it leaves the nearest whole number in the low bits.
const ROUND: f32 = 12_582_912.0;

/// Exponential e^-x for x >= 0; 0 (below 1.2e-38) where x is above 87.
#[inline(always)]
pub(crate) fn exp_negative(x: f32) -> f32 {
    let exponent = -x * LOG2_E;
    let bounded = if exponent > -126.0 { exponent } else { -126.0 };
    let shifted = bounded + ROUND;
    let f = bounded - (shifted - ROUND);
    // The series of 2^f for |f| <= 1/2; the first term left out is below 1.2e-7.
    let mut sum = 1.540_353e-4;
    for c in [1.333_355_8e-3, 9.618_129e-3, 5.550_411e-2, 2.402_265e-1, LN_2, 1.0] {
        sum = sum * f + c;
    }
    let power = f32::from_bits(sum.to_bits().wrapping_add(shifted.to_bits() << 23));
    if exponent > -126.0 { power } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_keeps_its_bound() {
        for k in 0..=870_000 {
            let x = k as f32 * 1e-4;
            let (found, exact) = (f64::from(exp_negative(x)), (-f64::from(x)).exp());
            let bound = EXP2_ERROR + 1.2e-7 * f64::from(x);
            assert!((found / exact - 1.0).abs() < bound, "{x}: {found}, expected {exact}");
        }
        assert_eq!(exp_negative(0.0), 1.0);
        for x in [88.0, 1e10, f32::INFINITY] {
            assert_eq!(exp_negative(x), 0.0);
        }
    }
}
