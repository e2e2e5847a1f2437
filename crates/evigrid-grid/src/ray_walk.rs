use crate::{GridSpec, cell_index};

/// The voxels of a grid that a straight segment passes, in order (Amanatides and Woo 1987).
///
/// Every cell that the segment crosses is visited once; from one cell to the next exactly one index changes, by one.
/// The segment may begin or end outside the grid: cells outside are not visited, but they are counted in the
/// number of steps to the segment's last cell, so that a profile that is anchored there needs no special case.
#[derive(Debug, Clone)]
pub struct RayWalk {
    pub(crate) flat: isize,
    /// Cells still to visit within the grid.
    pub(crate) left_in_grid: u32,
    /// Steps from the current cell to the one that steps are counted to.
    steps_to_goal: i32,
    /// Parameters at which the segment enters the grid and leaves it.
    pub(crate) within: [f64; 2],
    pub(crate) axes: [Axis; 3],
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Axis {
    /// Parameter (0 = start, 1 = end of the segment) at which the next face is crossed.
    pub(crate) next_face: f64,
    /// Parameter between two faces.
    pub(crate) face_spacing: f64,
    /// Signed change of the flat index.
    pub(crate) stride: isize,
}

impl RayWalk {
    /// The walk from one point of the map frame to another, both in metres and finite.
    /// Empty if the segment misses the grid.
    pub fn new(spec: &GridSpec, from_m: [f64; 3], to_m: [f64; 3]) -> Self {
        Self::in_cells(spec, spec.to_cells(from_m), spec.to_cells(to_m))
    }

    /// The same for points in units of cells from the grid's lower corner ([`GridSpec::to_cells`]).
    #[inline]
    pub fn in_cells(spec: &GridSpec, from: [f64; 3], to: [f64; 3]) -> Self {
        Self::towards(spec, from, to, to.map(cell_index))
    }

    /// The same, with steps counted to the cell with the indices `goal` instead of the last one. The segment's line
    /// must meet that cell; behind it steps are negative. Indices as [`cell_index`] makes them.
    #[inline(always)]
    pub fn towards(spec: &GridSpec, from: [f64; 3], to: [f64; 3], goal: [i64; 3]) -> Self {
        let direction: [f64; 3] = std::array::from_fn(|a| to[a] - from[a]);
        let (start_cell, end_cell) = (from.map(cell_index), to.map(cell_index));
        let shape = spec.shape();
        if beside(shape, start_cell, end_cell) {
            return Self::empty();
        }
        let inverse = direction.map(f64::recip);
        let (first, last, enter, leave) = if within(shape, start_cell) && within(shape, end_cell) {
            (start_cell, end_cell, 0.0, 1.0)
        } else {
            let Some((enter, leave)) = clip(shape, from, direction) else { return Self::empty() };
            let cell_at = |a: usize, t: f64| cell_index(from[a] + t * direction[a]);
            let first = std::array::from_fn(|a| if enter > 0.0 { cell_at(a, enter) } else { start_cell[a] });
            let last = std::array::from_fn(|a| if leave < 1.0 { cell_at(a, leave) } else { end_cell[a] });
            (clamp(shape, first), clamp(shape, last), enter, leave)
        };
        let (mut flat, mut steps_to_goal, mut faces_in_grid) = (0, 0_i64, 0);
        let strides = spec.strides();
        let mut axes = [Axis::default(); 3];
        for a in 0..3 {
            // A segment too short to move along an axis at all heads for the goal.
            let forward = (direction[a] > 0.0) | ((direction[a] == 0.0) & (goal[a] > first[a]));
            let ahead = last[a] - first[a];
            // Rounding at a face must not make the walk run backwards.
            let faces = (if forward { ahead } else { -ahead }).max(0) as u32;
            let next_face = ((first[a] + i64::from(forward)) as f64 - from[a]) * inverse[a];
            let stride = strides[a] as isize;
            axes[a] = Axis {
                next_face: if faces > 0 { next_face } else { f64::INFINITY },
                face_spacing: inverse[a].abs(),
                stride: if forward { stride } else { -stride },
            };
            axes[a].end_after(leave, faces);
            flat += first[a] as isize * stride;
            let to_goal = goal[a] - first[a];
            steps_to_goal += if forward { to_goal } else { -to_goal };
            faces_in_grid += faces;
        }
        let steps_to_goal = steps_to_goal.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        Self { flat, left_in_grid: faces_in_grid + 1, steps_to_goal, within: [enter, leave], axes }
    }

    fn empty() -> Self {
        Self { flat: 0, left_in_grid: 0, steps_to_goal: 0, within: [0.0; 2], axes: [Axis::default(); 3] }
    }

    /// Steps from the cell that comes next to the segment's last cell, or to the goal.
    #[inline]
    pub fn steps(&self) -> i32 {
        self.steps_to_goal
    }

    /// Parameter (0 = start, 1 = end of the segment) at which the segment enters the grid; 0 if it begins within.
    #[inline]
    pub fn enter(&self) -> f64 {
        self.within[0]
    }

