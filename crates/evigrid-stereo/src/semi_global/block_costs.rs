//! The cost of a block under every hypothesis: pixel costs summed over a square by running sums, computed
//! while a pass goes over the image, so that they are never stored as a whole.

use super::job::Job;
use super::pixel_costs::{CHUNK, Cost, MAX_PLANES, PlaneRow};
use super::travel::Travel;

/// The cost of a hypothesis that does not exist: above any path cost by more than all penalties, and small
/// enough that penalties can be added to it.
pub(super) const MISSING: u16 = i16::MAX as u16;

/// Running sums of one pass. Positions count along the pass' direction of travel.
#[derive(Debug, Default)]
pub(super) struct BlockCosts {
    /// Sums down the block, `[position][hypothesis]`.
    columns: Vec<u16>,
    /// Sum over the block around the current pixel.
    block: Vec<u16>,
    /// Costs of the block: the sum divided, [`MISSING`] where there is no hypothesis.
    costs: Vec<u16>,
}

/// Rows of pixels that enter and leave the columns when a pass moves on by a row.
pub(super) struct Rows<'a> {
    entering: PlaneRow<'a>,
    leaving: PlaneRow<'a>,
}

impl BlockCosts {
    pub fn resize(&mut self, job: &Job<'_>) {
        self.columns.resize(job.shape.width * job.padded, 0);
        self.block.resize(job.padded, 0);
        self.costs.resize(job.padded, 0);
    }

    /// Begins row `step` of a pass; the costs are those of the row's first pixel.
    #[inline(always)]
    pub fn begin_row<'a, C: Cost>(&mut self, job: &'a Job<'_>, travel: Travel, step: usize) -> Rows<'a> {
        let (radius, last) = (job.settings.radius() as isize, job.shape.width - 1);
        let row = |offset: isize| job.planes.row(travel.row_near(step, offset));
        if step == 0 {
            self.columns.fill(0);
            for offset in -radius..=radius {
                for position in 0..=last {
                    add_pixels::<C>(job, row(offset), travel.column(position), self.column(job, position));
                }
            }
        }
        let rows = Rows { entering: row(radius), leaving: row(-radius - 1) };
        self.block.fill(0);
        for offset in -radius..=radius {
            let position = offset.clamp(0, last as isize) as usize;
            if step > 0 && offset == position as isize {
                slide_pixels::<C>(job, &rows, travel.column(position), self.column(job, position));
            }
        }
        for offset in -radius..=radius {
            let position = offset.clamp(0, last as isize) as usize;
            let column = &self.columns[position * job.padded..(position + 1) * job.padded];
            self.block.iter_mut().zip(column).for_each(|(sum, cost)| *sum += cost);
        }
        self.finish(job, travel.column(0));
        rows
    }

    /// Moves on to `position`, one after that before.
    #[inline(always)]
    pub fn advance<C: Cost>(
        &mut self,
        job: &Job<'_>,
        travel: Travel,
        step: usize,
        rows: &Rows<'_>,
        position: usize,
    ) {
        let (radius, last, padded) = (job.settings.radius(), job.shape.width - 1, job.padded);
        let entering = position + radius;
        if entering <= last && step > 0 {
            slide_pixels::<C>(job, rows, travel.column(entering), self.column(job, entering));
        }
        let entering = &self.columns[entering.min(last) * padded..][..padded];
        let leaving = &self.columns[(position - 1).saturating_sub(radius) * padded..][..padded];
        let block = self.block.as_chunks_mut::<CHUNK>().0;
        let columns = entering.as_chunks::<CHUNK>().0.iter().zip(leaving.as_chunks::<CHUNK>().0);
        let shift = job.cost_shift;
        for ((sum, costs), (plus, minus)) in
            block.iter_mut().zip(self.costs.as_chunks_mut::<CHUNK>().0).zip(columns)
        {
            for i in 0..CHUNK {
                sum[i] = sum[i].wrapping_add(plus[i]).wrapping_sub(minus[i]);
                costs[i] = sum[i] >> shift;
            }
        }
        let hypotheses = job.hypotheses(travel.column(position));
        if hypotheses < padded {
            self.costs[hypotheses..].fill(MISSING);
        }
    }

    /// The costs of the current pixel.
    #[inline(always)]
    pub fn costs(&self) -> &[u16] {
        &self.costs
    }

    fn finish(&mut self, job: &Job<'_>, x: usize) {
        for (cost, sum) in self.costs.iter_mut().zip(&self.block) {
            *cost = sum >> job.cost_shift;
        }
        self.costs[job.hypotheses(x)..].fill(MISSING);
    }

    #[inline(always)]
    fn column(&mut self, job: &Job<'_>, position: usize) -> &mut [u16] {
        &mut self.columns[position * job.padded..(position + 1) * job.padded]
    }
}

/// Adds the costs of a pixel to its column.
#[inline(always)]
fn add_pixels<C: Cost>(job: &Job<'_>, row: PlaneRow<'_>, x: usize, column: &mut [u16]) {
    let (left, right) = (row.left::<C>(x), row.right::<C>(x, job.shape.min_disparity, job.padded));
    for (c, sums) in column.as_chunks_mut::<CHUNK>().0.iter_mut().enumerate() {
        let costs = C::costs(&left, chunk(&right, c));
        for i in 0..CHUNK {
            sums[i] += u16::from(costs[i]);
        }
    }
}

/// Adds the costs of the pixel that enters a column, takes off those of the one that leaves.
#[inline(always)]
fn slide_pixels<C: Cost>(job: &Job<'_>, rows: &Rows<'_>, x: usize, column: &mut [u16]) {
    let Rows { entering, leaving } = rows;
    let (left_in, right_in) =
        (entering.left::<C>(x), entering.right::<C>(x, job.shape.min_disparity, job.padded));
    let (left_out, right_out) =
        (leaving.left::<C>(x), leaving.right::<C>(x, job.shape.min_disparity, job.padded));
    for (c, sums) in column.as_chunks_mut::<CHUNK>().0.iter_mut().enumerate() {
        let plus = C::costs(&left_in, chunk(&right_in, c));
        let minus = C::costs(&left_out, chunk(&right_out, c));
        for i in 0..CHUNK {
            sums[i] = sums[i].wrapping_add(u16::from(plus[i])).wrapping_sub(u16::from(minus[i]));
        }
    }
}

#[inline(always)]
fn chunk<'a>(planes: &[&'a [[u8; CHUNK]]; MAX_PLANES], c: usize) -> [&'a [u8; CHUNK]; MAX_PLANES] {
    let [p0, p1, p2, p3, p4, p5] = planes;
    [&p0[c], &p1[c], &p2[c], &p3[c], &p4[c], &p5[c]]
}
