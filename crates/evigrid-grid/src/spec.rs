use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the voxel grid lies in the map frame (x forward, y left, z up from the first used left camera).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GridSettings {
    /// From and to, forward. Unit: m. Source: Brandao et al. IV-B (160 m).
    pub x_m: [f64; 2],
    /// From and to, to the left. Unit: m. Source: Brandao et al. IV-B (10 m).
    pub y_m: [f64; 2],
    /// From and to, upwards. Unit: m. Source: Brandao et al. IV-B (4 m).
    pub z_m: [f64; 2],
    /// Edge of a voxel. Unit: m. Source: Brandao et al. IV-B (20 cm).
    pub cell_size_m: f64,
}

impl Default for GridSettings {
    fn default() -> Self {
        Self { x_m: [0.0, 160.0], y_m: [-5.0, 5.0], z_m: [-2.0, 2.0], cell_size_m: 0.2 }
    }
}

/// Why a grid could not be laid out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A cell size that is no length.
    #[error("grid.cell_size_m: expected a positive number of metres, found {0}")]
    CellSize(f64),
    /// An empty or infinite extent.
    #[error("grid.{axis}_m: expected two finite numbers [from, to] with from < to, found [{from}, {to}]")]
    Extent {
        /// x, y or z.
        axis: char,
        /// Lower bound, metres.
        from: f64,
        /// Upper bound, metres.
        to: f64,
    },
    /// More cells than a map may have.
    #[error(
        "grid: expected at most {max_cells} cells, found {cells:.3e} ({gib:.3e} GiB): use larger cells or a smaller grid"
    )]
    TooLarge {
        /// The cells asked for.
        cells: f64,
        /// What they would take at 24 bytes a cell.
        gib: f64,
        /// The limit.
        max_cells: usize,
    },
}

/// A box of cubic voxels aligned with the map frame. Voxel (i, j, k) covers
/// `origin + [i, i+1) x [j, j+1) x [k, k+1)` cells; its flat index is `(i * ny + j) * nz + k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSpec {
    origin_m: [f64; 3],
    cell_size_m: f64,
    shape: [usize; 3],
}

impl GridSpec {
    /// The most cells a grid may have: 12 GiB at 24 bytes a cell (8 for a map and its evidence, 10 for the reference,
    /// the rest for what looks at them).
    pub const MAX_CELLS: usize = 1 << 29;

    /// The grid that covers the box of the settings; a last partial cell counts as a whole one.
    ///
    /// # Errors
    /// If the cell size or an extent is not positive, or the grid would have more than [`Self::MAX_CELLS`] cells.
    pub fn new(settings: &GridSettings) -> Result<Self, GridError> {
        let c = settings.cell_size_m;
        if !(c.is_finite() && c > 0.0) {
            return Err(GridError::CellSize(c));
        }
        let mut cells = [0.0; 3];
        let extents = [('x', settings.x_m), ('y', settings.y_m), ('z', settings.z_m)];
        for (n, (axis, [from, to])) in cells.iter_mut().zip(extents) {
            if !(from.is_finite() && to.is_finite() && from < to) {
                return Err(GridError::Extent { axis, from, to });
            }
            // 10 m in cells of 0.2 m are 50 cells, whatever the last bit of the quotient says.
            *n = ((to - from) / c - 1e-6).ceil().max(1.0);
        }
        let total: f64 = cells.iter().product();
        if total > Self::MAX_CELLS as f64 {
            let gib = total * 24.0 / f64::from(1 << 30);
            return Err(GridError::TooLarge { cells: total, gib, max_cells: Self::MAX_CELLS });
        }
        let origin_m = [settings.x_m[0], settings.y_m[0], settings.z_m[0]];
        Ok(Self { origin_m, cell_size_m: c, shape: cells.map(|n| n as usize) })
    }

    /// Lower corner of voxel (0, 0, 0), metres.
    pub fn origin_m(&self) -> [f64; 3] {
        self.origin_m
    }

    /// Edge of a voxel, metres.
    pub fn cell_size_m(&self) -> f64 {
        self.cell_size_m
    }

