//! The Gaussian filter that is constant in the u-disparity plane (Perrollaz et al. 2012, 5.2.1).

use rayon::prelude::*;

/// A separable Gaussian, cut at three standard deviations; at borders the weights that are left sum to 1.
#[derive(Debug, Clone)]
pub struct Smoother {
    along_columns: Vec<f32>,
    along_disparities: Vec<f32>,
    /// 1 over the sum of the weights within the grid, by column.
    column_scale: Vec<f32>,
    between: Vec<f32>,
    smooth: Vec<f32>,
}

impl Smoother {
    /// Standard deviations along columns and disparities, pixels; 0 leaves the grid as it is along that axis.
    pub fn new(sigma_u_px: f64, sigma_d_px: f64, columns: usize) -> Self {
        let along_columns = half_kernel(sigma_u_px);
        let column_scale = (0..columns).map(|u| 1.0 / weight_within(&along_columns, u, columns)).collect();
        let (between, smooth) = (Vec::new(), Vec::new());
        Self { along_columns, along_disparities: half_kernel(sigma_d_px), column_scale, between, smooth }
    }

    /// The smoothed grid: rows of `columns` cells, as many as `grid` has.
    pub fn run(&mut self, grid: &[f32]) -> &[f32] {
        let columns = self.column_scale.len();
        let disparities = grid.len() / columns.max(1);
        self.between.resize(grid.len(), 0.0);
        self.smooth.resize(grid.len(), 0.0);
        let (kernel, scale) = (&self.along_columns, &self.column_scale);
        let rows = self.between.par_chunks_exact_mut(columns).zip(grid.par_chunks_exact(columns));
        rows.with_min_len(16).for_each(|(to, from)| along_columns(from, kernel, scale, to));
        let (between, kernel) = (&self.between, &self.along_disparities);
        let rows = self.smooth.par_chunks_exact_mut(columns).enumerate();
        rows.with_min_len(16).for_each(|(d, to)| {
            let scale = 1.0 / weight_within(kernel, d, disparities);
            to.fill(0.0);
            let reach = kernel.len() - 1;
            for other in d.saturating_sub(reach)..=(d + reach).min(disparities - 1) {
                let weight = scale * kernel[other.abs_diff(d)];
                let from = &between[other * columns..(other + 1) * columns];
                to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
            }
        });
        &self.smooth
    }
}

fn along_columns(from: &[f32], kernel: &[f32], scale: &[f32], to: &mut [f32]) {
    let n = from.len();
    to.iter_mut().zip(from).for_each(|(to, from)| *to = kernel[0] * from);
    for (k, &weight) in kernel.iter().enumerate().skip(1).take(n.saturating_sub(1)) {
        let (left, right) = (&from[..n - k], &from[k..]);
        to[k..].iter_mut().zip(left).for_each(|(to, from)| *to += weight * from);
        to[..n - k].iter_mut().zip(right).for_each(|(to, from)| *to += weight * from);
    }
    to.iter_mut().zip(scale).for_each(|(to, scale)| *to *= scale);
}

/// Weights of the distances 0, 1, ... up to three standard deviations.
fn half_kernel(sigma_px: f64) -> Vec<f32> {
    if sigma_px == 0.0 {
        return vec![1.0];
    }
    let reach = (3.0 * sigma_px).floor() as usize;
    let weights = (0..=reach).map(|k| (-0.5 * (k as f64 / sigma_px).powi(2)).exp());
    let weights: Vec<f64> = weights.collect();
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.into_iter().map(|weight| (weight / sum) as f32).collect()
}

/// Sum of the weights around place `at` that lie within `0..n`.
fn weight_within(kernel: &[f32], at: usize, n: usize) -> f32 {
    let below = &kernel[1..kernel.len().min(at + 1)];
    let above = &kernel[1..kernel.len().min(n - at)];
    kernel[0] + below.iter().sum::<f32>() + above.iter().sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two-dimensional sums over all cells within three standard deviations along each axis.
    #[test]
    fn smoothing_is_that_of_the_definition() {
        for (sigma_u, sigma_d) in [(1.3, 0.5), (3.5, 1.0), (0.0, 0.5), (20.0, 0.0)] {
            let (columns, rows) = (23, 7);
            let grid: Vec<f32> = (0..columns * rows).map(|n| ((n * 37) % 101) as f32 / 101.0).collect();
            let mut smoother = Smoother::new(sigma_u, sigma_d, columns);
            let smooth = smoother.run(&grid).to_vec();
            let weight = |k: f64, sigma: f64| match sigma {
                0.0 => f64::from(k == 0.0),
                _ if k.abs() > 3.0 * sigma => 0.0,
                _ => (-0.5 * k * k / sigma / sigma).exp(),
            };
            for (u, d) in (0..columns).flat_map(|u| (0..rows).map(move |d| (u, d))) {
                let (mut sum, mut weights) = (0.0, 0.0);
                for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
                    let w = weight(i as f64 - u as f64, sigma_u) * weight(j as f64 - d as f64, sigma_d);
                    sum += w * f64::from(grid[j * columns + i]);
                    weights += w;
                }
                assert!((f64::from(smooth[d * columns + u]) - sum / weights).abs() < 1e-5, "{u} {d}");
            }
        }
    }
}
