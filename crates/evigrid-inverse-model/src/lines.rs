//! The lines of a whole image, one per pixel (Andert 2009, section V-A) or one per pixel of a pyramid (VI-B).

use std::ops::Range;

use evigrid_core::{MatchFilter, NO_MATCH};
use multiversion::multiversion;
use rayon::prelude::*;

use crate::counters::Counters;
use crate::layers::LayerTable;
use crate::line_drawing::{LineContext, LineCounts, LinePen, Section};
use crate::pyramid::Pyramid;
use crate::settings::{BlockPoint, Walk};

/// Image rows that one task draws.
const ROWS_PER_TASK: usize = 8;
/// Pixels of a pyramid that one task draws.
const POINTS_PER_TASK: usize = 512;

/// An image point with a disparity, whose line is to be drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImagePoint {
    pub x: f32,
    pub y: f32,
    pub disparity: f32,
}

/// Draws the line of every valid pixel (steps 1 to 3).
pub(crate) fn draw_image(
    context: &LineContext<'_>,
    filter: MatchFilter<'_>,
    walk: Walk,
    sections: &mut Vec<Section>,
) -> Counters {
    let height = context.camera.rig.height;
    sections.resize_with(height.div_ceil(ROWS_PER_TASK), Section::default);
    let tasks = sections.par_iter_mut().enumerate();
    let counts = tasks.map(|(task, section)| {
        let rows = task * ROWS_PER_TASK..height.min((task + 1) * ROWS_PER_TASK);
        draw_rows(context, filter, walk, rows, section)
    });
    let counts = counts.reduce(LineCounts::default, LineCounts::plus);
    counters(counts.lines, counts)
}

/// Draws the lines of the valid pixels of some rows.
#[multiversion(targets("x86_64+avx2"))]
fn draw_rows(
    context: &LineContext<'_>,
    filter: MatchFilter<'_>,
    walk: Walk,
    rows: Range<usize>,
    section: &mut Section,
) -> LineCounts {
    let width = context.camera.rig.width;
    let mut pen = LinePen::new(*context, walk, section);
    // Loops, not iterators: the functions that iterators call are not compiled for the newer processor.
    for y in rows {
        for x in 0..width {
            let disparity = filter.at(y * width + x);
            if disparity != NO_MATCH {
                pen.draw(x as f64, y as f64, disparity);
            }
        }
    }
    pen.finish();
    pen.counts
}

/// Draws the lines of the points that the pyramid leaves: `points`, found among `used` valid pixels.
pub(crate) fn draw_found(
    context: &LineContext<'_>,
    points: &[ImagePoint],
    used: u64,
    walk: Walk,
    sections: &mut Vec<Section>,
) -> Counters {
    sections.resize_with(points.len().div_ceil(POINTS_PER_TASK), Section::default);
    let tasks = sections.par_iter_mut().zip(points.par_chunks(POINTS_PER_TASK));
    let counts = tasks.map(|(section, points)| draw_part(context, walk, points, section));
    counters(used, counts.reduce(LineCounts::default, LineCounts::plus))
}

/// Draws the lines of some points.
#[multiversion(targets("x86_64+avx2"))]
fn draw_part(
    context: &LineContext<'_>,
    walk: Walk,
    points: &[ImagePoint],
    section: &mut Section,
) -> LineCounts {
    let mut pen = LinePen::new(*context, walk, section);
    for point in points {
        pen.draw(f64::from(point.x), f64::from(point.y), point.disparity);
    }
    pen.finish();
    pen.counts
}

/// The counts of an image whose lines come from so many pixels: a coordinate transfer for each, and one for
/// the camera.
fn counters(used_pixels: u64, counts: LineCounts) -> Counters {
    Counters {
        coordinate_transfers: used_pixels + 1,
        used_pixels,
        lines: counts.lines,
        cells_drawn: counts.cells_drawn,
        ..Counters::default()
    }
}

/// The recursion of pyramidal line drawing (section VI-B).
#[derive(Debug)]
pub(crate) struct Descent<'a> {
    pub pyramid: &'a Pyramid,
    pub table: &'a LayerTable,
    /// Disparity of the largest depth, where farther pixels are taken to be.
    pub far_px: f64,
    /// The lowest layer there is.
    pub lowest: i32,
    pub block_point: BlockPoint,
    /// How many layers below that of eq. 13 lines are drawn from.
    pub finer: i32,
    /// The points that were found.
    pub points: &'a mut Vec<ImagePoint>,
    /// Valid pixels read.
    pub used: u64,
}

impl Descent<'_> {
    /// Finds the points whose lines are to be drawn, from the top of the pyramid on.
    pub fn run(&mut self) {
        self.points.clear();
        self.visit(self.pyramid.top(), 0, 0);
    }

    /// Takes a pixel of layer i if the layer is fine enough for its distance (eqs 12 and 13) or the lowest
    /// there is, else tries the pixels of the layer below.
    fn visit(&mut self, i: i32, x: usize, y: usize) {
        let enlarged = (-i).max(0);
        let disparity = self.pyramid.layer(i).at(x >> enlarged, y >> enlarged);
        if disparity == NO_MATCH {
            return;
        }
        self.used += 1;
        if i == self.lowest || f64::from(disparity).max(self.far_px) >= self.table.edge_px(i + self.finer) {
            let scale = f32::from_bits(((i + 127) as u32) << 23);
            let off = if self.block_point == BlockPoint::Centre { 0.5 } else { 0.0 };
            let [x, y] = [x, y].map(|v| (v as f32 + off) * scale - off);
            return self.points.push(ImagePoint { x, y, disparity });
        }
        let below = self.pyramid.layer(i - 1);
        let enlarged = (1 - i).max(0);
        let (width, height) = (below.width << enlarged, below.height << enlarged);
        for (x, y) in [(2 * x, 2 * y), (2 * x + 1, 2 * y), (2 * x, 2 * y + 1), (2 * x + 1, 2 * y + 1)] {
            if x < width && y < height {
                self.visit(i - 1, x, y);
            }
        }
    }
}
