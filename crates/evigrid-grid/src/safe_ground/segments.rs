//! Segments of cells that lie on one continuous surface (Murarka and Kuipers 2009, Algorithm 1).

use std::collections::{BTreeMap, BTreeSet};

use super::{SafetyRules, Surface};

/// The ground plan that segments lie on.
pub struct Plan<'a> {
    /// Cells along x and y.
    pub shape: [usize; 2],
    /// Edge of a cell, metres.
    pub cell_size_m: f64,
    /// The surface of each cell (i * ny + j) that is on a surface and has no edge.
    pub surfaces: &'a [Option<Surface>],
    /// Whether a surface is too steep, and other limits.
    pub rules: &'a SafetyRules,
}

/// All segments, and where they meet.
pub struct Segments {
    /// The segment of each cell.
    pub of_cell: Vec<Option<usize>>,
    /// The cells of each segment.
    pub cells: Vec<Vec<usize>>,
    /// How many cells of each segment have all eight neighbours in it.
    pub interior: Vec<usize>,
    /// Where two segments meet, by both their numbers, the lower first.
    pub borders: BTreeMap<[usize; 2], Border>,
}

/// Where two segments meet.
pub struct Border {
    /// Cells of either segment, next to the other, at whose centre the surfaces have
    /// nearly the same height (c_RS).
    pub agreeing: BTreeSet<usize>,
    /// The smallest difference of height between two neighbouring cells, metres.
    pub step_m: f64,
}

impl Plan<'_> {
    /// The segments of the plan, in order of their first cells.
    pub fn segments(&self) -> Segments {
        let mut of_cell: Vec<Option<usize>> = vec![None; self.surfaces.len()];
        let mut cells: Vec<Vec<usize>> = Vec::new();
        for first in 0..self.surfaces.len() {
            if self.surfaces[first].is_none() || of_cell[first].is_some() {
                continue;
            }
            of_cell[first] = Some(cells.len());
            let mut found = vec![first];
            let mut next = 0;
            while let Some(&cell) = found.get(next) {
                next += 1;
                for (neighbour, away) in self.neighbours(cell) {
                    if of_cell[neighbour].is_none() && self.is_continuous(cell, neighbour, away) {
                        of_cell[neighbour] = Some(cells.len());
                        found.push(neighbour);
                    }
                }
            }
            cells.push(found);
        }
        let is_interior = |&&cell: &&usize| {
            self.neighbours(cell).filter(|&(n, _)| of_cell[n] == of_cell[cell]).count() == 8
        };
        let interior = cells.iter().map(|cells| cells.iter().filter(is_interior).count()).collect();
        let borders = self.borders(&of_cell);
        Segments { of_cell, cells, interior, borders }
    }

    /// Whether a surface is too steep to drive on.
    pub fn is_steep(&self, surface: &Surface) -> bool {
        surface.slope_rad().to_degrees() > self.rules.max_slope_deg
    }

    /// Whether two neighbours, so far apart, are on one continuous surface: the plane of either leads to the
    /// other, and both or none are too steep.
    fn is_continuous(&self, a: usize, b: usize, away_m: [f64; 2]) -> bool {
        let (Some(a), Some(b)) = (self.surfaces[a], self.surfaces[b]) else { return false };
        let there = (a.height_at(away_m) - b.height_m).abs();
        let back = (b.height_at(away_m.map(|v| -v)) - a.height_m).abs();
        let limit = self.rules.continuity_m;
        there <= limit && back <= limit && self.is_steep(&a) == self.is_steep(&b)
    }

    fn borders(&self, of_cell: &[Option<usize>]) -> BTreeMap<[usize; 2], Border> {
        let mut borders = BTreeMap::new();
        for (cell, surface) in self.surfaces.iter().enumerate() {
            let (Some(own), Some(surface)) = (of_cell[cell], surface) else { continue };
            for (neighbour, away) in self.neighbours(cell) {
                let (Some(other), Some(beyond)) = (of_cell[neighbour], self.surfaces[neighbour]) else {
                    continue;
                };
                if own == other {
                    continue;
                }
                let border = borders
                    .entry([own.min(other), own.max(other)])
                    .or_insert_with(|| Border { agreeing: BTreeSet::new(), step_m: f64::INFINITY });
                border.step_m = border.step_m.min((surface.height_m - beyond.height_m).abs());
                let of_other = beyond.height_at(away.map(|v| -v));
                if (surface.height_m - of_other).abs() < self.rules.max_step_m {
                    border.agreeing.insert(cell);
                }
            }
        }
        borders
    }

    /// The up to eight neighbours of a cell, and how far away they are along x and y, metres.
    fn neighbours(&self, cell: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        let ([nx, ny], c) = (self.shape, self.cell_size_m);
        let (i, j) = (cell / ny, cell % ny);
        let around = (0..9).filter(|&k| k != 4).map(|k| (k / 3, k % 3));
        around.filter_map(move |(di, dj)| {
            let (i, j) = ((i + di).checked_sub(1)?, (j + dj).checked_sub(1)?);
            let away = [di, dj].map(|d| (d as f64 - 1.0) * c);
            (i < nx && j < ny).then_some((i * ny + j, away))
        })
    }
}

impl Segments {
    /// The segments that border on a segment, and where.
    pub fn next_to(&self, segment: usize) -> impl Iterator<Item = (usize, &Border)> {
        self.borders.iter().filter_map(move |(&[a, b], border)| match segment {
            _ if segment == a => Some((b, border)),
            _ if segment == b => Some((a, border)),
            _ => None,
        })
    }

    /// Which segments can be reached from one over borders that `leads` accepts.
    pub fn reached(&self, first: usize, leads: impl Fn(usize, &Border) -> bool) -> Vec<bool> {
        let mut is_reached = vec![false; self.cells.len()];
        is_reached[first] = true;
        let mut open = vec![first];
        while let Some(segment) = open.pop() {
            for (other, border) in self.next_to(segment) {
                if !is_reached[other] && leads(other, border) {
                    is_reached[other] = true;
                    open.push(other);
                }
            }
        }
        is_reached
    }
}
