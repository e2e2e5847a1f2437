//! How far each pixel sees nothing but free space.

use rayon::prelude::*;

/// Pixels along the edge of a tile.
pub(crate) const TILE: usize = 8;
/// The reach of a pixel without a believable match: its ray says nothing.
pub(crate) const NO_REACH: i32 = i32::MIN;

/// Per pixel the number of steps from the camera's cell up to which the cells of its ray are simply free, and the
/// largest reach of every tile of 8 x 8 pixels.
#[derive(Debug, Default)]
pub(crate) struct ReachImage {
    width: usize,
    height: usize,
    pixels: Vec<i32>,
    tiles: Vec<i32>,
}

impl ReachImage {
    /// Sets every pixel; `fill(y, row)` is called once for every row, from any thread.
    pub fn fill(&mut self, width: usize, height: usize, fill: impl Fn(usize, &mut [i32]) + Sync) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width * height, NO_REACH);
        self.tiles.resize(width.div_ceil(TILE) * height.div_ceil(TILE), NO_REACH);
        let bands = self.pixels.par_chunks_mut(TILE * width);
        let tile_rows = self.tiles.par_chunks_mut(width.div_ceil(TILE));
        bands.zip(tile_rows).enumerate().for_each(|(band, (rows, tiles))| {
            tiles.fill(NO_REACH);
            for (row, y) in rows.chunks_exact_mut(width).zip(band * TILE..) {
                fill(y, row);
                for (tile, pixels) in tiles.iter_mut().zip(row.chunks(TILE)) {
                    *tile = pixels.iter().fold(*tile, |most, &reach| most.max(reach));
                }
            }
        });
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The reach of a pixel of the image.
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> i32 {
        self.pixels[y * self.width + x]
    }

    /// Whether any of the pixels from..=to of a row reaches as far as `steps`.
    #[inline(always)]
    pub fn any_in_row(&self, y: usize, [from, to]: [usize; 2], steps: i32) -> bool {
        any_at_least(&self.pixels[y * self.width + from..=y * self.width + to], steps)
    }

    /// The parts of the rows from..=to of the image in which some tile that meets the columns from..=to reaches as
    /// far as `steps`.
    pub fn row_bands(
        &self,
        columns: [usize; 2],
        [top, bottom]: [usize; 2],
        steps: i32,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> {
        let tiles_across = self.width.div_ceil(TILE);
        (top / TILE..=bottom / TILE)
            .filter(move |band| {
                let [from, to] = columns.map(|x| band * tiles_across + x / TILE);
                any_at_least(&self.tiles[from..=to], steps)
            })
            .map(move |band| top.max(band * TILE)..=bottom.min(band * TILE + TILE - 1))
    }
}

#[inline(always)]
fn any_at_least(values: &[i32], least: i32) -> bool {
    // Without a branch per value, so that several are compared at once.
    values.chunks(32).any(|values| values.iter().fold(false, |any, &v| any | (v >= least)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_the_largest_reach() {
        let mut reach = ReachImage::default();
        for (width, height) in [(21, 19), (8, 8), (3, 30)] {
            reach.fill(width, height, |y, row| {
                row.iter_mut().enumerate().for_each(|(x, r)| *r = ((x * 31 + y * 17) % 23) as i32 - 5);
            });
            for steps in [-5, 10, 17, 18] {
                let (columns, rows) = ([1, width - 1], [2, height - 1]);
                let banded: Vec<_> = reach.row_bands(columns, rows, steps).flatten().collect();
                for y in rows[0]..=rows[1] {
                    let any = (columns[0]..=columns[1]).any(|x| reach.at(x, y) >= steps);
                    assert_eq!(reach.any_in_row(y, columns, steps), any);
                    assert!(!any || banded.contains(&y), "row {y} of {width} x {height} left out");
                }
                assert!(banded.is_sorted() && banded.iter().all(|y| (rows[0]..=rows[1]).contains(y)));
                assert!(steps < 18 || banded.is_empty());
            }
        }
    }
}
