//! exp and logit as short polynomials over floats that a compiler turns into vector code. They use additions,
//! multiplications and divisions alone, which round the same on every processor.

use std::f32::consts::{LN_2, LOG2_E};

use evigrid_grid::Clamp;

/// The largest relative error of [`exp_negative`] over -87..=0, beside that of its argument's rounding (6e-8 of
/// the argument); asserted in the tests.
pub const EXP2_ERROR: f64 = 4e-7;
/// The largest error of [`log_odds`] for P from 1e-6 to 0.999, log-odds, beside that of P's rounding; asserted in the
/// tests.
pub const LOG_ODDS_ERROR: f64 = 2e-6;

/// 2^x of -126 to 0 takes the whole number nearest to x from the low bits of x + 1.5 * 2^23.
const ROUND: f32 = 12_582_912.0;

/// e^-x for x >= 0; 0 (below 1.2e-38) where x is above 87.
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

/// ln(P / (1 - P)) within bounds; 0 for P = 0.5, and of P's side of 0 for every other P.
#[inline(always)]
pub(crate) fn log_odds(p: f32, bounds: Clamp) -> f32 {
    const SMALL: f32 = 1e-30;
    let odds = (p + SMALL) / (1.0 - p + SMALL);
    // odds = m 2^e with m from sqrt(1/2) to sqrt(2).
    let bits = odds.to_bits() as i32;
    let e = (bits - 0x3f35_04f3) >> 23;
    let m = f32::from_bits((bits - (e << 23)) as u32);
    // ln m = 2 artanh(t); the first term left out is below 3e-8.
    let t = (m - 1.0) / (m + 1.0);
    let t2 = t * t;
    let series = ((t2 * (2.0 / 7.0) + 2.0 / 5.0) * t2 + 2.0 / 3.0) * t2 + 2.0;
    let l = e as f32 * LN_2 + t * series;
    let l = if l < bounds.max { l } else { bounds.max };
    if l > bounds.min { l } else { bounds.min }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::logit;

    const WIDE: Clamp = Clamp { min: -40.0, max: 40.0 };

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

    #[test]
    fn log_odds_keep_their_bound() {
        for k in 1..=999_000 {
            let p = k as f32 * 1e-6;
            // 1 - P rounds to half of 6e-8.
            let bound = LOG_ODDS_ERROR + 3e-8 / (1.0 - f64::from(p));
            let (found, exact) = (f64::from(log_odds(p, WIDE)), logit(f64::from(p)));
            assert!((found - exact).abs() < bound, "{p}: {found}, expected {exact}");
            assert!(found.total_cmp(&0.0) == p.total_cmp(&0.5) || p == 0.5, "{p}: {found}");
        }
        assert_eq!(log_odds(0.5, WIDE), 0.0);
        assert!(log_odds(0.5_f32.next_down(), WIDE) < 0.0 && log_odds(0.5_f32.next_up(), WIDE) > 0.0);
        let bounds = Clamp { min: -5.0, max: 3.0 };
        assert_eq!([0.0, 1.0].map(|p| log_odds(p, bounds)), [-5.0, 3.0]);
    }
}
