use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, bail};
use evigrid_grid::{GridSpec, Lattice, LogOddsGrid};
use evigrid_metrics::VoxelReference;

use crate::npz::{Npz, NpzWriter};
use crate::{PendingFile, SealedFile};

/// A sparse voxel map as it stands in a file, from any mapper. Voxel (i, j, k) covers
/// `origin + [i, i+1) x [j, j+1) x [k, k+1)` cells.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFile {
    /// Voxel indices.
    pub indices: Vec<[i64; 3]>,
    /// Log-odds of each voxel.
    pub log_odds: Vec<f32>,
    /// Corner of voxel (0, 0, 0) in the map frame, metres.
    pub origin_m: [f64; 3],
    /// Edge of a voxel, metres.
    pub cell_size_m: f64,
}

/// Writes a map as npz: `indices` int32 [N,3], `log_odds` float32 [N], `origin` float64 [3] (metres),
/// `cell_size` float64 (metres). Cells that were never touched are left out.
///
/// # Errors
/// If the file cannot be written.
pub fn write_map(file: PendingFile, map: &LogOddsGrid) -> Result<SealedFile> {
    let (cells, log_odds): (Vec<usize>, Vec<f32>) = map.touched().unzip();
    let mut npz = NpzWriter::default();
    write_indices(&mut npz, "indices", map.spec(), &cells)?;
    npz.array("log_odds", &[log_odds.len() as u64], &log_odds)?;
    write_geometry(&mut npz, map.spec())?;
    write_npz(file, npz)
}

/// Writes true voxels as npz: `occupied`, `observed` int32 [N,3], `origin`, `cell_size`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_truth(file: PendingFile, truth: &VoxelReference<'_>) -> Result<SealedFile> {
    let marked = |cells: &[bool]| (0..cells.len()).filter(|&i| cells[i]).collect::<Vec<_>>();
    let mut npz = NpzWriter::default();
    write_indices(&mut npz, "occupied", truth.spec, &marked(truth.occupied))?;
    write_indices(&mut npz, "observed", truth.spec, &marked(truth.observed))?;
    write_geometry(&mut npz, truth.spec)?;
    write_npz(file, npz)
}

fn write_indices(npz: &mut NpzWriter, name: &str, spec: &GridSpec, cells: &[usize]) -> Result<()> {
    let indices: Vec<i32> = cells.iter().flat_map(|&flat| spec.voxel(flat).map(|v| v as i32)).collect();
    Ok(npz.array(name, &[cells.len() as u64, 3], &indices)?)
}

/// Adds the arrays `origin` and `cell_size`.
pub(crate) fn write_geometry<const D: usize>(npz: &mut NpzWriter, spec: &Lattice<D>) -> Result<()> {
    npz.array("origin", &[D as u64], &spec.origin_m())?;
    Ok(npz.array("cell_size", &[], &[spec.cell_size_m()])?)
}

/// Writes a complete npz to a file and ends it.
pub(crate) fn write_npz(mut file: PendingFile, npz: NpzWriter) -> Result<SealedFile> {
    file.write_all(&npz.finish()?).with_context(|| file.failed())?;
    file.seal()
}

/// Reads a map that any mapper wrote, in the format of [`write_map`]; any integer and float types will do.
///
/// # Errors
/// If the file cannot be read, lacks an array, or one has another shape or type.
pub fn read_map(path: &Path) -> Result<MapFile> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read the map {}", path.display()))?;
    parse_map(&bytes).with_context(|| format!("map {}", path.display()))
}

