//! The profile of one ray from its whole cost curve (Brandao et al., section III), in double precision and
//! word for word. Figures are made from it, and the mapper's fast code is tested against it.
//!
//! Slices run along a ray, nearest first; p_i = p(O_i | E V_i) is the probability that cell (or hypothesis) i
//! is occupied, given the cost curve E and that everything in front of it is free.

use super::cost_exponent::CostExponent;

/// Visibility v_i = p(V_i | E), the probability that everything in front of i is free (Brandao et al., eq.
/// 5): the product of 1 - p_j over all j < i.
pub fn visibility(p: &[f64]) -> Vec<f64> {
    let mut visible = 1.0;
    p.iter()
        .map(|p| {
            let v = visible;
            visible *= 1.0 - p;
            v
        })
        .collect()
}

/// Occupancy P_i = p(O_i | E) (Brandao et al., eq. 4), with prior 0.5 for hidden cells:
/// p_i v_i + 0.5 (1 - v_i).
pub fn profile(p: &[f64]) -> Vec<f64> {
    p.iter().zip(visibility(p)).map(|(p, v)| p * v + 0.5 * (1.0 - v)).collect()
}

/// Likelihood p(E(d) | d) of every hypothesis (Brandao et al., eq. 7): exp(-E(d) / (2 sigma^2)) over the sum
/// of all, with the exponent in the unit of `exponent`. Missing costs (NaN or infinite) get 0; so does
/// everything if all are missing. Only differences of the exponents count, so none over- or underflows as a
/// whole.
pub fn likelihood(costs: &[f64], exponent: CostExponent) -> Vec<f64> {
    normalised(
        costs.iter().map(|&c| if c.is_finite() { -exponent.of(c) } else { f64::NEG_INFINITY }).collect(),
    )
}

/// Likelihood p(E(d) | free, visible) of every hypothesis: a normal distribution of the costs of free space
/// (Brandao et al., section III-C, Fig. 3), over its sum along the curve, so that it can be compared with
/// [`likelihood`]: as printed, one is a density and the other is not.
pub fn free_space_likelihood(costs: &[f64], mean: f64, variance: f64) -> Vec<f64> {
    let ln = |c: f64| -(c - mean).powi(2) / (2.0 * variance);
    normalised(costs.iter().map(|&c| if c.is_finite() { ln(c) } else { f64::NEG_INFINITY }).collect())
}

/// Probabilities p_i by Bayes (Brandao et al., eq. 6) from p(E | O_i V_i) and p(E | F_i V_i), with priors
/// 0.5; 0 where both are 0.
pub fn with_free_space(occupied: &[f64], free: &[f64]) -> Vec<f64> {
    let bayes = |(&o, &f): (&f64, &f64)| if o > 0.0 { o / (o + f) } else { 0.0 };
    occupied.iter().zip(free).map(bayes).collect()
}

