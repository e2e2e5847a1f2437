//! Bresenham's line in three dimensions.

/// The cells of the line from one cell to another, by their indices: N + 1 of them, N the largest difference
/// of the indices, and on each axis the n-th is the one nearest to n/N of the way; halves go away from the
/// start. Because the line knows cells alone, all pixels whose points fall into one cell share it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BresenhamLine {
    start: [i64; 3],
    sign: [i64; 3],
    /// Distance |end - start| along each axis, cells.
    length: [i64; 3],
    /// N, the largest of these distances.
    steps: i64,
    /// The first n whose cell lies in the grid.
    pub first: i64,
    /// The last n whose cell lies in the grid; less than the first if none does.
    pub last: i64,
}

/// The most steps of a line that is drawn. No grid has more cells along an axis, and products of two lengths
/// fit into 64 bits.
const MOST_STEPS: i64 = 1 << 29;

impl BresenhamLine {
    /// The line from one cell to another, over a grid with so many cells along each axis.
    pub fn new(shape: [usize; 3], start: [i64; 3], end: [i64; 3]) -> Self {
        let sign: [i64; 3] = std::array::from_fn(|a| (end[a] - start[a]).signum());
        let length: [i64; 3] = std::array::from_fn(|a| (end[a] - start[a]).abs());
        let steps = length.into_iter().fold(0, i64::max);
        let mut line = Self { start, sign, length, steps, first: 0, last: steps };
        let inside = |cell: [i64; 3]| (0..3).all(|a| (0..shape[a] as i64).contains(&cell[a]));
        if steps > MOST_STEPS {
            line.last = -1;
        } else if !(inside(start) && inside(end)) {
            (0..3).for_each(|a| line.cut(a, shape[a] as i64));
        }
        line
    }

    /// A line without cells.
    pub fn empty() -> Self {
        Self { start: [0; 3], sign: [0; 3], length: [0; 3], steps: 0, first: 0, last: -1 }
    }

    /// Leaves out the cells that lie outside the grid along an axis.
    fn cut(&mut self, a: usize, size: i64) {
        let (start, steps) = (self.start[a], self.steps);
        // Cells from the start to the grid's nearest and farthest, in the line's direction.
        let (nearest, farthest) = match self.sign[a] {
            1 => (-start, size - 1 - start),
            -1 => (start - (size - 1), start),
            _ if (0..size).contains(&start) => return,
            _ => return self.last = -1,
        };
        // floor((2 n length + steps) / (2 steps)) >= nearest and <= farthest.
        let double = 2 * self.length[a];
        self.first = self.first.max(ceil_div(2 * steps * nearest - steps, double));
        self.last = self.last.min(ceil_div(2 * steps * (farthest + 1) - steps, double) - 1);
    }

    /// How many of its cells lie in the grid.
    #[inline(always)]
    pub fn cells(&self) -> u64 {
        (self.last - self.first + 1).max(0) as u64
    }

    /// A walk over the cells that begins with the n-th.
    #[inline(always)]
    pub fn from(&self, n: i64) -> Place {
        let double = 2 * self.steps.max(1);
        let mut walk = Place { cell: self.start, rest: [0; 3], line: *self };
        for a in 0..3 {
            let ahead = 2 * n * self.length[a] + self.steps;
            // In the direction of most steps, and without any, there is nothing to divide.
            let (moved, rest) = if self.length[a] == self.steps {
                (n, self.steps)
            } else if self.length[a] == 0 {
                (0, self.steps)
            } else {
                (ahead / double, ahead % double)
            };
            walk.cell[a] += self.sign[a] * moved;
            walk.rest[a] = rest;
        }
        walk
    }
}

/// A place on a line, which can move on along it or back.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Indices of the cell.
    pub cell: [i64; 3],
    /// Remainder (2 n length + steps) modulo 2 steps of each axis.
    rest: [i64; 3],
    line: BresenhamLine,
}

impl Place {
    /// Goes back to the cell before.
    #[inline(always)]
    pub fn back(&mut self) {
        let BresenhamLine { sign, length, steps, .. } = &self.line;
        for a in 0..3 {
            self.rest[a] -= 2 * length[a];
            let crossed = i64::from(self.rest[a] < 0);
            self.rest[a] += 2 * steps * crossed;
            self.cell[a] -= sign[a] * crossed;
        }
    }

