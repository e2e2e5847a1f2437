//! Line drawing (Andert 2009, section V-A): from pixels to the cells of their lines.

use evigrid_grid::{RayWalk, ViewRays, cell_index};

use crate::bresenham::{BresenhamLine, Place};
use crate::gaussian_table::{FastModel, GaussianTable, Profile};
use crate::image_grid::ImageGrid;
use crate::line_ends::LineEnds;
use crate::settings::Walk;

/// The image that lines are drawn of: everything that all of them have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LineContext<'a> {
    /// The rays of the pixels.
    pub camera: ViewRays<'a>,
    /// From depths to profiles.
    pub model: FastModel,
    /// From profiles to P.
    pub table: &'a GaussianTable,
    /// P of free space, p_min.
    pub free: f32,
    /// The cells in which a line has ended so far.
    pub ends: &'a LineEnds,
    /// The grid that is drawn into.
    pub image: &'a ImageGrid,
}

/// Counts of drawing lines.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LineCounts {
    /// Lines drawn.
    pub lines: u64,
    /// Cells drawn, those that pixels share counted for each.
    pub cells_drawn: u64,
}

impl LineCounts {
    /// The counts of two parts of an image together.
    pub fn plus(self, other: Self) -> Self {
        Self { lines: self.lines + other.lines, cells_drawn: self.cells_drawn + other.cells_drawn }
    }
}

/// Draws lines one after the other. Neighbouring pixels mostly fall into the same cell and so share their
/// line: of each such run the cells are found once, and only near the measured cell is there anything to be
/// said pixel by pixel.
#[derive(Debug)]
pub(crate) struct LinePen<'a> {
    context: LineContext<'a>,
    walk: Walk,
    end: [i64; 3],
    line: BresenhamLine,
    section: &'a mut Section,
    /// The counts so far.
    pub counts: LineCounts,
}

/// The last cells of a line, from its end on backwards, as far as some pixel needs them.
#[derive(Debug, Default)]
pub(crate) struct Section {
    cells: Vec<u32>,
    /// Range l of each cell, in cells: from the camera's centre to the cell's.
    ranges: Vec<f32>,
    /// The largest P that any pixel gives it.
    best: Vec<f32>,
    /// The cell that comes next.
    next: Option<Place>,
    /// How many cells are left.
    left: u64,
}

/// Cells before a cell of a line are never farther away than it by this much, in cells: they lie within 0.71
/// of the way from the camera's cell to the line's end. Near the camera, which need not be in the middle of
/// its cell, that says nothing.
const STRAY: f32 = 1.5;

impl<'a> LinePen<'a> {
    /// A pen that has drawn nothing; `section` is a buffer.
    pub fn new(context: LineContext<'a>, walk: Walk, section: &'a mut Section) -> Self {
        section.clear();
        let (end, line) = ([i64::MIN; 3], BresenhamLine::empty());
        Self { context, walk, end, line, section, counts: LineCounts::default() }
    }

    /// Draws the line of an image point with a disparity: steps 1 and 2 of the algorithm.
    #[inline(always)]
    pub fn draw(&mut self, x: f64, y: f64, disparity: f32) {
        let LineContext { camera, model, .. } = self.context;
        // Step 1: p_g and l_p (eqs 1, 2, 3, 6).
        let direction = camera.direction(x, y);
        let depth = camera.rig.depth_m(f64::from(disparity));
        let far = depth > camera.max_depth_m;
        let depth = if far { camera.max_depth_m } else { depth };
        let end = camera.at_depth(&direction, depth).map(cell_index);
        self.counts.lines += 1;
        if self.walk == Walk::Exact {
            self.counts.cells_drawn += draw_exact(&self.context, &direction, depth, far);
            return;
        }
        // Step 2: the line through the camera's centre and p_g.
        if end != self.end {
            self.finish();
            self.begin(end);
        }
        self.counts.cells_drawn += self.line.cells();
        if !far {
            let cells_per_metre = norm(&direction);
            let profile = model.profile(depth, cells_per_metre);
            self.section.add(&self.context, &profile);
        }
    }

    /// Ends the run of the last pixels. Must follow the last line.
    #[inline(always)]
    pub fn finish(&mut self) {
        self.section.offer(self.context.image);
    }

    /// Begins a line, and draws all of it as free space, which every pixel of the line allows at least.
    fn begin(&mut self, end: [i64; 3]) {
        let LineContext { camera, ends, image, .. } = self.context;
        self.end = end;
        self.line = BresenhamLine::new(camera.spec.shape(), camera.origin_cell, end);
        let count = self.line.cells();
        self.section.clear();
        if count > 0 {
            if ends.is_first(&end) {
                let walk = self.line.from(self.line.first);
                walk.visit(camera.spec.strides(), count, |flat| image.offer_least(flat));
            }
            self.section.next = Some(self.line.from(self.line.last));
            self.section.left = count;
        }
    }
}

impl Section {
    fn clear(&mut self) {
        self.cells.clear();
        self.ranges.clear();
        self.best.clear();
        (self.next, self.left) = (None, 0);
    }

    /// Adds one pixel's L^(s(l)) for the cells near the measured one (eq. 11).
    #[inline(always)]
    fn add(&mut self, context: &LineContext<'_>, profile: &Profile) {
        let start = profile.start();
        while self.left > 0 && self.ranges.last().is_none_or(|&l| l + STRAY > start || start < 2.0 * STRAY) {
            self.extend(context);
        }
        for (best, &range) in self.best.iter_mut().zip(&self.ranges) {
            let p = context.table.max_probability(profile, range);
            *best = if p > *best { p } else { *best };
        }
    }

    /// Adds one more cell towards the camera.
    fn extend(&mut self, context: &LineContext<'_>) {
        let Some(walk) = &mut self.next else { return };
        let strides = context.camera.spec.strides();
        let flat: i64 = (0..3).map(|a| walk.cell[a] * strides[a] as i64).sum();
        self.cells.push(flat as u32);
        self.ranges.push(range_of(&context.camera, walk.cell));
        self.best.push(context.free);
        self.left -= 1;
        walk.back();
    }

    /// Offers each cell the largest P of all pixels (obstacle priority).
    #[inline(always)]
    fn offer(&mut self, image: &ImageGrid) {
        for (&cell, &p) in self.cells.iter().zip(&self.best) {
            image.offer(cell as usize, p);
        }
    }
}

/// Draws a line along all cells that the ray crosses up to a depth (Amanatides and Woo 1987), instead of
/// along Bresenham's; returns their number.
fn draw_exact(context: &LineContext<'_>, direction: &[f64; 3], depth: f64, far: bool) -> u64 {
    let LineContext { camera, model, table, image, .. } = context;
    let end = camera.at_depth(direction, depth);
    let walk = RayWalk::in_cells(camera.spec, camera.origin, end);
    let cells = walk.len() as u64;
    if far {
        walk.for_each(|(cell, _)| image.offer_least(cell));
        return cells;
    }
    let profile = model.profile(depth, norm(direction));
    for (cell, _) in walk {
        let range = range_of(camera, camera.spec.voxel(cell).map(|v| v as i64));
        image.offer(cell, table.max_probability(&profile, range));
    }
    cells
}

/// Range l of a cell, in cells: from the camera's centre to the cell's.
#[inline(always)]
pub(crate) fn range_of(camera: &ViewRays<'_>, cell: [i64; 3]) -> f32 {
    let off: [f32; 3] = std::array::from_fn(|a| (cell[a] as f64 + 0.5 - camera.origin[a]) as f32);
    (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt()
}

#[inline(always)]
fn norm(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}
