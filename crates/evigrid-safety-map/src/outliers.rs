//! Removal of readings that differ much from their neighbours (section III).

use evigrid_core::{MatchFilter, NO_MATCH};
use multiversion::multiversion;

/// The range readings of a frame: believed matches without outliers. The buffers are kept from frame to frame.
#[derive(Debug, Default)]
pub struct Readings {
    /// Disparities in an image with a border of pixels without a reading, which spares the inner loop all tests.
    padded: Vec<f32>,
    kept: Vec<f32>,
}

impl Readings {
    /// The disparities of believed matches, row by row, without those that differ by more than `limit_px` from
    /// more than half of their up to eight neighbours that have a reading. A reading without any such neighbour
    /// is dropped too; with a limit of 0 nothing is. Negative: no reading.
    pub fn fill(&mut self, matches: &MatchFilter<'_>, width: usize, height: usize, limit_px: f64) -> &[f32] {
        let stride = width + 2;
        self.padded.clear();
        self.padded.resize(stride * (height + 2), NO_MATCH);
        self.kept.resize(width * height, NO_MATCH);
        for y in 0..height {
            let first = (y + 1) * stride + 1;
            matches.fill(y * width, &mut self.padded[first..first + width]);
        }
        for (y, row) in self.kept.chunks_exact_mut(width).enumerate() {
            let three = [0, 1, 2].map(|dy| &self.padded[(y + dy) * stride..][..stride]);
            keep_row(three, limit_px as f32, row);
        }
        &self.kept
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn keep_row(three: [&[f32]; 3], limit_px: f32, row: &mut [f32]) {
    for (x, to) in row.iter_mut().enumerate() {
        let own = three[1][x + 1];
        let (mut readings, mut agreeing) = (0, 0);
        for (dy, line) in three.iter().enumerate() {
            for dx in 0..3 {
                let other = line[x + dx];
                let reading = (other >= 0.0) & ((dy, dx) != (1, 1));
                readings += i32::from(reading);
                agreeing += i32::from(reading & ((other - own).abs() <= limit_px));
            }
        }
        let supported = (limit_px == 0.0) | ((agreeing > 0) & (2 * agreeing >= readings));
        *to = if (own >= 0.0) & supported { own } else { NO_MATCH };
    }
}