    /// Parameter at which the segment leaves the cell that comes next, or ends in it.
    #[inline(always)]
    pub fn leave(&self) -> f64 {
        // The last cell has no next face in the grid.
        let [x, y, z] = [0, 1, 2].map(|a| self.axes[a].next_face);
        let min = |a: f64, b: f64| if a < b { a } else { b };
        min(min(x, y), min(z, self.within[1]))
    }

    /// Crosses the nearest face; ties go to the first axis. Which face comes next is as good as random, so there is
    /// nothing here for a processor to mispredict.
    #[inline(always)]
    fn step(&mut self) {
        let [x, y, z] = &mut self.axes;
        let x_first = (x.next_face <= y.next_face) & (x.next_face <= z.next_face);
        let y_first = !x_first & (y.next_face <= z.next_face);
        self.flat += x.cross_if(x_first) + y.cross_if(y_first) + z.cross_if(!(x_first | y_first));
        self.steps_to_goal -= 1;
    }
}

impl Axis {
    /// Makes sure that the face after the last that is crossed comes after `leave`, at which the walk ends, whatever
    /// rounding says: moves the faces by less than 1e-10 of the segment if need be.
    #[inline]
    fn end_after(&mut self, leave: f64, faces: u32) {
        let past_last = self.next_face + f64::from(faces) * self.face_spacing;
        if past_last < leave + 0.5e-10 {
            self.face_spacing += 1e-10 / f64::from(faces.max(1));
        }
    }

    /// Crosses the next face if `first`; the change of the flat index.
    #[inline(always)]
    fn cross_if(&mut self, first: bool) -> isize {
        let mask = -i64::from(first);
        self.next_face += f64::from_bits(self.face_spacing.to_bits() & mask as u64);
        self.stride & mask as isize
    }
}

impl Iterator for RayWalk {
    /// Flat index of the cell, and how many steps it is away from the cell that holds the segment's end (0 there), or
    /// from the goal.
    type Item = (usize, i32);

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        if self.left_in_grid == 0 {
            return None;
        }
        let item = (self.flat as usize, self.steps_to_goal);
        self.left_in_grid -= 1;
        if self.left_in_grid > 0 {
            self.step();
        }
        Some(item)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left_in_grid as usize, Some(self.left_in_grid as usize))
    }
}

impl ExactSizeIterator for RayWalk {}

/// The part (enter, leave) of the segment, 0..1, that lies within `[0, shape)`; `None` if it misses the grid.
fn clip(shape: [usize; 3], from: [f64; 3], direction: [f64; 3]) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for a in 0..3 {
        let extent = shape[a] as f64;
        if direction[a] == 0.0 {
            if from[a] < 0.0 || from[a] >= extent {
                return None;
            }
            continue;
        }
        let (low, high) = (-from[a] / direction[a], (extent - from[a]) / direction[a]);
        enter = enter.max(low.min(high));
        leave = leave.min(low.max(high));
    }
    // A segment that only touches the grid's face or edge crosses no cell.
    let inside =
        enter < leave || (enter == leave && (0..3).all(|a| from[a] >= 0.0 && from[a] < shape[a] as f64));
    inside.then_some((enter, leave))
}

/// Whether two cells lie beyond the same side of the grid, and so all cells between them.
#[inline(always)]
fn beside(shape: [usize; 3], a: [i64; 3], b: [i64; 3]) -> bool {
    let outside = |axis: usize| {
        let size = shape[axis] as i64;
        ((a[axis] < 0) & (b[axis] < 0)) | ((a[axis] >= size) & (b[axis] >= size))
    };
    outside(0) | outside(1) | outside(2)
}

#[inline]
fn within(shape: [usize; 3], cell: [i64; 3]) -> bool {
    (0..3).all(|a| (0..shape[a] as i64).contains(&cell[a]))
}