fn parse_map(bytes: &[u8]) -> Result<MapFile> {
    let mut npz = Npz::new(bytes)?;
    let indices = npz.array("indices")?;
    let &[n, 3] = &indices.shape[..] else {
        bail!("indices: expected shape [N, 3], found {:?}", indices.shape);
    };
    if !indices.is_integer {
        bail!("indices: expected integers, found floats");
    }
    let log_odds = npz.array("log_odds")?;
    if log_odds.shape != [n] {
        bail!("log_odds: expected shape [{n}] like indices, found {:?}", log_odds.shape);
    }
    if let Some(i) = log_odds.values.iter().position(|v| v.is_nan()) {
        bail!("log_odds: expected numbers, found NaN at position {i}");
    }
    let origin = npz.array("origin")?;
    let &[x, y, z] = &origin.values[..] else {
        bail!("origin: expected shape [3], found {:?}", origin.shape);
    };
    let cell_size = npz.array("cell_size")?;
    let &[cell_size_m] = &cell_size.values[..] else {
        bail!("cell_size: expected one number, found shape {:?}", cell_size.shape);
    };
    if !(cell_size_m.is_finite() && cell_size_m > 0.0 && [x, y, z].iter().all(|v| v.is_finite())) {
        bail!("expected a finite origin and a positive cell_size, found [{x}, {y}, {z}] and {cell_size_m}");
    }
    let indices = indices.values.chunks_exact(3).map(|v| [v[0] as i64, v[1] as i64, v[2] as i64]).collect();
    let log_odds = log_odds.values.iter().map(|&v| v as f32).collect();
    Ok(MapFile { indices, log_odds, origin_m: [x, y, z], cell_size_m })
}

