//! From three dimensions to the ground plan.

use std::ops::Range;

use crate::{GridSpec, LogOddsGrid, PlanGrid, probability};

/// The levels of voxels whose centres lie in a band of heights, [from, to) in metres of the map frame.
pub fn levels_in_band(spec: &GridSpec, band_m: [f64; 2]) -> Range<usize> {
    let (bottom, c, nz) = (spec.origin_m()[2], spec.cell_size_m(), spec.shape()[2]);
    let centre = |k: usize| bottom + (k as f64 + 0.5) * c;
    let first_from = |height: f64| (0..nz).position(|k| centre(k) >= height).unwrap_or(nz);
    let (from, to) = (first_from(band_m[0]), first_from(band_m[1]));
    from..to.max(from)
}

/// The plan of a map: per column the largest probability of its voxels in these levels, NaN where none was
/// touched. One occupied voxel makes a column occupied, and a column is free as far as it was seen.
pub fn projected(map: &LogOddsGrid, levels: Range<usize>) -> PlanGrid {
    let mut plan = PlanGrid::unknown(map.spec().plan());
    let nz = map.spec().shape()[2];
    for (p, column) in plan.probabilities_mut().iter_mut().zip(map.values().chunks_exact(nz)) {
        // The largest of a column; a number where the other is NaN.
        let largest = column[levels.clone()].iter().copied().fold(f32::NAN, f32::max);
        *p = probability(f64::from(largest)) as f32;
    }
    plan
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::GridSettings;

    #[test]
    fn a_column_has_the_largest_probability_of_its_band() {
        let settings = GridSettings { x_m: [0.0, 3.0], y_m: [0.0, 1.0], z_m: [-1.0, 1.0], cell_size_m: 0.5 };
        let spec = GridSpec::new(&settings).unwrap();
        // Centres at -0.75, -0.25, 0.25, 0.75.
        assert_eq!(levels_in_band(&spec, [-0.25, 0.75]), 1..3);
        assert_eq!(levels_in_band(&spec, [-9.0, 9.0]), 0..4);
        assert_eq!(levels_in_band(&spec, [2.0, 3.0]), 4..4);
        assert_eq!(levels_in_band(&spec, [0.5, -0.5]), 3..3);
        let mut map = LogOddsGrid::unknown(spec);
        let columns: [[f32; 4]; 2] = [[9.0, -1.0, f32::NAN, 9.0], [f32::NAN, -2.0, 1.0, -9.0]];
        map.values_mut()[..4].copy_from_slice(&columns[0]);
        map.values_mut()[4..8].copy_from_slice(&columns[1]);
        let plan = projected(&map, 1..3);
        let expected = [-1.0, 1.0].map(|l: f64| probability(l) as f32);
        assert_eq!(plan.probabilities()[..2], expected);
        // The last column of the row in front was never touched, whatever lies outside of the band.
        assert!(plan.probabilities()[2].is_nan());
    }
}
