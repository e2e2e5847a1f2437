//! The cell of a ray that stops it: Elfes' inverse sensor model (Brandao et al., eqs 1 to 3) with any prior
//! instead of 0.5. In double precision and word for word; the fast code of `cost-curve-bayes` is tested
//! against it.
//!
//! Slices run along a ray, nearest first.

/// Probability P(cell i stops rays that reach it | E) of all cells, from the likelihoods g_i = p(E | the
/// first obstacle is in cell i), `beyond` = p(E | no cell stops the ray), and the prior of every cell,
/// `stops` (0 to 1, exclusive):
///
/// P_i = (w_i + stops sum_{j<i} w_j) / (sum_j w_j + (1 - stops)^N beyond), w_j = stops (1 - stops)^(j-1) g_j.
///
/// With prior 0.5 and `beyond` 0 this is [`occupancy`](crate::occupancy). Where nothing is possible, the
/// prior.
pub fn stopping(likelihoods: &[f64], beyond: f64, stops: f64) -> Vec<f64> {
    let mut reached = 1.0;
    let weights: Vec<f64> = likelihoods
        .iter()
        .map(|g| {
            let weight = stops * reached * g;
            reached *= 1.0 - stops;
            weight
        })
        .collect();
    let all = weights.iter().sum::<f64>() + reached * beyond;
    if all <= 0.0 {
        return vec![stops; likelihoods.len()];
    }
    let mut before = 0.0;
    weights
        .iter()
        .map(|weight| {
            let p = (weight + stops * before) / all;
            before += weight;
            p
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::elfes::occupancy;
    use proptest::prelude::*;

    /// Bayes over all 2^N configurations of the cells.
    fn brute_force(likelihoods: &[f64], beyond: f64, stops: f64) -> Vec<f64> {
        let n = likelihoods.len();
        let (mut all, mut stopping) = (0.0, vec![0.0; n]);
        for configuration in 0_u32..1 << n {
            let blocks = |cell: usize| configuration >> cell & 1 == 1;
            let prior: f64 = (0..n).map(|cell| if blocks(cell) { stops } else { 1.0 - stops }).product();
            let p = prior * (0..n).find(|&cell| blocks(cell)).map_or(beyond, |cell| likelihoods[cell]);
            all += p;
            (0..n).filter(|&cell| blocks(cell)).for_each(|cell| stopping[cell] += p);
        }
        stopping.iter().map(|p| p / all).collect()
    }

    proptest! {
        #[test]
        fn the_closed_form_equals_all_configurations(
            g in prop::collection::vec(1e-6..1.0_f64, 1..=12),
            beyond in 0.0..1.0_f64,
            stops in 0.01..0.99_f64,
        ) {
            for (fast, slow) in stopping(&g, beyond, stops).iter().zip(brute_force(&g, beyond, stops)) {
                prop_assert!((fast - slow).abs() < 1e-12, "{fast} {slow}");
            }
        }

        #[test]
        fn curves_that_say_nothing_leave_the_prior(
            n in 1..200_usize,
            g in 1e-6..1.0_f64,
            stops in 0.01..0.5_f64,
        ) {
            prop_assert!(stopping(&vec![g; n], g, stops).iter().all(|p| (p - stops).abs() < 1e-9));
        }
    }

    #[test]
    fn with_prior_one_half_it_is_elfes() {
        let g: Vec<f64> = (1..=60).map(|cell| (-f64::from(cell - 20).powi(2) / 10.0).exp()).collect();
        for (a, b) in stopping(&g, 0.0, 0.5).iter().zip(occupancy(&g)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert_eq!(stopping(&[0.0; 3], 0.0, 0.1), [0.1; 3]);
    }

    /// The first of two equal peaks does not win outright, as it does with prior 0.5: the second keeps its
    /// share.
    #[test]
    fn two_equal_peaks_share() {
        let g: Vec<f64> = (1..=60).map(|cell| f64::from(u8::from(cell == 20 || cell == 40))).collect();
        let p = stopping(&g, 0.0, 0.05);
        // Odds of the two: 1 to 0.95^20.
        let first = 1.0 / (1.0 + 0.95_f64.powi(20));
        assert!((p[19] - first).abs() < 1e-12, "{}", p[19]);
        assert!((p[39] - (1.0 - first + 0.05 * first)).abs() < 1e-12, "{}", p[39]);
        assert!((p[30] - 0.05 * first).abs() < 1e-12 && p[10] == 0.0);
    }
}
