//! Log-odds as a short polynomial over floats that a compiler turns into vector code. It uses additions,
//! multiplications and divisions alone, which round the same on every processor.

use std::f32::consts::LN_2;

use crate::Clamp;

/// The largest error of [`bounded_logit`] for P from 1e-6 to 0.999, log-odds, beside that of P's rounding;
/// asserted in the tests.
pub const LOG_ODDS_ERROR: f64 = 2e-6;

/// ln(P / (1 - P)) within bounds; 0 for P = 0.5, and of P's side of 0 for every other P.
#[inline(always)]
pub fn bounded_logit(p: f32, bounds: Clamp) -> f32 {
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
    use crate::logit;

    const WIDE: Clamp = Clamp { min: -40.0, max: 40.0 };

    #[test]
    fn log_odds_keep_their_bound() {
        for k in 1..=999_000 {
            let p = k as f32 * 1e-6;
            // 1 - P rounds to half of 6e-8.
            let bound = LOG_ODDS_ERROR + 3e-8 / (1.0 - f64::from(p));
            let (found, exact) = (f64::from(bounded_logit(p, WIDE)), logit(f64::from(p)));
            assert!((found - exact).abs() < bound, "{p}: {found}, expected {exact}");
            assert!(found.total_cmp(&0.0) == p.total_cmp(&0.5) || p == 0.5, "{p}: {found}");
        }
        assert_eq!(bounded_logit(0.5, WIDE), 0.0);
        assert!(
            bounded_logit(0.5_f32.next_down(), WIDE) < 0.0 && bounded_logit(0.5_f32.next_up(), WIDE) > 0.0
        );
        let bounds = Clamp { min: -5.0, max: 3.0 };
        assert_eq!([0.0, 1.0].map(|p| bounded_logit(p, bounds)), [-5.0, 3.0]);
    }
}
