//! How far each pixel sees nothing but free space, and for how many of several maps.

use rayon::prelude::*;

use crate::reach::{NO_REACH, TILE};

/// What a pixel says of the cells of its ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PixelReach {
    /// Steps from the camera's cell up to which the cells are simply free.
    pub steps: i32,
    /// How many maps believe it: the first so many.
    pub level: i32,
}

impl PixelReach {
    /// A pixel that no map believes.
    pub const NONE: Self = Self { steps: NO_REACH, level: 0 };
}

/// The reach of every pixel ([`crate::reach::ReachImage`]) with its level, and the largest of either in every tile of
/// 8 x 8 pixels.
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

    /// Width and height, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The level of a pixel that reaches as far as `steps`, else 0.
    #[inline(always)]
    pub fn level_at(&self, (x, y): (usize, usize), steps: i32) -> i32 {
        level_if_reached(&self.pixels[y * self.width + x], steps)
    }

    /// The highest level of the pixels from..=to of a row that reach as far as `steps`, else 0.
    #[inline(always)]
    pub fn level_in_row(&self, y: usize, [from, to]: [usize; 2], steps: i32) -> i32 {
        let row = &self.pixels[y * self.width + from..=y * self.width + to];
        // Without a branch per pixel, so that several are compared at once.
        row.iter().fold(0, |level, pixel| level.max(level_if_reached(pixel, steps)))
    }

    /// Whether rows of a tile band may hold a pixel, within these columns, that reaches as far as `steps` at more than
    /// a level.
    #[inline(always)]
    fn band_exceeds(&self, band: usize, columns: [usize; 2], steps: i32, level: i32) -> bool {
        let [from, to] = columns.map(|x| band * self.width.div_ceil(TILE) + x / TILE);
        self.tiles[from..=to].iter().fold(false, |any, tile| any | (level_if_reached(tile, steps) > level))
    }

    /// The parts of the rows from..=to of the image that may hold such a pixel. What `level` is by then is asked anew
    /// for every part.
    pub fn row_bands(
        &self,
        columns: [usize; 2],
        [top, bottom]: [usize; 2],
        steps: i32,
        level: &std::cell::Cell<i32>,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> {
        (top / TILE..=bottom / TILE)
            .filter(move |&band| self.band_exceeds(band, columns, steps, level.get()))
            .map(move |band| top.max(band * TILE)..=bottom.min(band * TILE + TILE - 1))
    }
}

#[inline(always)]
fn level_if_reached(pixel: &PixelReach, steps: i32) -> i32 {
    if pixel.steps >= steps { pixel.level } else { 0 }
}

fn largest(a: PixelReach, b: &PixelReach) -> PixelReach {
    PixelReach { steps: a.steps.max(b.steps), level: a.level.max(b.level) }
}
