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
        /// Memory that they would take at 24 bytes a cell.
        gib: f64,
        /// The limit.
        max_cells: usize,
    },
}

/// A box of square or cubic cells aligned with the map frame, in `D` dimensions. The cell with index (i, j,
/// ...) covers `origin + [i, i+1) x [j, j+1) ...` cells; flat indices run along the last axis first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice<const D: usize> {
    origin_m: [f64; D],
    cell_size_m: f64,
    shape: [usize; D],
}

/// Voxels: the flat index of (i, j, k) is `(i * ny + j) * nz + k`.
pub type GridSpec = Lattice<3>;

/// Cells of a ground plan: the flat index of (i, j) is `i * ny + j`.
pub type PlanSpec = Lattice<2>;

impl<const D: usize> Lattice<D> {
    /// The most cells a grid may have: 12 GiB at 24 bytes a cell (8 for a map and its evidence, 10 for the
    /// reference, the rest for tables and pictures of it).
    pub const MAX_CELLS: usize = 1 << 29;

    /// The grid that covers a box, given by its extents per axis [from, to] in metres; a last partial cell
    /// counts as a whole one.
    fn covering(extents: [(char, [f64; 2]); D], cell_size_m: f64) -> Result<Self, GridError> {
        let c = cell_size_m;
        if !(c.is_finite() && c > 0.0) {
            return Err(GridError::CellSize(c));
        }
        let mut cells = [0.0; D];
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
        let origin_m = extents.map(|(_, [from, _])| from);
        Ok(Self { origin_m, cell_size_m: c, shape: cells.map(|n| n as usize) })
    }

    /// Lower corner of the first cell, metres.
    pub fn origin_m(&self) -> [f64; D] {
        self.origin_m
    }

    /// Edge of a cell, metres.
    pub fn cell_size_m(&self) -> f64 {
        self.cell_size_m
    }

    /// Cells along each axis.
    pub fn shape(&self) -> [usize; D] {
        self.shape
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.shape.iter().product()
    }

    /// Distance between flat indices of neighbours along each axis.
    #[inline]
    pub fn strides(&self) -> [usize; D] {
        let mut strides = [1; D];
        for a in (1..D).rev() {
            strides[a - 1] = strides[a] * self.shape[a];
        }
        strides
    }

    /// A point of the map frame in units of cells from the grid's lower corner. May lie outside the grid.
    #[inline]
    pub fn to_cells(&self, point_m: [f64; D]) -> [f64; D] {
        std::array::from_fn(|a| (point_m[a] - self.origin_m[a]) / self.cell_size_m)
    }

    /// The same grid, moved by whole cells along each axis.
    #[must_use]
    pub fn moved(&self, cells: [i64; D]) -> Self {
        let origin_m = std::array::from_fn(|a| self.origin_m[a] + cells[a] as f64 * self.cell_size_m);
        Self { origin_m, ..*self }
    }

    /// Flat index of the cell with these indices; `None` outside the grid.
    #[inline]
    pub fn flat(&self, cell: [i64; D]) -> Option<usize> {
        let mut flat = 0;
        for (&v, &n) in cell.iter().zip(&self.shape) {
            let v = usize::try_from(v).ok().filter(|&v| v < n)?;
            flat = flat * n + v;
        }
        Some(flat)
    }

    /// Indices of the cell with this flat index.
    #[inline]
    pub fn cell(&self, flat: usize) -> [usize; D] {
        let mut rest = flat;
        let mut cell = [0; D];
        for a in (0..D).rev() {
            cell[a] = if a == 0 { rest } else { rest % self.shape[a] };
            rest /= self.shape[a];
        }
        cell
    }

    /// Flat index of the cell that holds a point of the map frame; `None` outside the grid.
    pub fn cell_of(&self, point_m: [f64; D]) -> Option<usize> {
        self.flat(self.to_cells(point_m).map(|v| v.floor() as i64))
    }

    /// Centre of the cell with this flat index, metres.
    pub fn centre_m(&self, flat: usize) -> [f64; D] {
        let cell = self.cell(flat);
        std::array::from_fn(|a| self.origin_m[a] + (cell[a] as f64 + 0.5) * self.cell_size_m)
    }
}

impl Lattice<3> {
    /// The voxels that cover the box of the settings; a last partial cell counts as a whole one.
    ///
    /// # Errors
    /// If the cell size or an extent is not positive, or the grid would have more than [`Self::MAX_CELLS`]
    /// cells.
    pub fn new(settings: &GridSettings) -> Result<Self, GridError> {
        let extents = [('x', settings.x_m), ('y', settings.y_m), ('z', settings.z_m)];
        Self::covering(extents, settings.cell_size_m)
    }

    /// The same voxels, raised by a length in metres.
    #[must_use]
    pub fn raised(&self, by_m: f64) -> Self {
        let [x, y, z] = self.origin_m;
        Self { origin_m: [x, y, z + by_m], ..*self }
    }

    /// Indices (i, j, k) of the voxel with this flat index.
    #[inline]
    pub fn voxel(&self, flat: usize) -> [usize; 3] {
        let [_, ny, nz] = self.shape;
        [flat / (ny * nz), flat / nz % ny, flat % nz]
    }

    /// The ground plan of these voxels: one cell per column. The column of flat index n is the voxels
    /// `n * nz .. (n + 1) * nz`.
    pub fn plan(&self) -> PlanSpec {
        let ([x, y, _], [nx, ny, _]) = (self.origin_m, self.shape);
        Lattice { origin_m: [x, y], cell_size_m: self.cell_size_m, shape: [nx, ny] }
    }
}

impl Lattice<2> {
    /// The plan that covers a rectangle, [from, to] along x and y in metres.
    ///
    /// # Errors
    /// As [`GridSpec::new`].
    pub fn of_area(x_m: [f64; 2], y_m: [f64; 2], cell_size_m: f64) -> Result<Self, GridError> {
        Self::covering([('x', x_m), ('y', y_m)], cell_size_m)
    }
}

/// The index of the cell that holds a coordinate in units of cells: the largest whole number that is not
/// above it, within the range of i32, which is more than any grid has. Where the target has no rounding
/// instruction, this takes a third of the time of `f64::floor`.
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

    /// Indices found by counting, in two and in three dimensions.
    #[test]
    fn flat_indices_count_the_last_axis_first() {
        let settings = GridSettings { x_m: [0.0, 2.0], y_m: [0.0, 3.0], z_m: [0.0, 4.0], cell_size_m: 1.0 };
        let spec = GridSpec::new(&settings).unwrap();
        let plan = spec.plan();
        assert_eq!((spec.strides(), plan.strides()), ([12, 4, 1], [3, 1]));
        let mut flat = 0;
        for i in 0..2 {
            for j in 0..3 {
                assert_eq!(plan.cell(flat / 4), [i, j]);
                assert_eq!(plan.flat([i as i64, j as i64]), Some(flat / 4));
                assert_eq!(plan.centre_m(flat / 4), [i as f64 + 0.5, j as f64 + 0.5]);
                for k in 0..4 {
                    assert_eq!((spec.cell(flat), spec.voxel(flat)), ([i, j, k], [i, j, k]));
                    flat += 1;
                }
            }
        }
        assert_eq!(plan.cell_of([1.5, 2.5]), Some(5));
        assert!(PlanSpec::of_area([0.0, 1.0], [1.0, 1.0], 0.1).is_err());
        assert_eq!(PlanSpec::of_area([-1.0, 1.0], [0.0, 3.0], 0.5).unwrap().shape(), [4, 6]);
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