fn clamp(shape: [usize; 3], cell: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|a| cell[a].clamp(0, shape[a] as i64 - 1))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::GridSettings;
    use proptest::prelude::*;

    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 8.0], y_m: [0.0, 6.0], z_m: [0.0, 4.0], cell_size_m: 1.0 };
        GridSpec::new(&settings).unwrap()
    }

    /// Length of the parameter interval that the segment spends in a cell, by brute force.
    fn overlap(cell: [usize; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for a in 0..3 {
            let (low, d) = (cell[a] as f64, to[a] - from[a]);
            if d.abs() < 1e-12 {
                if from[a] < low || from[a] >= low + 1.0 {
                    return -1.0;
                }
            } else {
                let (t0, t1) = ((low - from[a]) / d, (low + 1.0 - from[a]) / d);
                enter = enter.max(t0.min(t1));
                leave = leave.min(t0.max(t1));
            }
        }
        leave - enter
    }

    fn check(from: [f64; 3], to: [f64; 3]) -> Result<(), TestCaseError> {
        let spec = spec();
        let walk: Vec<_> = RayWalk::in_cells(&spec, from, to).collect();
        let visited: Vec<_> = walk.iter().map(|&(flat, _)| spec.voxel(flat)).collect();
        for flat in 0..spec.cell_count() {
            let cell = spec.voxel(flat);
            let overlap = overlap(cell, from, to);
            let count = visited.iter().filter(|v| **v == cell).count();
            prop_assert!(count <= 1, "{cell:?} twice");
            prop_assert!(overlap < 1e-9 || count == 1, "{cell:?} missed, overlap {overlap}");
            prop_assert!(overlap > -1e-9 || count == 0, "{cell:?} not met, overlap {overlap}");
        }
        for (pair, steps) in visited.windows(2).zip(walk.windows(2)) {
            let moved: usize = (0..3).map(|a| pair[0][a].abs_diff(pair[1][a])).sum();
            prop_assert_eq!(moved, 1, "from {:?} to {:?}", pair[0], pair[1]);
            prop_assert_eq!(steps[0].1 - steps[1].1, 1);
        }
        check_parameters(&spec, from, to)?;
        let inside = |p: [f64; 3]| spec.flat(p.map(|v| v.floor() as i64));
        if let Some(end) = inside(to) {
            prop_assert_eq!(walk.last().copied(), Some((end, 0)));
        }
        if let Some(start) = inside(from) {
            prop_assert_eq!(walk.first().map(|w| w.0), Some(start));
        }
        Ok(())
    }

    /// Every cell holds the middle between where it is entered and where it is left.
    fn check_parameters(spec: &GridSpec, from: [f64; 3], to: [f64; 3]) -> Result<(), TestCaseError> {
        let mut walk = RayWalk::in_cells(spec, from, to);
        let mut enter = walk.enter();
        loop {
            let leave = walk.leave();
            let Some((cell, _)) = walk.next() else { return Ok(()) };
            let middle: [f64; 3] =
                std::array::from_fn(|a| from[a] + (to[a] - from[a]) * 0.5 * (enter + leave));
            let cell = spec.voxel(cell).map(|v| v as f64);
            let within = |a: usize| (cell[a] - 1e-8..cell[a] + 1.0 + 1e-8).contains(&middle[a]);
            prop_assert!((0..3).all(within), "{cell:?} holds no {middle:?}");
            prop_assert!(leave > enter - 1e-9);
            enter = leave;
        }
    }

    fn anywhere() -> impl Strategy<Value = [f64; 3]> {
        [-4.0..12.0, -4.0..10.0, -4.0..8.0]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn the_walk_visits_what_the_segment_crosses(from in anywhere(), to in anywhere()) {
            check(from, to)?;
        }

        #[test]
        fn also_along_faces_edges_and_diagonals(
            from in [-2..10_i32, -2..8_i32, -2..6_i32],
            to in [-2..10_i32, -2..8_i32, -2..6_i32],
            shift in [0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64],
        ) {
            // Shifted off the faces: the segment then still runs parallel to axes and diagonals, through edges.
            let at = |p: [i32; 3]| std::array::from_fn(|a| f64::from(p[a]) + shift[a].clamp(0.01, 0.99));
            let spec = spec();
            let (from, to) = (at(from), at(to));
            let walk: Vec<_> = RayWalk::in_cells(&spec, from, to).collect();
            for (flat, _) in &walk {
                prop_assert!(overlap(spec.voxel(*flat), from, to) > -1e-9);
            }
            for flat in 0..spec.cell_count() {
                let met = walk.iter().any(|w| w.0 == flat);
                prop_assert!(met || overlap(spec.voxel(flat), from, to) < 1e-9);
            }
        }
    }

    #[test]
    fn steps_are_counted_beyond_the_grid() {
        // Along +x from cell 6: the grid ends with cell 7, the segment in cell 20.
        let walk: Vec<_> = RayWalk::in_cells(&spec(), [6.5, 0.5, 0.5], [20.5, 0.5, 0.5]).collect();
        assert_eq!(walk.iter().map(|w| w.1).collect::<Vec<_>>(), [14, 13]);
        assert_eq!(RayWalk::in_cells(&spec(), [9.0, 0.5, 0.5], [20.5, 0.5, 0.5]).count(), 0);
        let to_goal = RayWalk::towards(&spec(), [1.5, 0.5, 0.5], [4.5, 0.5, 0.5], [3, 0, 0]);
        assert_eq!(to_goal.map(|w| w.1).collect::<Vec<_>>(), [2, 1, 0, -1]);
        for goal in [[3, 0, 0], [1, 1, 1]] {
            assert_eq!(RayWalk::towards(&spec(), [1.5, 0.5, 0.5], [1.5, 0.5, 0.5], goal).steps(), 2);
        }
        let point: Vec<_> = RayWalk::in_cells(&spec(), [1.5, 1.5, 1.5], [1.5, 1.5, 1.5]).collect();
        assert_eq!(point, [(24 + 4 + 1, 0)]);
    }
}
