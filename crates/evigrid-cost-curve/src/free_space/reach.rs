//! How far each pixel sees nothing but free space.

use rayon::prelude::*;

use crate::pixels::{ImageSize, Pixel, PixelBox, Span};

/// Pixels along the edge of a tile.
pub(crate) const TILE: usize = 8;
/// The reach of a pixel without a believable match: its ray says nothing.
pub(crate) const NO_REACH: i32 = i32::MIN;

/// The reach of every pixel: the number of steps from the camera's cell up to which the cells of its ray are
/// simply free. Beside it, the largest reach of every tile of 8 x 8 pixels.
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

    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        ImageSize { width: self.width, height: self.height }
    }

    /// The reach of a pixel of the image.
    #[inline]
    pub fn at(&self, pixel: Pixel) -> i32 {
        self.pixels[pixel.y * self.width + pixel.x]
    }

    /// Whether any of these pixels of row `y` reaches as far as `steps`.
    #[inline(always)]
    pub fn any_in_row(&self, y: usize, columns: Span, steps: i32) -> bool {
        any_at_least(&self.pixels[y * self.width + columns.first..=y * self.width + columns.last], steps)
    }

    /// The parts of the rows in which some tile that meets the columns reaches as far as `steps`.
    pub fn row_bands(
        &self,
        pixels: PixelBox,
        steps: i32,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> {
        let tiles_across = self.width.div_ceil(TILE);
        let PixelBox { columns, rows } = pixels;
        (rows.first / TILE..=rows.last / TILE)
            .filter(move |band| {
                let [from, to] = [columns.first, columns.last].map(|x| band * tiles_across + x / TILE);
                any_at_least(&self.tiles[from..=to], steps)
            })
            .map(move |band| rows.first.max(band * TILE)..=rows.last.min(band * TILE + TILE - 1))
    }
}

/// Whether any of the values is at least `least`.
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
                let columns = Span { first: 1, last: width - 1 };
                let rows = Span { first: 2, last: height - 1 };
                let banded: Vec<_> = reach.row_bands(PixelBox { columns, rows }, steps).flatten().collect();
                for y in rows.first..=rows.last {
                    let any = (columns.first..=columns.last).any(|x| reach.at(Pixel { x, y }) >= steps);
                    assert_eq!(reach.any_in_row(y, columns, steps), any);
                    assert!(!any || banded.contains(&y), "row {y} of {width} x {height} left out");
                }
                let wanted = |y: &usize| (rows.first..=rows.last).contains(y);
                assert!(banded.is_sorted() && banded.iter().all(wanted));
                assert!(steps < 18 || banded.is_empty());
            }
        }
    }
}
