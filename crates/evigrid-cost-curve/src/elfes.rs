//! Elfes' inverse sensor model for a ray of cells (Brandao et al., section II-A, eqs 1 and 2), in closed
//! form.

/// Evidence is drawn only where it is at least this many log-odds away from the prior (P 0.5025 beside a
/// prior of 0.5).
pub const PRIOR_TOLERANCE: f32 = 0.01;

/// Occupancy P(O_i | r) of the cells of a ray, from the sensor outwards, given `likelihood[j]` = g_j =
/// p(r | cell j is the first obstacle), with prior 0.5 for every cell.
///
/// Summed over all 2^(N-1) configurations of the other cells, eq. 2 collapses: with w_j = 2^-j g_j,
/// P_i = (w_i + 1/2 sum_{j<i} w_j) / sum_j w_j. The likelihood of a ray without any obstacle is taken as 0.
/// Where all likelihoods are 0 the ray says nothing: 0.5.
pub fn occupancy(likelihood: &[f64]) -> Vec<f64> {
    let mut half_power = 1.0;
    let weights: Vec<f64> = likelihood
        .iter()
        .map(|g| {
            half_power *= 0.5;
            half_power * g
        })
        .collect();
    occupancy_from_weights(&weights)
}

/// Occupancy of the cells of a ray as [`occupancy`] gives it, from the weights w_j = 2^-j g_j, whose common
/// scale does not matter. For long rays the weights can be formed in a scale in which they do not underflow.
pub fn occupancy_from_weights(weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    if total == 0.0 {
        return vec![0.5; weights.len()];
    }
    let mut nearer = 0.0;
    weights
        .iter()
        .map(|w| {
            let p = (w + 0.5 * nearer) / total;
            nearer += w;
            p
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    /// Eqs 1 and 2 word for word: the sum over every configuration of the other cells.
    fn brute_force(likelihood: &[f64]) -> Vec<f64> {
        let n = likelihood.len();
        let mut given_occupied = vec![0.0; n];
        let mut given_free = vec![0.0; n];
        for configuration in 0_u32..1 << n {
            let occupied = |cell: usize| configuration >> cell & 1 == 1;
            let first = (0..n).find(|&cell| occupied(cell));
            let p_r = first.map_or(0.0, |cell| likelihood[cell]);
            for i in 0..n {
                let sum = if occupied(i) { &mut given_occupied } else { &mut given_free };
                sum[i] += p_r * 0.5_f64.powi(n as i32 - 1);
            }
        }
        (0..n).map(|i| given_occupied[i] * 0.5 / (0.5 * (given_occupied[i] + given_free[i]))).collect()
    }

    proptest! {
        #[test]
        fn closed_form_equals_all_configurations(g in prop::collection::vec(0.001..1.0_f64, 1..=12)) {
            for (fast, slow) in occupancy(&g).iter().zip(brute_force(&g)) {
                prop_assert!((fast - slow).abs() < 1e-12, "{fast} {slow}");
            }
        }
    }

    #[test]
    fn figure_1_of_the_paper() {
        // r = 20, variance 5; values computed independently from the closed form (40 cells).
        let g: Vec<f64> = (1..=40).map(|j| (-(f64::from(j) - 20.0).powi(2) / 10.0).exp()).collect();
        let p = occupancy(&g);
        let at = |cell: usize| p[cell - 1];
        for (cell, expected) in [
            (12, 0.028629),
            (14, 0.136658),
            (16, 0.333614),
            (17, 0.421502),
            (18, 0.478130),
            (19, 0.503306),
            (20, 0.508414),
            (21, 0.505860),
            (22, 0.502713),
        ] {
            assert!((at(cell) - expected).abs() < 5e-7, "cell {cell}: {}", at(cell));
        }
        assert!(at(1) < 1e-9 && (at(40) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn of_two_equal_peaks_the_first_wins() {
        let peak = |j: i32, r: i32| (-f64::from((j - r).pow(2)) / 0.5).exp();
        let g: Vec<f64> = (1..=60).map(|j| 0.5 * peak(j, 20) + 0.5 * peak(j, 40)).collect();
        let p = occupancy(&g);
        assert!(p[19] > 0.75 && (p[39] - 0.5).abs() < 1e-5, "{} {}", p[19], p[39]);
    }

    #[test]
    fn a_ray_without_likelihood_says_nothing() {
        assert_eq!(occupancy(&[0.0; 3]), [0.5; 3]);
    }
}