/// Exponentials over their sum, from their logarithms.
fn normalised(logarithms: Vec<f64>) -> Vec<f64> {
    let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return vec![0.0; logarithms.len()];
    }
    let weights: Vec<f64> = logarithms.iter().map(|l| (l - largest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::cost_curve::CostUnit;
    use crate::elfes::occupancy;
    use proptest::prelude::*;

    /// Eqs 4 and 5 by all 2^N configurations: going outwards, cell i is occupied with p_i as long as all
    /// before it are free; behind the first obstacle every cell is as likely occupied as free.
    fn brute_force(p: &[f64]) -> Vec<f64> {
        let n = p.len();
        let mut occupied = vec![0.0; n];
        for configuration in 0_u32..1 << n {
            let is_occupied = |cell: usize| configuration >> cell & 1 == 1;
            let first = (0..n).find(|&cell| is_occupied(cell)).unwrap_or(n);
            let free: f64 = p[..first].iter().map(|p| 1.0 - p).product();
            let met = if first < n { p[first] * 0.5_f64.powi((n - first - 1) as i32) } else { 1.0 };
            (0..n).filter(|&i| is_occupied(i)).for_each(|i| occupied[i] += free * met);
        }
        occupied
    }

    proptest! {
        #[test]
        fn equations_4_and_5_equal_all_configurations(p in prop::collection::vec(0.0..=1.0_f64, 1..=12)) {
            for (fast, slow) in profile(&p).iter().zip(brute_force(&p)) {
                prop_assert!((fast - slow).abs() < 1e-12, "{fast} {slow}");
            }
        }

        #[test]
        fn identities(p in prop::collection::vec(0.0..=1.0_f64, 1..=200)) {
            let (v, all) = (visibility(&p), profile(&p));
            for i in 0..p.len() {
                prop_assert!((all[i] - 0.5 - v[i] * (p[i] - 0.5)).abs() < 1e-12);
                prop_assert!(v[i] < 1e-9 || (p[i] - 0.5).abs() < 1e-9 || (all[i] > 0.5) == (p[i] > 0.5));
            }
            let met: f64 = p.iter().zip(&v).map(|(p, v)| p * v).sum();
            let none: f64 = p.iter().map(|p| 1.0 - p).product();
            prop_assert!((met + none - 1.0).abs() < 1e-12);
        }

        #[test]
        fn with_equation_9_at_most_one_hypothesis_is_above_a_half(
            costs in prop::collection::vec(0.0..12_000.0_f64, 1..=128),
            variance in 0.1..500.0_f64,
        ) {
            let p = likelihood(&costs, CostExponent::new(CostUnit::GreyLevels, variance, 49.0));
            prop_assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let above = profile(&p).iter().filter(|p| **p > 0.5 + 1e-12).count();
            prop_assert!(above <= 1, "{above}");
        }
    }

    /// Two equal peaks: both keep 0.5, with 0.25 between them; Elfes' model all but forgets the second.
    #[test]
    fn two_equal_peaks() {
        let peaks = |cell: usize| if cell == 20 || cell == 40 { 0.5 } else { 0.0 };
        let p: Vec<f64> = (1..=60).map(peaks).collect();
        let (whole, elfes) = (profile(&p), occupancy(&p));
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert!(near(whole[19], 0.5) && near(whole[39], 0.5), "{} {}", whole[19], whole[39]);
        assert!(whole[..19].iter().all(|p| *p == 0.0));
        assert!(whole[20..39].iter().all(|p| near(*p, 0.25)));
        assert!(elfes[19] > 0.99 && elfes[20..].iter().all(|p| near(*p, 0.5)), "{elfes:?}");
    }

    /// Unimodal sensor models give nearly the same profile in both formulations (section III-A, Fig. 2).
    #[test]
    fn one_narrow_peak_is_the_same_for_both() {
        let p: Vec<f64> = (1..=60).map(|cell| f64::from(u8::from(cell == 20))).collect();
        assert_eq!(profile(&p), occupancy(&p));
    }

    #[test]
    fn curves_that_say_nothing() {
        let exponent = CostExponent::new(CostUnit::GreyLevels, 4.0, 49.0);
        assert_eq!(likelihood(&[f64::NAN, 8.0, f64::INFINITY, 8.0], exponent), [0.0, 0.5, 0.0, 0.5]);
        assert_eq!(likelihood(&[f64::NAN; 3], exponent), [0.0; 3]);
        assert_eq!(likelihood(&[1e6], exponent), [1.0], "a lone hypothesis is certain");
        assert_eq!(likelihood(&[100.0; 4], exponent), [0.25; 4]);
        assert_eq!(profile(&[0.0; 3]), [0.0; 3]);
        assert!(profile(&[]).is_empty());
        let free = free_space_likelihood(&[100.0; 4], 100.0, 9.0);
        assert_eq!(with_free_space(&likelihood(&[100.0; 4], exponent), &free), [0.5; 4]);
        assert_eq!(with_free_space(&[0.0, 0.5], &[0.0, 0.0]), [0.0, 1.0]);
    }

    #[test]
    fn equation_7_by_hand() {
        // exp(-E / (2 * 4)): costs 0 and 8 ln 3 are as 3 to 1.
        let exponent = CostExponent::new(CostUnit::GreyLevels, 4.0, 49.0);
        let p = likelihood(&[8.0 * 3_f64.ln(), 0.0], exponent);
        assert!((p[0] - 0.25).abs() < 1e-12 && (p[1] - 0.75).abs() < 1e-12, "{p:?}");
        // A normal distribution one deviation off its mean: e^-1/2.
        let f = free_space_likelihood(&[10.0, 13.0], 10.0, 9.0);
        assert!((f[1] / f[0] - (-0.5_f64).exp()).abs() < 1e-12);
    }
}
