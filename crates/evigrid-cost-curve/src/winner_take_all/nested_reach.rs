//! How far each pixel sees nothing but free space, and for how many of several maps.

use std::cell::Cell;

use rayon::prelude::*;

use crate::free_space::{NO_REACH, TILE};
use crate::pixels::{ImageSize, Pixel, PixelBox, Span};

/// How far a pixel sees nothing but free space, and for how many maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PixelReach {
    /// Steps from the camera's cell up to which the cells of the pixel's ray are simply free.
    pub steps: i32,
    /// How many maps believe the pixel's match: the first so many.
    pub level: i32,
}

impl PixelReach {
    /// A pixel that no map believes.
    pub const NONE: Self = Self { steps: NO_REACH, level: 0 };
}

/// The reach of every pixel ([`crate::free_space::ReachImage`]) with its level, and the largest of either in
/// every tile of 8 x 8 pixels.
#[derive(Debug, Default)]
pub(crate) struct NestedReach {
    width: usize,
    height: usize,
    pixels: Vec<PixelReach>,
    tiles: Vec<PixelReach>,
}

impl NestedReach {
    /// Sets every pixel; `fill(y, row)` is called once for every row, from any thread.
    pub fn fill(&mut self, width: usize, height: usize, fill: impl Fn(usize, &mut [PixelReach]) + Sync) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width * height, PixelReach::NONE);
        self.tiles.resize(width.div_ceil(TILE) * height.div_ceil(TILE), PixelReach::NONE);
        let bands = self.pixels.par_chunks_mut(TILE * width);
        let tile_rows = self.tiles.par_chunks_mut(width.div_ceil(TILE));
        bands.zip(tile_rows).enumerate().for_each(|(band, (rows, tiles))| {
            tiles.fill(PixelReach::NONE);
            for (row, y) in rows.chunks_exact_mut(width).zip(band * TILE..) {
                fill(y, row);
                for (tile, pixels) in tiles.iter_mut().zip(row.chunks(TILE)) {
                    *tile = pixels.iter().fold(*tile, largest);
                }
            }
        });
    }

    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        ImageSize { width: self.width, height: self.height }
    }

    /// The level of a pixel that reaches as far as `steps`, else 0.
    #[inline(always)]
    pub fn level_at(&self, pixel: Pixel, steps: i32) -> i32 {
        level_if_reached(&self.pixels[pixel.y * self.width + pixel.x], steps)
    }

    /// The highest level of those of a row's pixels that reach as far as `steps`, else 0.
    #[inline(always)]
    pub fn level_in_row(&self, y: usize, columns: Span, steps: i32) -> i32 {
        let row = &self.pixels[y * self.width + columns.first..=y * self.width + columns.last];
        // Without a branch per pixel, so that several are compared at once.
        row.iter().fold(0, |level, pixel| level.max(level_if_reached(pixel, steps)))
    }

    /// Whether rows of a tile band may hold a pixel, within these columns, that reaches as far as `steps` at
    /// more than a level.
    #[inline(always)]
    fn band_exceeds(&self, band: usize, columns: Span, steps: i32, level: i32) -> bool {
        let [from, to] = [columns.first, columns.last].map(|x| band * self.width.div_ceil(TILE) + x / TILE);
        self.tiles[from..=to].iter().fold(false, |any, tile| any | (level_if_reached(tile, steps) > level))
    }

    /// The parts of the rows that may hold a pixel, within the columns, that reaches as far as `steps` at
    /// more than `level`, which is read anew for every part.
    pub fn row_bands(
        &self,
        pixels: PixelBox,
        steps: i32,
        level: &Cell<i32>,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> {
        let PixelBox { columns, rows } = pixels;
        (rows.first / TILE..=rows.last / TILE)
            .filter(move |&band| self.band_exceeds(band, columns, steps, level.get()))
            .map(move |band| rows.first.max(band * TILE)..=rows.last.min(band * TILE + TILE - 1))
    }
}

/// The level of a pixel or tile that reaches as far as `steps`, else 0.
#[inline(always)]
fn level_if_reached(pixel: &PixelReach, steps: i32) -> i32 {
    if pixel.steps >= steps { pixel.level } else { 0 }
}

/// The larger of two reaches and the larger of their levels.
fn largest(a: PixelReach, b: &PixelReach) -> PixelReach {
    PixelReach { steps: a.steps.max(b.steps), level: a.level.max(b.level) }
}
