use crate::{GridSpec, cell_index};

/// The voxels of a grid that a straight segment passes, in order (Amanatides and Woo 1987).
///
/// Every cell that the segment crosses is visited once; from one cell to the next exactly one index changes,
/// by one. The segment may begin or end outside the grid: cells outside are not visited, but they are counted
/// in the number of steps to the segment's last cell, so that a profile that is anchored there needs no
/// special case.
#[derive(Debug, Clone)]
pub struct RayWalk {
    flat: isize,
    /// Cells still to visit within the grid.
    left_in_grid: u32,
    /// Steps from the current cell to the one that steps are counted to.
    steps_to_goal: i32,
    /// Parameters at which the segment enters the grid and leaves it.
    within: [f64; 2],
    axes: [WalkAxis; 3],
}

/// How a walk crosses the faces of the grid along one axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct WalkAxis {
    /// Parameter (0 = start, 1 = end of the segment) at which the next face is crossed.
    pub next_face: f64,
    /// Parameter between two faces.
    pub face_spacing: f64,
    /// Signed change of the flat index.
    pub stride: isize,
}

impl RayWalk {
    /// The walk from one point of the map frame to another, both in metres and finite.
    /// Empty if the segment misses the grid.
    pub fn new(spec: &GridSpec, from_m: [f64; 3], to_m: [f64; 3]) -> Self {
        Self::in_cells(spec, spec.to_cells(from_m), spec.to_cells(to_m))
    }

    /// The walk between points in units of cells from the grid's lower corner ([`GridSpec::to_cells`]).
    #[inline]
    pub fn in_cells(spec: &GridSpec, from: [f64; 3], to: [f64; 3]) -> Self {
        Self::towards(spec, from, to, to.map(cell_index))
    }

    /// The walk between points in units of cells, with steps counted to the cell with the indices `goal` instead
    /// of the last one. The segment's line must meet that cell; behind it steps are negative. Indices as
    /// [`cell_index`] makes them.
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
        let mut axes = [WalkAxis::default(); 3];
        for a in 0..3 {
            // A segment too short to move along an axis at all heads for the goal.
            let forward = (direction[a] > 0.0) | ((direction[a] == 0.0) & (goal[a] > first[a]));
            let ahead = last[a] - first[a];
            // Rounding at a face must not make the walk run backwards.
            let faces = (if forward { ahead } else { -ahead }).max(0) as u32;
            let next_face = ((first[a] + i64::from(forward)) as f64 - from[a]) * inverse[a];
            let stride = strides[a] as isize;
            axes[a] = WalkAxis {
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
        Self { flat: 0, left_in_grid: 0, steps_to_goal: 0, within: [0.0; 2], axes: [WalkAxis::default(); 3] }
    }

    /// Steps from the cell that comes next to the segment's last cell, or to the goal.
    #[inline]
    pub fn steps(&self) -> i32 {
        self.steps_to_goal
    }

    /// Parameter (0 = start, 1 = end of the segment) at which the segment enters the grid; 0 if it begins
    /// within.
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

    /// Flat index of the cell that comes next.
    #[inline(always)]
    pub fn flat(&self) -> isize {
        self.flat
    }

    /// Parameter at which the segment leaves the grid, or ends in it.
    #[inline(always)]
    pub fn end(&self) -> f64 {
        self.within[1]
    }

    /// The faces that come next, along x, y, z.
    #[inline(always)]
    pub fn axes(&self) -> &[WalkAxis; 3] {
        &self.axes
    }

    /// Crosses the nearest face; ties go to the first axis. Which face comes next is as good as random, so
    /// there is nothing here for a processor to mispredict.
    #[inline(always)]
    fn step(&mut self) {
        let [x, y, z] = &mut self.axes;
        let x_first = (x.next_face <= y.next_face) & (x.next_face <= z.next_face);
        let y_first = !x_first & (y.next_face <= z.next_face);
        self.flat += x.cross_if(x_first) + y.cross_if(y_first) + z.cross_if(!(x_first | y_first));
        self.steps_to_goal -= 1;
    }
}

impl WalkAxis {
    /// Makes sure that the face after the last that is crossed comes after `leave`, at which the walk ends,
    /// whatever rounding says: moves the faces by less than 1e-10 of the segment if need be.
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
    /// Flat index of the cell, and how many steps it is away from the cell that holds the segment's end (0
    /// there), or from the goal.
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
#[path = "ray_walk_tests.rs"]
mod tests;
