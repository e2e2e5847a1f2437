use evigrid_grid::LogOddsGrid;

/// One level of cells of a map, parallel to the ground (Souza et al. 2012, Fig. 7).
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Cells along x and y.
    pub shape: [usize; 2],
    /// Log-odds, y fastest; NaN = never touched.
    pub log_odds: Vec<f32>,
}

/// The level of a map that holds a height (z of the map frame, metres), for Souza's Fig. 7 that of the
/// optical centre. `None` if the map does not reach it.
pub fn horizontal_slice(map: &LogOddsGrid, height_m: f64) -> Option<Slice> {
    let [nx, ny, levels] = map.spec().shape();
    let level = level_of(map, height_m)?;
    let log_odds = map.values().iter().skip(level).step_by(levels).copied().collect();
    Some(Slice { shape: [nx, ny], log_odds })
}

/// The index along z of the cells that hold a height.
pub(crate) fn level_of(map: &LogOddsGrid, height_m: f64) -> Option<usize> {
    let [_, _, z] = map.spec().to_cells([0.0, 0.0, height_m]);
    (z >= 0.0 && z < map.spec().shape()[2] as f64).then_some(z as usize)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::{GridSettings, GridSpec};

    #[test]
    fn a_slice_is_one_level() {
        let settings = GridSettings { x_m: [0.0, 3.0], y_m: [0.0, 2.0], z_m: [-1.0, 1.0], cell_size_m: 0.5 };
        let mut map = LogOddsGrid::unknown(GridSpec::new(&settings).unwrap());
        for flat in 0..map.spec().cell_count() {
            map.values_mut()[flat] = map.spec().voxel(flat)[2] as f32;
        }
        let slice = horizontal_slice(&map, 0.1).unwrap();
        assert_eq!((slice.shape, slice.log_odds), ([6, 4], vec![2.0; 24]));
        assert_eq!(horizontal_slice(&map, 1.0), None);
        assert_eq!(horizontal_slice(&map, -1.01), None);
        assert_eq!(horizontal_slice(&map, f64::NAN), None);
    }
}
