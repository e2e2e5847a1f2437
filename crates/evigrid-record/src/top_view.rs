use std::ops::Range;

use evigrid_grid::GridSpec;

use crate::classes::CellClass::{self, Free, Hit, Missed, Mistake, Occupied, Unknown, Unobserved};

/// The map from above as an image of class numbers: x (forward) runs to the right, y (left) upwards, one
/// pixel per column of cells.
///
/// A column shows the class that most of its occupied cells have (a mistake if there are as many hits); where
/// the map has no occupied cell, whether the laser has one; else free where any cell was touched.
#[derive(Debug)]
pub(crate) struct TopView {
    shape: [usize; 3],
    pixels: Vec<u8>,
}

impl TopView {
    /// Nothing is known.
    pub fn new(spec: &GridSpec) -> Self {
        let shape = spec.shape();
        Self { shape, pixels: vec![Unknown as u8; shape[0] * shape[1]] }
    }

    /// Draws the columns at these cells along x. `numbers` are the class numbers of all cells, by flat index.
    pub fn draw(&mut self, numbers: &[u8], is: Range<usize>) {
        let [nx, ny, nz] = self.shape;
        for i in is {
            for (j, column) in numbers[i * ny * nz..(i + 1) * ny * nz].chunks_exact(nz).enumerate() {
                self.pixels[(ny - 1 - j) * nx + i] = column_class(column) as u8;
            }
        }
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        [self.shape[0] as u32, self.shape[1] as u32]
    }

    /// Class numbers, row by row from the top.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }
}

fn column_class(numbers: &[u8]) -> CellClass {
    let mut counts = [0_usize; CellClass::ALL.len()];
    for &number in numbers {
        counts[usize::from(number)] += 1;
    }
    let count = |class: CellClass| counts[class as usize];
    // The last of equals wins.
    let most = [Occupied, Hit, Unobserved, Mistake].into_iter().max_by_key(|&c| count(c));
    let rest = [Missed, Free].into_iter().find(|&c| count(c) > 0).unwrap_or(Unknown);
    most.filter(|&c| count(c) > 0).unwrap_or(rest)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::GridSettings;

    #[test]
    fn occupied_wins_and_the_majority_decides() {
        for (cells, expected) in [
            ([Unknown, Unknown, Unknown], Unknown),
            ([Unknown, Free, Unknown], Free),
            ([Missed, Free, Unknown], Missed),
            ([Missed, Missed, Hit], Hit),
            ([Mistake, Hit, Hit], Hit),
            ([Mistake, Hit, Free], Mistake),
            ([Unobserved, Unobserved, Hit], Unobserved),
            ([Occupied, Free, Free], Occupied),
        ] {
            assert_eq!(column_class(&cells.map(|c| c as u8)), expected, "{cells:?}");
        }
    }

    #[test]
    fn forward_is_right_and_left_is_up() {
        let settings = GridSettings { x_m: [0.0, 3.0], y_m: [0.0, 2.0], z_m: [0.0, 2.0], cell_size_m: 1.0 };
        let spec = GridSpec::new(&settings).unwrap();
        let mut numbers = vec![Unknown as u8; spec.cell_count()];
        let (hit, missed) = (Hit as u8, Missed as u8);
        numbers[spec.flat([2, 0, 1]).unwrap()] = hit;
        numbers[spec.flat([0, 1, 0]).unwrap()] = missed;
        let mut view = TopView::new(&spec);
        view.draw(&numbers, 1..3);
        assert_eq!(view.pixels(), [0, 0, 0, 0, 0, hit], "only the columns that were asked for");
        view.draw(&numbers, 0..1);
        assert_eq!((view.pixels(), view.size()), (&[missed, 0, 0, 0, 0, hit][..], [3, 2]));
    }
}
