//! Joins segments that lie on one plane: Algorithm 1 cuts a ramp into a strip for every layer of voxels, and the
//! slope of a strip is a matter of chance. (Own addition.)

use std::collections::{BTreeMap, BTreeSet};

use evigrid_grid::{Moments, Plane};

use crate::columns::Columns;
use crate::segments::{Segment, Segments};

/// Segments touch if so many pairs of their cells do.
const MIN_TOUCHING: usize = 3;
/// Fewer points say nothing about a plane.
const MIN_POINTS: f64 = 6.0;

/// Segments that are being joined, by the number of the first segment of each.
struct Joining {
    /// The points of each segment, and how far they lie from its own plane.
    own: Vec<(Moments, f64)>,
    /// For each segment the one that it has been joined to, itself if none.
    joined_to: Vec<usize>,
    /// Points and members of joined segments.
    moments: Vec<Moments>,
    members: Vec<Vec<usize>>,
}

impl Segments {
    /// Joins neighbouring segments, the best fitting pair first, while the points of no member lie more than
    /// `limit_m` farther (root mean square) from the common plane than from that of the member alone.
    pub(crate) fn joined(self, columns: &Columns, limit_m: f64) -> Self {
        let touching = self.touching(columns);
        let mut joining = Joining::new(&self, columns);
        while let Some((a, b)) = joining.best_pair(&touching, limit_m) {
            joining.join(a, b);
        }
        let mut list: Vec<Segment> = Vec::new();
        let mut of_cell = self.of_cell;
        for first in (0..self.list.len()).filter(|&n| joining.joined_to[n] == n) {
            let number = list.len() as u32;
            let cells: Vec<u32> =
                joining.members[first].iter().flat_map(|&n| self.list[n].cells.iter().copied()).collect();
            cells.iter().for_each(|&cell| of_cell[cell as usize] = Some(number));
            list.push(Segment { cells, interior: 0, plane: None });
        }
        let mut joined = Self { list, of_cell };
        joined.fit_planes(columns);
        joined
    }

    /// Pairs of segments that touch, the lower number first.
    fn touching(&self, columns: &Columns) -> Vec<[usize; 2]> {
        let mut pairs = BTreeMap::new();
        for (own, segment) in self.list.iter().enumerate() {
            for &cell in &segment.cells {
                let others = columns.spec().neighbours(cell as usize).filter_map(|n| self.of(n));
                others.filter(|&n| n > own).for_each(|n| *pairs.entry([own, n]).or_insert(0) += 1);
            }
        }
        pairs.into_iter().filter(|&(_, cells)| cells >= MIN_TOUCHING).map(|(pair, _)| pair).collect()
    }
}

impl Joining {
    fn new(segments: &Segments, columns: &Columns) -> Self {
        let own = segments.list.iter().map(|segment| {
            let moments = segment.moments(columns);
            let distance_m = segment.plane.map_or(f64::INFINITY, |plane| moments.distance_m(&plane));
            (moments, distance_m)
        });
        let own: Vec<(Moments, f64)> = own.collect();
        let moments = own.iter().map(|(moments, _)| *moments).collect();
        let members = (0..own.len()).map(|n| vec![n]).collect();
        Self { joined_to: (0..own.len()).collect(), own, moments, members }
    }

    fn first_of(&self, mut segment: usize) -> usize {
        while self.joined_to[segment] != segment {
            segment = self.joined_to[segment];
        }
        segment
    }

    /// The pair whose common plane fits best; `None` if none fits.
    fn best_pair(&self, touching: &[[usize; 2]], limit_m: f64) -> Option<(usize, usize)> {
        let firsts = touching.iter().map(|&[a, b]| (self.first_of(a), self.first_of(b)));
        let pairs: BTreeSet<_> = firsts.filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b))).collect();
        let misfits = pairs.into_iter().filter_map(|(a, b)| Some((self.misfit_m(a, b)?, a, b)));
        let best = misfits.min_by(|x, y| x.0.total_cmp(&y.0))?;
        (best.0 <= limit_m).then_some((best.1, best.2))
    }

    /// How much farther the points of any member lie from the common plane than from their own.
    fn misfit_m(&self, a: usize, b: usize) -> Option<f64> {
        let mut all = self.moments[a];
        all.append(&self.moments[b]);
        let plane: Plane = all.plane()?;
        let misfit = |&member: &usize| {
            let (moments, distance_m) = &self.own[member];
            if moments.count < MIN_POINTS { 0.0 } else { moments.distance_m(&plane) - distance_m }
        };
        Some(self.members[a].iter().chain(&self.members[b]).map(misfit).fold(0.0, f64::max))
    }

    fn join(&mut self, a: usize, b: usize) {
        self.joined_to[b] = a;
        let (moments, members) = (self.moments[b], std::mem::take(&mut self.members[b]));
        self.moments[a].append(&moments);
        self.members[a].extend(members);
    }
}
