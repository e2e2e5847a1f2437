//! What is known of voxels moves in memory when the grid moves over the ground.

use evigrid_grid::GridSpec;

/// Moves the grid by whole voxels under a value of each voxel, in place: values of voxels that stay in the grid go
/// to their new places, and new voxels get the value 0.
pub(crate) fn scroll<T: Copy + Default>(spec: &GridSpec, values: &mut [T], voxels: [i64; 3]) {
    let [nx, ny, nz] = spec.shape().map(|n| n as i64);
    let [du, dv, dw] = [0, 1, 2].map(|a| voxels[a].clamp(-[nx, ny, nz][a], [nx, ny, nz][a]));
    // Layers of a column that have been in the grid before.
    let known = (-dw).max(0) as usize..(nz - dw).min(nz) as usize;
    let mut fill = |column: i64| {
        let (u, v) = (column / ny + du, column % ny + dv);
        let start = (column * nz) as usize;
        if (0..nx).contains(&u) && (0..ny).contains(&v) {
            let from = (u * ny + v) * nz + dw;
            let from = (from + known.start as i64) as usize..(from + known.end as i64) as usize;
            values.copy_within(from, start + known.start);
            values[start..start + known.start].fill(T::default());
            values[start + known.end..start + nz as usize].fill(T::default());
        } else {
            values[start..start + nz as usize].fill(T::default());
        }
    };
    // In this order no value is overwritten before it has moved.
    if (du * ny + dv) * nz + dw > 0 {
        (0..nx * ny).for_each(fill)
    } else {
        (0..nx * ny).rev().for_each(&mut fill)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::GridSettings;
    use proptest::prelude::*;

    proptest! {
        /// Every voxel is asked where it was.
        #[test]
        fn values_of_the_twin(voxels in [-8..8_i64, -6..6_i64, -5..5_i64], far in any::<bool>()) {
            let settings = GridSettings { x_m: [0.0, 6.0], y_m: [0.0, 4.0], z_m: [0.0, 3.0], cell_size_m: 1.0 };
            let spec = GridSpec::new(&settings).unwrap();
            let voxels = if far { [voxels[0], i64::MAX, voxels[2]] } else { voxels };
            let before: Vec<u32> = (1..=spec.cell_count() as u32).collect();
            let mut after = before.clone();
            scroll(&spec, &mut after, voxels);
            for (flat, &found) in after.iter().enumerate() {
                let cell = spec.voxel(flat);
                let was = [0, 1, 2].map(|a| (cell[a] as i64).saturating_add(voxels[a]));
                prop_assert_eq!(found, spec.flat(was).map_or(0, |was| before[was]));
            }
        }
    }
}
