//! A pass over the image: block costs, and half of the paths through every pixel.

use multiversion::multiversion;

use super::block_costs::BlockCosts;
use super::finish::{OutRows, RowSearch};
use super::job::Job;
use super::paths::{Along, Arrival, Before, Line, advance_paths, no_path};
use super::pixel_costs::{AbsoluteDifference, BirchfieldTomasi, Census, Cost};
use super::settings::PixelCost;
use super::travel::{Offset, Travel};

/// Memory of one pass, from row to row and from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Pass {
    blocks: BlockCosts,
    /// Paths along the row: the pixel before and the current one, swapped at every step.
    along: Along,
    /// Paths from the row before: from the position before, the same, the next.
    lines: [Line; 3],
    no_path: Vec<u16>,
    /// The sums of the current row, `[column][hypothesis]`.
    row: Vec<u16>,
    search: RowSearch,
    size: (usize, usize, usize),
}

/// Number of slots by which each line moves down with every row, so that a path always comes from the slot
/// after its own.
const DRIFTS: [usize; 3] = [2, 1, 0];

impl Pass {
    /// Makes room for a pair.
    pub fn resize(&mut self, job: &Job<'_>) {
        let (width, height, padded) = (job.shape.width, job.shape.height, job.padded);
        self.blocks.resize(job);
        self.search.resize(job);
        if self.size == (width, height, padded) {
            return;
        }
        self.size = (width, height, padded);
        self.along.resize(padded);
        for (line, drift) in self.lines.iter_mut().zip(DRIFTS) {
            line.resize(width + 1 + drift * height, padded);
        }
        self.no_path = no_path(padded);
        self.row.clear();
        self.row.resize(width * padded, 0);
    }
}

/// The sums of the paths of a half of the image, `[row][column][hypothesis]`.
pub(super) enum Sums<'a> {
    /// The first pass to come by leaves them.
    Leave(&'a mut [u16]),
    /// The second adds its own and finishes the rows.
    Finish(&'a [u16], OutRows<'a>),
}

/// Goes over the rows `steps` of a pass, which continue where it stopped. `first_row` is the image's row at
/// which `sums` begin. The vector code is chosen for the processor at run time; all arithmetic is on integers
/// or single divisions, so every choice gives the same bytes.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2", "aarch64+neon"))]
pub(super) fn run_steps(
    job: &Job<'_>,
    pass: &mut Pass,
    travel: Travel,
    steps: std::ops::Range<usize>,
    first_row: usize,
    mut sums: Sums<'_>,
) {
    for step in steps {
        let row = travel.row(step) - first_row;
        match job.settings.pixel_cost {
            PixelCost::AbsoluteDifference => {
                run_row::<AbsoluteDifference>(job, pass, travel, step, row, &mut sums)
            }
            PixelCost::BirchfieldTomasi => {
                run_row::<BirchfieldTomasi>(job, pass, travel, step, row, &mut sums)
            }
            PixelCost::Census => run_row::<Census>(job, pass, travel, step, row, &mut sums),
        }
    }
}

#[inline(always)]
fn run_row<C: Cost>(
    job: &Job<'_>,
    pass: &mut Pass,
    travel: Travel,
    step: usize,
    row: usize,
    sums: &mut Sums<'_>,
) {
    let len = job.shape.width * job.padded;
    let place = row * len..(row + 1) * len;
    let mut own = std::mem::take(&mut pass.row);
    paths_of_row::<C>(job, pass, travel, step, &mut own);
    match sums {
        Sums::Leave(left) => left[place].copy_from_slice(&own),
        Sums::Finish(left, out) => pass.search.finish_row(job, &mut own, &left[place], out, row),
    }
    pass.row = own;
}

/// Path costs of all pixels of a row; their sums go to `sums`.
#[inline(always)]
fn paths_of_row<C: Cost>(job: &Job<'_>, pass: &mut Pass, travel: Travel, step: usize, sums: &mut [u16]) {
    let (width, padded) = (job.shape.width, job.padded);
    let rows = pass.blocks.begin_row::<C>(job, travel, step);
    for position in 0..width {
        if position > 0 {
            pass.blocks.advance::<C>(job, travel, step, &rows, position);
        }
        let x = travel.column(position);
        let place = x * padded..(x + 1) * padded;
        let place = Place { travel, step, position, sums: &mut sums[place] };
        if job.settings.paths == 8 { eight_paths(job, pass, place) } else { four_paths(job, pass, place) }
    }
}

/// A pixel on the way of a pass, and where the sum of its paths goes.
struct Place<'a> {
    travel: Travel,
    step: usize,
    position: usize,
    sums: &'a mut [u16],
}

/// The path along the row and the three from the row before.
#[inline(always)]
fn eight_paths(job: &Job<'_>, pass: &mut Pass, place: Place<'_>) {
    let Place { travel, step, position, sums } = place;
    let nothing = Before { curve: &pass.no_path, lowest: 0 };
    let slot = |line: usize| position + DRIFTS[line] * (travel.height - 1 - step);
    let [before, same, after] = &mut pass.lines;
    let (b0, n0, l0) = pass.along.step();
    let (b1, n1, l1) = before.slots(slot(0), job.padded);
    let (b2, n2, l2) = same.slots(slot(1), job.padded);
    let (b3, n3, l3) = after.slots(slot(2), job.padded);
    let (first_row, first, last) = (step == 0, position == 0, position + 1 == travel.width);
    let p2 = |positions, steps| job.p2(travel, position, step, Offset { positions, steps });
    let arrivals = [
        Arrival { before: if first { nothing } else { b0 }, p2: p2(-1, 0) },
        Arrival { before: if first || first_row { nothing } else { b1 }, p2: p2(-1, -1) },
        Arrival { before: if first_row { nothing } else { b2 }, p2: p2(0, -1) },
        Arrival { before: if last || first_row { nothing } else { b3 }, p2: p2(1, -1) },
    ];
    let lowest = advance_paths(pass.blocks.costs(), job.p1, &arrivals, [n0, n1, n2, n3], sums);
    [*l0, *l1, *l2, *l3] = lowest;
}

/// The path along the row and the one down the column.
#[inline(always)]
fn four_paths(job: &Job<'_>, pass: &mut Pass, place: Place<'_>) {
    let Place { travel, step, position, sums } = place;
    let nothing = Before { curve: &pass.no_path, lowest: 0 };
    let slot = position + DRIFTS[1] * (travel.height - 1 - step);
    let (b0, n0, l0) = pass.along.step();
    let (b1, n1, l1) = pass.lines[1].slots(slot, job.padded);
    let p2 = |positions, steps| job.p2(travel, position, step, Offset { positions, steps });
    let arrivals = [
        Arrival { before: if position == 0 { nothing } else { b0 }, p2: p2(-1, 0) },
        Arrival { before: if step == 0 { nothing } else { b1 }, p2: p2(0, -1) },
    ];
    let lowest = advance_paths(pass.blocks.costs(), job.p1, &arrivals, [n0, n1], sums);
    [*l0, *l1] = lowest;
}
