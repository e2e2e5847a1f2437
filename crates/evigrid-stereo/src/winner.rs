//! The search along the cost curves of one row: winner, peak ratio, sub-pixel part, and the right image's
//! winners.

use evigrid_core::NO_COST;

/// Pixels that are searched side by side.
pub(crate) const LANES: usize = 16;

/// The costs of one row, `[disparity][column]`. Rows are `stride` long; the columns from the image's width on
/// hold [`NO_COST`], so that the search may run over the edge.
#[derive(Clone, Copy)]
pub(crate) struct RowCosts<'a> {
    pub costs: &'a [u16],
    pub stride: usize,
    pub disparities: usize,
}

/// Winners and minima of [`LANES`] neighbouring pixels.
pub(crate) struct Winners {
    /// Index of the lowest cost; ties go to the smaller disparity.
    pub index: [u16; LANES],
    /// Lowest local minimum, which is the lowest cost; [`NO_COST`] if there is no cost at all.
    pub first: [u16; LANES],
    /// Second lowest local minimum; [`NO_COST`] if there is none.
    pub second: [u16; LANES],
}

impl RowCosts<'_> {
    #[inline(always)]
    fn lanes(&self, d: usize, x: usize) -> &[u16; LANES] {
        let start = d * self.stride + x;
        self.costs[start..start + LANES].first_chunk().unwrap_or(&[NO_COST; LANES])
    }

    /// Winners and the two lowest local minima of the pixels `x .. x + LANES`. The ends of a curve may be
    /// minima, and a plateau counts once: a minimum ends where the cost strictly rises after its last strict
    /// change was a fall.
    #[inline(always)]
    pub fn search(&self, x: usize) -> Winners {
        let mut before = [NO_COST; LANES];
        let mut falling = [0_u16; LANES];
        let (mut index, mut lowest) = ([0_u16; LANES], [NO_COST; LANES]);
        let (mut first, mut second) = ([NO_COST; LANES], [NO_COST; LANES]);
        for d in 0..self.disparities {
            let cost = self.lanes(d, x);
            for i in 0..LANES {
                let rises = if cost[i] > before[i] { u16::MAX } else { 0 };
                let falls = if cost[i] < before[i] { u16::MAX } else { 0 };
                let minimum = before[i] | !(rises & falling[i]);
                second[i] = second[i].min(first[i].max(minimum));
                first[i] = first[i].min(minimum);
                falling[i] = (falling[i] | falls) & !rises;
                index[i] = if cost[i] < lowest[i] { d as u16 } else { index[i] };
                lowest[i] = lowest[i].min(cost[i]);
                before[i] = cost[i];
            }
        }
        for i in 0..LANES {
            let minimum = before[i] | !falling[i];
            second[i] = second[i].min(first[i].max(minimum));
            first[i] = first[i].min(minimum);
        }
        Winners { index, first, second }
    }

    /// Index of the lowest cost of the RIGHT image's pixels `x .. x + LANES`, whose match in the left image
    /// lies `min_disparity + index` columns to the right; `u16::MAX` where there is none.
    #[inline(always)]
    pub fn search_right(&self, x: usize, min_disparity: usize) -> [u16; LANES] {
        let (mut index, mut lowest) = ([u16::MAX; LANES], [NO_COST; LANES]);
        for d in 0..self.disparities {
            let cost = self.lanes(d, x + min_disparity + d);
            for i in 0..LANES {
                index[i] = if cost[i] < lowest[i] { d as u16 } else { index[i] };
                lowest[i] = lowest[i].min(cost[i]);
            }
        }
        index
    }

    /// Lowest cost of each of the pixels `x .. x + LANES` among the hypotheses that are neither its winner
    /// (`index`) nor a neighbour of that; [`NO_COST`] if there is none.
    #[inline(always)]
    pub fn runners_up(&self, x: usize, index: &[u16; LANES]) -> [u16; LANES] {
        let mut lowest = [NO_COST; LANES];
        for d in 0..self.disparities {
            let cost = self.lanes(d, x);
            for i in 0..LANES {
                let near = if index[i].abs_diff(d as u16) <= 1 { NO_COST } else { 0 };
                lowest[i] = lowest[i].min(cost[i] | near);
            }
        }
        lowest
    }

    /// Offset of the vertex of the parabola through the winner and its two neighbours, within -0.5..0.5; 0
    /// where a neighbour is missing or the three are equal.
    #[inline(always)]
    pub fn vertex(&self, x: usize, index: usize) -> f32 {
        if index == 0 || index + 1 == self.disparities {
            return 0.0;
        }
        let at = |d: usize| self.costs[d * self.stride + x];
        parabola_vertex(at(index - 1), at(index), at(index + 1))
    }
}

/// Offset of the vertex of the parabola through three neighbouring costs, the middle one the lowest; 0 where
/// one of them is missing or the three are equal.
#[inline(always)]
pub(crate) fn parabola_vertex(before: u16, cost: u16, after: u16) -> f32 {
    if before == NO_COST || after == NO_COST {
        return 0.0;
    }
    let [before, cost, after] = [before, cost, after].map(i32::from);
    let curvature = before - 2 * cost + after;
    if curvature > 0 { 0.5 * (before - after) as f32 / curvature as f32 } else { 0.0 }
}

/// Whether the runner-up costs at least `100 / (100 - percent)` times as much as the winner.
#[inline(always)]
pub(crate) fn is_unique(first: u16, runner_up: u16, percent: u32) -> bool {
    runner_up == NO_COST || u32::from(runner_up) * (100 - percent) >= 100 * u32::from(first)
}

/// Second over first local minimum: infinite if there is no second or the first is 0 and the second is not.
#[inline(always)]
pub(crate) fn peak_ratio(first: u16, second: u16) -> f32 {
    match (first, second) {
        (NO_COST, _) => f32::NAN,
        (_, NO_COST) => f32::INFINITY,
        (0, 0) => 1.0,
        (first, second) => f32::from(second) / f32::from(first),
    }
}
