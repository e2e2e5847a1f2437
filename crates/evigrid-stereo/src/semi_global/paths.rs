//! The recursion along paths (Hirschmueller 2008, eq. 13).

use super::block_costs::MISSING;
use super::pixel_costs::CHUNK;

/// Values before each curve: the last one stands for the hypothesis below the smallest, the rest keeps curves
/// aligned.
const LEAD: usize = CHUNK;

/// The path costs of the pixels that paths of one direction come from. Each pixel of a row overwrites the one
/// that its predecessor came from, so a row takes no more memory than its pixels.
#[derive(Debug, Default)]
pub(super) struct Line {
    /// Path costs, `[slot][LEAD + hypothesis]`, and one more lead; leads hold [`MISSING`].
    values: Vec<u16>,
    /// The lowest path cost of each slot.
    lowest: Vec<u16>,
}

/// Path costs of the pixel before, in one direction.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    /// Path costs of all hypotheses, the lead included.
    pub curve: &'a [u16],
    /// The lowest path cost.
    pub lowest: u16,
}

/// Way in which paths of one direction arrive at a pixel.
#[derive(Clone, Copy)]
pub(super) struct Arrival<'a> {
    pub before: Before<'a>,
    /// Penalty for a step of more than one hypothesis.
    pub p2: u16,
}

impl Line {
    /// Room for `slots` curves of `padded` hypotheses.
    pub fn resize(&mut self, slots: usize, padded: usize) {
        let stride = LEAD + padded;
        self.values.clear();
        self.values.resize(slots * stride + LEAD, MISSING);
        self.lowest.clear();
        self.lowest.resize(slots, 0);
    }

    /// The curve of slot `slot + 1`, from which a path comes, that of `slot`, to which it goes, and where the
    /// lowest value of that goes.
    #[inline(always)]
    pub fn slots(&mut self, slot: usize, padded: usize) -> (Before<'_>, &mut [u16], &mut u16) {
        let stride = LEAD + padded;
        let (to, from) = self.values.split_at_mut((slot + 1) * stride);
        let (to_lowest, from_lowest) = self.lowest.split_at_mut(slot + 1);
        let lowest = from_lowest.first().copied().unwrap_or(0);
        let before = Before { curve: &from[..stride + 1], lowest };
        (before, &mut to[slot * stride + LEAD..], &mut to_lowest[slot])
    }
}

/// The path costs of the current pixel and the one before it in the same row.
#[derive(Debug, Default)]
pub(super) struct Along {
    before: Vec<u16>,
    next: Vec<u16>,
    lowest: u16,
}

impl Along {
    /// Room for curves of `padded` hypotheses.
    pub fn resize(&mut self, padded: usize) {
        for curve in [&mut self.before, &mut self.next] {
            curve.clear();
            curve.resize(2 * LEAD + padded, MISSING);
        }
    }

    /// Moves on to the next pixel: the curve of the one before, and where its own and the lowest value of
    /// that go.
    #[inline(always)]
    pub fn step(&mut self) -> (Before<'_>, &mut [u16], &mut u16) {
        std::mem::swap(&mut self.before, &mut self.next);
        (Before { curve: &self.before, lowest: self.lowest }, &mut self.next[LEAD..], &mut self.lowest)
    }
}

/// A curve for paths that begin: nothing comes before them.
pub(super) fn no_path(padded: usize) -> Vec<u16> {
    vec![0; LEAD + padded + 1]
}

/// Path costs of one pixel for `N` directions at once: `costs[d] + min(before[d], before[d - 1] + p1,
/// before[d + 1] + p1, lowest + p2) - lowest`. Their sum over the directions goes to `sums`. Returns the
/// lowest path cost of each direction.
#[inline(always)]
pub(super) fn advance_paths<const N: usize>(
    costs: &[u16],
    p1: u16,
    arrivals: &[Arrival<'_>; N],
    next: [&mut [u16]; N],
    sums: &mut [u16],
) -> [u16; N] {
    let mut lowest = [[u16::MAX; CHUNK]; N];
    let chunks = costs.as_chunks::<CHUNK>().0.iter().zip(sums.as_chunks_mut::<CHUNK>().0);
    for (c, (costs, sums)) in chunks.enumerate() {
        let at = c * CHUNK;
        let mut total = [0_u16; CHUNK];
        for k in 0..N {
            // The hypotheses of this chunk and one more on either side.
            let around = &arrivals[k].before.curve[LEAD - 1 + at..LEAD + 1 + at + CHUNK];
            let lowest_before = arrivals[k].before.lowest;
            let jump = lowest_before + arrivals[k].p2;
            let mut path = [0_u16; CHUNK];
            for i in 0..CHUNK {
                let best = around[i + 1].min(around[i].min(around[i + 2]) + p1).min(jump);
                path[i] = costs[i] + (best - lowest_before);
                // Where there is no hypothesis, the sum means nothing.
                total[i] = total[i].wrapping_add(path[i]);
                lowest[k][i] = lowest[k][i].min(path[i]);
            }
            next[k][at..at + CHUNK].copy_from_slice(&path);
        }
        *sums = total;
    }
    let mut out = [u16::MAX; N];
    for k in 0..N {
        for value in lowest[k] {
            out[k] = out[k].min(value);
        }
    }
    out
}
