//! Arithmetic on image rows, written so that the compiler turns it into vector instructions.

/// A row of the left image and one of the right, so shifted that pixels at the same place are compared.
#[derive(Clone, Copy)]
pub(super) struct RowPair<'a> {
    pub left: &'a [u8],
    pub right: &'a [u8],
}

/// `sums[x] += |left[x] - right[x]|`.
#[inline(always)]
pub(super) fn add_differences(sums: &mut [u16], pair: RowPair<'_>) {
    for ((sum, l), r) in sums.iter_mut().zip(pair.left).zip(pair.right) {
        *sum += u16::from(l.abs_diff(*r));
    }
}

/// Moves column sums down by one row: adds the differences of the row that enters, takes off those of the row
/// that leaves.
#[inline(always)]
pub(super) fn slide_differences(sums: &mut [u16], enters: RowPair<'_>, leaves: RowPair<'_>) {
    let n = sums.len();
    let (l1, r1) = (&enters.left[..n], &enters.right[..n]);
    let (l0, r0) = (&leaves.left[..n], &leaves.right[..n]);
    for x in 0..n {
        let plus = u16::from(l1[x].abs_diff(r1[x]));
        let minus = u16::from(l0[x].abs_diff(r0[x]));
        // The leaving row is part of the sum, so the difference of the two never wraps below zero.
        sums[x] = sums[x].wrapping_add(plus).wrapping_sub(minus);
    }
}

/// `out[x] = (columns[x] + ... + columns[x + window - 1]) >> shift`, for all windows that fit.
#[inline(always)]
pub(super) fn window_sums(columns: &[u16], window: usize, shift: u32, out: &mut [u16]) {
    match (window, shift) {
        (3, 0) => fixed_sums::<3>(columns, out),
        (5, 0) => fixed_sums::<5>(columns, out),
        (7, 0) => fixed_sums::<7>(columns, out),
        (9, 0) => fixed_sums::<9>(columns, out),
        (11, 0) => fixed_sums::<11>(columns, out),
        _ => running_sums(columns, window, shift, out),
    }
}

#[inline(always)]
fn fixed_sums<const N: usize>(columns: &[u16], out: &mut [u16]) {
    let n = out.len();
    let shifted: [&[u16]; N] = std::array::from_fn(|k| &columns[k..k + n]);
    for x in 0..n {
        let mut sum = 0_u16;
        for row in &shifted {
            sum += row[x];
        }
        out[x] = sum;
    }
}

#[inline(always)]
fn running_sums(columns: &[u16], window: usize, shift: u32, out: &mut [u16]) {
    let mut sum: u32 = columns[..window - 1].iter().map(|&v| u32::from(v)).sum();
    for (x, cost) in out.iter_mut().enumerate() {
        sum += u32::from(columns[x + window - 1]);
        *cost = (sum >> shift) as u16;
        sum -= u32::from(columns[x]);
    }
}