    /// Voxels along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Number of voxels.
    pub fn cell_count(&self) -> usize {
        self.shape.iter().product()
    }

    /// Distance between flat indices of neighbours along x, y, z.
    pub fn strides(&self) -> [usize; 3] {
        [self.shape[1] * self.shape[2], self.shape[2], 1]
    }

    /// A point of the map frame in units of cells from the grid's lower corner. May lie outside the grid.
    pub fn to_cells(&self, point_m: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| (point_m[a] - self.origin_m[a]) / self.cell_size_m)
    }

    /// Flat index of the voxel with these indices; `None` outside the grid.
    pub fn flat(&self, voxel: [i64; 3]) -> Option<usize> {
        let mut flat = 0;
        for (&v, &n) in voxel.iter().zip(&self.shape) {
            let v = usize::try_from(v).ok().filter(|&v| v < n)?;
            flat = flat * n + v;
        }
        Some(flat)
    }

    /// Indices (i, j, k) of the voxel with this flat index.
    pub fn voxel(&self, flat: usize) -> [usize; 3] {
        let [_, ny, nz] = self.shape;
        [flat / (ny * nz), flat / nz % ny, flat % nz]
    }

    /// Flat index of the voxel that holds a point of the map frame; `None` outside the grid.
    pub fn cell_of(&self, point_m: [f64; 3]) -> Option<usize> {
        self.flat(self.to_cells(point_m).map(|v| v.floor() as i64))
    }

    /// Centre of the voxel with this flat index, metres.
    pub fn centre_m(&self, flat: usize) -> [f64; 3] {
        let voxel = self.voxel(flat);
        std::array::from_fn(|a| self.origin_m[a] + (voxel[a] as f64 + 0.5) * self.cell_size_m)
    }
}

/// The index of the cell that holds a coordinate in units of cells: the largest whole number that is not above it, within
/// the range of i32, which is more than any grid has. Where the target has no rounding instruction, this takes a third
/// of the time of `f64::floor`.
#[inline]
pub fn cell_index(coordinate: f64) -> i64 {
    let towards_zero = coordinate as i32;
    i64::from(towards_zero) - i64::from(f64::from(towards_zero) > coordinate)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_grid_of_the_paper_has_800_000_cells() {
        let spec = GridSpec::new(&GridSettings::default()).unwrap();
        assert_eq!(spec.shape(), [800, 50, 20]);
        assert_eq!(spec.cell_count(), 800_000);
    }

    #[test]
    fn flat_indices_invert() {
        let spec = GridSpec::new(&GridSettings { x_m: [-1.0, 1.0], ..GridSettings::default() }).unwrap();
        for flat in [0, 1, 19, 20, 999, 9_999] {
            let voxel = spec.voxel(flat);
            assert_eq!(spec.flat(voxel.map(|v| v as i64)), Some(flat));
            assert_eq!(spec.cell_of(spec.centre_m(flat)), Some(flat));
        }
        assert_eq!(spec.flat([-1, 0, 0]), None);
        assert_eq!(spec.flat([0, 50, 0]), None);
        // Voxel (i, j, k) covers origin + [i c, (i+1) c): its lower corner belongs to it.
        assert_eq!(spec.cell_of([-1.0, -5.0, -2.0]), Some(0));
        assert_eq!(spec.cell_of([-1.0001, -5.0, -2.0]), None);
    }

    #[test]
    fn impossible_grids_are_refused_with_the_value() {
        let refuse = |settings: GridSettings| GridSpec::new(&settings).unwrap_err().to_string();
        let base = GridSettings::default();
        assert!(refuse(GridSettings { cell_size_m: 0.0, ..base }).ends_with("found 0"));
        assert!(refuse(GridSettings { cell_size_m: f64::NAN, ..base }).ends_with("found NaN"));
        assert!(refuse(GridSettings { y_m: [5.0, -5.0], ..base }).contains("grid.y_m"));
        let huge = refuse(GridSettings { cell_size_m: 0.001, ..base });
        assert!(huge.contains("6.400e12") && huge.contains("GiB"), "{huge}");
    }
}