impl MapFile {
    /// The map on a grid; cells outside it are left out, and their number is returned.
    ///
    /// # Errors
    /// If the file's voxels are no voxels of the grid (another cell size, or shifted by a part of a cell), or
    /// a voxel stands in the file twice.
    pub fn onto_grid(&self, spec: &GridSpec) -> Result<(LogOddsGrid, usize)> {
        let c = spec.cell_size_m();
        if (self.cell_size_m - c).abs() > 1e-6 * c {
            bail!(
                "expected cell_size {c}, found {} (--set grid.cell_size_m={} scores on its grid)",
                self.cell_size_m,
                self.cell_size_m
            );
        }
        let cells: [f64; 3] = std::array::from_fn(|a| (self.origin_m[a] - spec.origin_m()[a]) / c);
        if cells.iter().any(|v| (v - v.round()).abs() > 1e-3) {
            bail!(
                "expected an origin that is whole cells of {c} m away from {:?}, found {:?}",
                spec.origin_m(),
                self.origin_m
            );
        }
        let shift = cells.map(|v| v.round() as i64);
        let mut grid = LogOddsGrid::unknown(*spec);
        let mut outside = 0;
        for (index, &l) in self.indices.iter().zip(&self.log_odds) {
            let Some(flat) = spec.flat(std::array::from_fn(|a| index[a].saturating_add(shift[a]))) else {
                outside += 1;
                continue;
            };
            let slot = &mut grid.values_mut()[flat];
            if !slot.is_nan() {
                bail!("indices: expected each voxel once, found {index:?} twice");
            }
            *slot = l;
        }
        Ok((grid, outside))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::GridSettings;
    use proptest::prelude::*;

    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 2.0], y_m: [-1.0, 1.0], z_m: [-0.4, 0.4], cell_size_m: 0.2 };
        GridSpec::new(&settings).unwrap()
    }

    fn map() -> LogOddsGrid {
        let mut map = LogOddsGrid::unknown(spec());
        for (flat, l) in [(0, -5.0), (17, 0.0), (30, 3.25), (spec().cell_count() - 1, 1e-9)] {
            map.values_mut()[flat] = l;
        }
        map
    }

    #[test]
    fn a_written_map_reads_back_the_same() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.npz");
        write_map(PendingFile::create(path.clone()).unwrap(), &map()).unwrap().publish().unwrap();
        let (back, outside) = read_map(&path).unwrap().onto_grid(&spec()).unwrap();
        assert_eq!(outside, 0);
        assert_eq!(back.touched().collect::<Vec<_>>(), map().touched().collect::<Vec<_>>());
    }

    #[test]
    fn a_map_on_a_shifted_grid_lands_on_the_same_voxels() {
        let file = MapFile {
            indices: vec![[0, 0, 0], [5, 5, 1], [900, 0, 0]],
            log_odds: vec![1.0, 2.0, 3.0],
            origin_m: [0.4, -0.6, 0.0],
            cell_size_m: 0.2,
        };
        let (grid, outside) = file.onto_grid(&spec()).unwrap();
        assert_eq!(outside, 1);
        let at = |i, j, k| grid.log_odds(spec().flat([i, j, k]).unwrap());
        assert_eq!((at(2, 2, 2), at(7, 7, 3)), (Some(1.0), Some(2.0)));
    }

    #[test]
    fn maps_that_do_not_fit_are_refused() {
        let file = MapFile {
            indices: vec![[0, 0, 0], [0, 0, 0]],
            log_odds: vec![1.0, 2.0],
            origin_m: [0.0, -1.0, -0.4],
            cell_size_m: 0.2,
        };
        let refuse = |file: MapFile| file.onto_grid(&spec()).unwrap_err().to_string();
        assert!(refuse(file.clone()).contains("twice"));
        assert!(refuse(MapFile { cell_size_m: 0.1, ..file.clone() }).contains("grid.cell_size_m=0.1"));
        assert!(refuse(MapFile { origin_m: [0.1, -1.0, -0.4], ..file }).contains("whole cells"));
    }

    type Arrays<'a> = (&'a [u64], &'a [i32], &'a [u64], &'a [f32], &'a [f64], &'a [f64]);

    fn npz((index_shape, indices, l_shape, l, origin, cell_size): Arrays<'_>) -> Vec<u8> {
        let mut npz = NpzWriter::default();
        npz.array("indices", index_shape, indices).unwrap();
        npz.array("log_odds", l_shape, l).unwrap();
        npz.array("origin", &[origin.len() as u64], origin).unwrap();
        npz.array("cell_size", &[cell_size.len() as u64], cell_size).unwrap();
        npz.finish().unwrap()
    }

    #[test]
    fn wrong_shapes_are_named() {
        let message = |arrays: Arrays<'_>| format!("{:#}", parse_map(&npz(arrays)).unwrap_err());
        let good: Arrays<'_> = (&[1, 3], &[1, 2, 3], &[1], &[0.5], &[0.0; 3], &[0.2]);
        assert_eq!(parse_map(&npz(good)).unwrap().indices, [[1, 2, 3]]);
        assert!(message((&[3, 1], good.1, good.2, good.3, good.4, good.5)).contains("expected shape [N, 3]"));
        assert!(message((good.0, good.1, &[2], &[0.5; 2], good.4, good.5)).contains("expected shape [1]"));
        assert!(message((good.0, good.1, good.2, &[f32::NAN], good.4, good.5)).contains("found NaN"));
        assert!(message((good.0, good.1, good.2, good.3, &[0.0; 2], good.5)).contains("origin"));
        assert!(message((good.0, good.1, good.2, good.3, good.4, &[0.0])).contains("positive cell_size"));
        assert!(format!("{:#}", parse_map(b"PK nonsense").unwrap_err()).contains("npz"));
    }

    proptest! {
        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse_map(&bytes);
            let _ = crate::npz::parse_npy(&bytes);
        }

        #[test]
        fn damaged_files_never_panic(at in 0..2000_usize, value: u8) {
            let mut bytes = npz((&[1, 3], &[1, 2, 3], &[1], &[0.5], &[0.0; 3], &[0.2]));
            let at = at % bytes.len();
            bytes[at] = value;
            let _ = parse_map(&bytes);
            let _ = parse_map(&bytes[..at]);
        }

        #[test]
        fn random_npy_headers_never_panic(
            header in "\\{'descr': '[<>|][fiuSb][0-9]{1,3}', 'fortran_order': (True|False), \
                'shape': \\([0-9]{0,20},[0-9, ]{0,12}\\), \\}",
        ) {
            let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            let _ = crate::npz::parse_npy(&bytes);
        }
    }
}
