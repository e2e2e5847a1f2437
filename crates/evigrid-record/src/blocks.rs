use std::ops::Range;

use evigrid_grid::GridSpec;

use crate::classes::{CellClass, TrueCells, classify};

/// Cells of a block along x, y, z. Whole columns of most grids: what changes lies along the way of the
/// camera.
const BLOCK: [usize; 3] = [20, 64, 64];

/// The voxels of one class in one block, after they have changed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Change {
    /// Which block, along x, y, z.
    pub block: [usize; 3],
    /// Which class.
    pub class: CellClass,
    /// All voxels of that class in the block now, by rising flat index.
    pub voxels: Vec<[i32; 3]>,
}

/// The classes of all cells of a map, and which blocks have changed since they were last written.
#[derive(Debug)]
pub(crate) struct Blocks {
    spec: GridSpec,
    /// Class numbers by flat index.
    numbers: Vec<u8>,
    /// New class numbers of one slab of blocks.
    slab: Vec<u8>,
}

impl Blocks {
    /// Nothing has been written.
    pub fn new(spec: GridSpec) -> Self {
        Self { spec, numbers: vec![CellClass::Unknown as u8; spec.cell_count()], slab: Vec::new() }
    }

    /// Takes the map (log-odds by flat index) as it is now. Returns what changed, block by block, and the
    /// cells along x of the slabs in which any cell changed its class.
    pub fn update(
        &mut self,
        log_odds: &[f32],
        truth: Option<TrueCells<'_>>,
    ) -> (Vec<Change>, Vec<Range<usize>>) {
        let [nx, ny, nz] = self.spec.shape();
        let (mut changes, mut slabs) = (Vec::new(), Vec::new());
        for (bi, from) in (0..nx).step_by(BLOCK[0]).enumerate() {
            let is = from..(from + BLOCK[0]).min(nx);
            let cells = is.start * ny * nz..is.end * ny * nz;
            classify(&log_odds[cells.clone()], truth.map(|t| t.part(cells.clone())), &mut self.slab);
            if self.slab == self.numbers[cells.clone()] {
                continue;
            }
            for bj in 0..ny.div_ceil(BLOCK[1]) {
                for bk in 0..nz.div_ceil(BLOCK[2]) {
                    self.update_block([bi, bj, bk], cells.start, &mut changes);
                }
            }
            slabs.push(is);
        }
        (changes, slabs)
    }

    /// Class numbers of all cells, by flat index.
    pub fn numbers(&self) -> &[u8] {
        &self.numbers
    }

    /// Copies a block from the slab, which begins at flat index `slab_start`.
    fn update_block(&mut self, block: [usize; 3], slab_start: usize, changes: &mut Vec<Change>) {
        let mut changed = 0_u8;
        for (_, _, run) in self.runs(block) {
            let new = &self.slab[run.start - slab_start..run.end - slab_start];
            let old = &mut self.numbers[run];
            if old != new {
                changed |= changed_classes(old, new);
                old.copy_from_slice(new);
            }
        }
        for class in CellClass::DRAWN {
            if changed & bit(class as u8) != 0 {
                changes.push(Change { block, class, voxels: self.voxels(block, class) });
            }
        }
    }

    fn voxels(&self, block: [usize; 3], class: CellClass) -> Vec<[i32; 3]> {
        let first_k = (block[2] * BLOCK[2]) as i32;
        let mut voxels = Vec::new();
        for (i, j, run) in self.runs(block) {
            for (k, &number) in (first_k..).zip(&self.numbers[run]) {
                if number == class as u8 {
                    voxels.push([i as i32, j as i32, k]);
                }
            }
        }
        voxels
    }

    /// The runs of cells along z that make up a block: i, j and the flat indices.
    fn runs(&self, block: [usize; 3]) -> impl Iterator<Item = (usize, usize, Range<usize>)> + use<> {
        let shape = self.spec.shape();
        let [is, js, ks] = std::array::from_fn(|a| {
            let first = block[a] * BLOCK[a];
            first..(first + BLOCK[a]).min(shape[a])
        });
        is.flat_map(move |i| js.clone().map(move |j| (i, j))).map(move |(i, j)| {
            let row = (i * shape[1] + j) * shape[2];
            (i, j, row + ks.start..row + ks.end)
        })
    }
}