    /// Visits so many cells from this one on, by their flat indices in a grid; all of them must lie in it.
    #[inline(always)]
    pub fn visit(self, strides: [usize; 3], count: u64, mut visit: impl FnMut(usize)) {
        let BresenhamLine { sign, length, steps, .. } = self.line;
        let stride = |a: usize| sign[a] * strides[a] as i64;
        let mut flat: i64 = (0..3).map(|a| self.cell[a] * strides[a] as i64).sum();
        // Along the longest axis every step moves; along the two others those that carry over.
        let longest = (0..3).find(|&a| length[a] == steps).unwrap_or(0);
        let [b, c] = [(longest + 1) % 3, (longest + 2) % 3];
        let minor = |a: usize| (self.rest[a], 2 * length[a], stride(a));
        let ((mut rest_b, grow_b, stride_b), (mut rest_c, grow_c, stride_c)) = (minor(b), minor(c));
        let (along, double) = (stride(longest), 2 * steps);
        for _ in 0..count {
            visit(flat as usize);
            rest_b += grow_b;
            rest_c += grow_c;
            let (carry_b, carry_c) = (-i64::from(rest_b >= double), -i64::from(rest_c >= double));
            rest_b -= double & carry_b;
            rest_c -= double & carry_c;
            flat += along + (stride_b & carry_b) + (stride_c & carry_c);
        }
    }
}

/// The least whole number that is not below a / b, b > 0.
fn ceil_div(a: i64, b: i64) -> i64 {
    -(-a).div_euclid(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Bresenham's algorithm as textbooks have it: the error of each minor axis grows, and where it is more
    /// than half, the line steps aside.
    fn textbook_line(start: [i64; 3], end: [i64; 3]) -> Vec<[i64; 3]> {
        let length: [i64; 3] = std::array::from_fn(|a| (end[a] - start[a]).abs());
        let n = length.into_iter().fold(0, i64::max);
        let (mut cell, mut error, mut cells) = (start, [n; 3], vec![start]);
        for _ in 0..n {
            for a in 0..3 {
                error[a] += 2 * length[a];
                if error[a] >= 2 * n {
                    error[a] -= 2 * n;
                    cell[a] += (end[a] - start[a]).signum();
                }
            }
            cells.push(cell);
        }
        cells
    }

    const SHAPE: [usize; 3] = [9, 7, 5];

    fn flat(cell: [i64; 3]) -> Option<usize> {
        let inside = (0..3).all(|a| (0..SHAPE[a] as i64).contains(&cell[a]));
        inside.then(|| ((cell[0] * 7 + cell[1]) * 5 + cell[2]) as usize)
    }

    fn index() -> impl Strategy<Value = [i64; 3]> {
        [-12..20_i64, -12..20_i64, -12..20_i64]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]
        #[test]
        fn the_line_is_bresenhams(start in index(), end in index()) {
            let expected = textbook_line(start, end);
            prop_assert_eq!(*expected.last().unwrap_or(&start), end);
            for pair in expected.windows(2) {
                prop_assert!((0..3).all(|a| (pair[0][a] - pair[1][a]).abs() <= 1));
            }
            let line = BresenhamLine::new(SHAPE, start, end);
            let mut walk = line.from(expected.len() as i64 - 1);
            for (n, cell) in expected.iter().enumerate().rev() {
                prop_assert_eq!(line.from(n as i64).cell, *cell);
                prop_assert_eq!(walk.cell, *cell);
                walk.back();
            }
            let mut visited = Vec::new();
            if line.cells() > 0 {
                line.from(line.first).visit([35, 5, 1], line.cells(), |flat| visited.push(flat));
            }
            prop_assert_eq!(visited, expected.into_iter().filter_map(flat).collect::<Vec<_>>());
        }
    }

    #[test]
    fn huge_distances_draw_nothing() {
        let far = i64::from(i32::MAX);
        assert_eq!(BresenhamLine::new(SHAPE, [0; 3], [far, 3, -far]).cells(), 0);
        assert_eq!(BresenhamLine::new(SHAPE, [far; 3], [far; 3]).cells(), 0);
        assert_eq!(BresenhamLine::new(SHAPE, [1 << 28, 3, 3], [-(1 << 28), 3, 3]).cells(), 9);
    }
}
