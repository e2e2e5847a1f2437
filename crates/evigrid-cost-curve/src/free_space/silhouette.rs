//! The pixels that see a cell.

use evigrid_grid::{ViewRays, cell_index};

use crate::pixels::{ImageSize, Span};

/// The most edges of a silhouette: no more than three faces may hide one another, which makes 6, and 3 bounds
/// on the depth.
const MOST_EDGES: usize = 9;

/// The part of the image plane whose rays cross the inside of a cell before they end: a convex polygon, as
/// the intersection of half-planes.
///
/// A ray d crosses a box low..high (relative to the camera) if the intervals low_a < t d_a < high_a of the
/// three axes have a common t. Two intervals overlap if low_b / d_b < high_a / d_a, that is low_b d_a <
/// high_a d_b, and d is linear in the pixel: no projection, and no exception for cells beside or around the
/// camera. The depth takes part as a fourth axis, on which every ray has d = 1 and the box reaches from 0 to
/// the rays' greatest depth.
#[derive(Debug)]
pub(crate) struct Silhouette {
    edges: [Edge; MOST_EDGES],
    count: usize,
}

/// An edge of a silhouette as a bound on the columns of each row.
#[derive(Debug, Clone, Copy, Default)]
struct Edge {
    slope: f64,
    at_row_0: f64,
    /// Whether the inside lies on the right of the edge.
    is_left: bool,
}

/// A linear function on the image plane, column x + row y + constant.
#[derive(Debug, Clone, Copy, Default)]
struct Line {
    column: f64,
    row: f64,
    constant: f64,
}

/// One axis of a cell, mirrored so that the cell does not lie on the negative side of the camera.
#[derive(Debug, Clone, Copy)]
struct Side {
    low: f64,
    high: f64,
    direction: Line,
}

impl Silhouette {
    /// The silhouette of the cell with these indices; `rays_end` unless all of it is nearer than the rays'
    /// end.
    #[inline]
    pub fn of_cell(rays: &ViewRays<'_>, cell: [usize; 3], rays_end: bool) -> Self {
        let mut silhouette = Self { edges: [Edge::default(); MOST_EDGES], count: 0 };
        let sides: [Side; 3] = std::array::from_fn(|a| Side::new(rays, a, cell[a]));
        let depth = Line { constant: 1.0, ..Line::default() };
        for (b, near) in sides.iter().enumerate().filter(|(_, side)| side.low >= 0.0) {
            for (_, far) in sides.iter().enumerate().filter(|&(a, _)| a != b) {
                silhouette.add(Line::difference(far.high, &near.direction, near.low, &far.direction));
                if far.low < 0.0 {
                    silhouette.add(Line::difference(near.low, &far.direction, far.low, &near.direction));
                }
            }
            if rays_end {
                silhouette.add(Line::difference(rays.max_depth_m, &near.direction, near.low, &depth));
            }
        }
        silhouette
    }

    /// Adds the half-plane in which `line` is positive.
    #[inline]
    fn add(&mut self, line: Line) {
        // As a bound on the column; an edge along a row lets all columns of a row pass or none.
        let column = if line.column.abs() < 1e-30 { 1e-30 } else { line.column };
        let per_column = -1.0 / column;
        self.edges[self.count] = Edge {
            slope: line.row * per_column,
            at_row_0: line.constant * per_column,
            is_left: column > 0.0,
        };
        self.count += 1;
    }

    /// Whether one edge leaves the whole image outside. So it is with most cells beside the camera, whose
    /// image is not bounded by that of their corners.
    pub fn misses_image(&self, size: ImageSize) -> bool {
        let (last_column, last_row) = ((size.width - 1) as f64, (size.height - 1) as f64);
        self.edges[..self.count].iter().any(|edge| {
            [0.0, last_row].iter().all(|row| {
                let bound = edge.slope * row + edge.at_row_0;
                if edge.is_left { bound >= last_column } else { bound <= 0.0 }
            })
        })
    }

    /// The first and the last pixel of row `y`, of an image `width` pixels wide, that lie inside; `None` if
    /// none does.
    #[inline(always)]
    pub fn columns(&self, y: usize, width: usize) -> Option<Span> {
        let (mut left, mut right) = (-1.0_f64, width as f64);
        for edge in &self.edges[..self.count] {
            let bound = edge.slope * y as f64 + edge.at_row_0;
            left = if edge.is_left & (bound > left) { bound } else { left };
            right = if !edge.is_left & (bound < right) { bound } else { right };
        }
        // The whole numbers strictly between the two.
        let (first, end) = (cell_index(left.min(width as f64)) + 1, -cell_index(-right));
        (first < end).then(|| Span { first: first as usize, last: end as usize - 1 })
    }
}

impl Side {
    #[inline]
    fn new(rays: &ViewRays<'_>, axis: usize, index: usize) -> Self {
        let low = index as f64 - rays.origin[axis];
        let high = low + 1.0;
        let direction =
            Line { column: rays.per_column[axis], row: rays.per_row[axis], constant: rays.first[axis] };
        if high <= 0.0 {
            let mirrored =
                Line { column: -direction.column, row: -direction.row, constant: -direction.constant };
            Self { low: -high, high: -low, direction: mirrored }
        } else {
            Self { low, high, direction }
        }
    }
}

impl Line {
    /// The function p a - q b.
    #[inline]
    fn difference(p: f64, a: &Self, q: f64, b: &Self) -> Self {
        Self {
            column: p * a.column - q * b.column,
            row: p * a.row - q * b.row,
            constant: p * a.constant - q * b.constant,
        }
    }
}