/// One bit per class number.
fn bit(number: u8) -> u8 {
    1 << number
}

/// The classes that lost or won a cell.
fn changed_classes(old: &[u8], new: &[u8]) -> u8 {
    let differ = old.iter().zip(new).filter(|(a, b)| a != b);
    differ.fold(0, |changed, (&a, &b)| changed | bit(a) | bit(b))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use CellClass::{Hit, Missed, Mistake, Occupied};
    use evigrid_grid::GridSettings;

    /// 3 x 2 x 1 blocks, the last ones of one cell along x and six along y.
    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 41.0], y_m: [0.0, 70.0], z_m: [0.0, 3.0], cell_size_m: 1.0 };
        GridSpec::new(&settings).unwrap()
    }

    /// A map and a laser that saw everything, by the cells in which they are not free.
    fn update(blocks: &mut Blocks, map: &[[i64; 3]], laser: &[[i64; 3]]) -> (Vec<Change>, Vec<Range<usize>>) {
        let mut log_odds = vec![-1.0; spec().cell_count()];
        let mut occupied = vec![false; spec().cell_count()];
        map.iter().for_each(|c| log_odds[spec().flat(*c).unwrap()] = 1.0);
        laser.iter().for_each(|c| occupied[spec().flat(*c).unwrap()] = true);
        let observed = vec![true; spec().cell_count()];
        blocks.update(&log_odds, Some(TrueCells { occupied: &occupied, observed: &observed }))
    }

    fn change(block: [usize; 3], class: CellClass, voxels: &[[i32; 3]]) -> Change {
        Change { block, class, voxels: voxels.to_vec() }
    }

    #[test]
    fn blocks_are_written_only_when_they_change() {
        let mut blocks = Blocks::new(spec());
        let map = [[0, 0, 2], [0, 0, 0], [0, 1, 1]];
        let laser = [[0, 0, 0], [0, 0, 2], [40, 69, 2]];
        let (changes, slabs) = update(&mut blocks, &map, &laser);
        let expected = [
            change([0, 0, 0], Hit, &[[0, 0, 0], [0, 0, 2]]),
            change([0, 0, 0], Mistake, &[[0, 1, 1]]),
            change([2, 1, 0], Missed, &[[40, 69, 2]]),
        ];
        assert_eq!(changes, expected);
        assert_eq!(slabs, [0..20, 20..40, 40..41], "free space changes the view from above");
        assert_eq!(update(&mut blocks, &map, &laser), (vec![], vec![]));
    }

    #[test]
    fn a_class_that_loses_its_last_cell_is_written_empty() {
        let mut blocks = Blocks::new(spec());
        update(&mut blocks, &[[19, 0, 0], [20, 0, 0], [21, 0, 0]], &[]);
        let (changes, slabs) = update(&mut blocks, &[[19, 0, 0], [20, 0, 0]], &[[19, 0, 0]]);
        let expected = [
            change([0, 0, 0], Hit, &[[19, 0, 0]]),
            change([0, 0, 0], Mistake, &[]),
            change([1, 0, 0], Mistake, &[[20, 0, 0]]),
        ];
        assert_eq!((changes.as_slice(), slabs), (&expected[..], vec![0..20, 20..40]));
    }

    #[test]
    fn the_first_scan_turns_occupied_cells_into_hits_and_mistakes() {
        let mut blocks = Blocks::new(spec());
        let mut log_odds = vec![f32::NAN; spec().cell_count()];
        log_odds[0] = 1.0;
        let (changes, slabs) = blocks.update(&log_odds, None);
        assert_eq!(changes, [change([0, 0, 0], Occupied, &[[0, 0, 0]])]);
        assert_eq!((slabs.len(), &slabs[0]), (1, &(0..20)));
        let (changes, _) = update(&mut blocks, &[[0, 0, 0]], &[[0, 0, 0]]);
        let expected = [change([0, 0, 0], Occupied, &[]), change([0, 0, 0], Hit, &[[0, 0, 0]])];
        assert_eq!(changes, expected);
    }
}
