//! Arithmetic on image rows, written so that the compiler turns it into vector instructions.

/// A row of the left image and one of the right, so shifted that pixels at the same place are compared.
#[derive(Clone, Copy)]
pub(crate) struct RowPair<'a> {
    pub left: &'a [u8],
    pub right: &'a [u8],
}

/// `sums[x] += |left[x] - right[x]|`.
#[inline(always)]
pub(crate) fn add_differences(sums: &mut [u16], pair: RowPair<'_>) {
    for ((sum, l), r) in sums.iter_mut().zip(pair.left).zip(pair.right) {
        *sum += u16::from(l.abs_diff(*r));
    }
}

/// Moves column sums down by one row: adds the differences of the row that enters, takes off those of the row
/// that leaves.
#[inline(always)]
pub(crate) fn slide_differences(sums: &mut [u16], enters: RowPair<'_>, leaves: RowPair<'_>) {
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

/// `out[x] = (columns[x] + ... + columns[x + window - 1]) >> shift`, for all windows that fit. `halves` is room for
/// partial sums.
#[inline(always)]
pub(crate) fn window_sums(columns: &[u16], window: usize, shift: u32, halves: &mut Halves, out: &mut [u16]) {
    match (window, shift) {
        (3, 0) => fixed_sums::<3>(columns, out),
        (5, 0) => fixed_sums::<5>(columns, out),
        (7, 0) => fixed_sums::<7>(columns, out),
        (9, 0) => fixed_sums::<9>(columns, out),
        (11, 0) => fixed_sums::<11>(columns, out),
        // Sums of eight columns of up to 31 pixels fit into 16 bits: 8 * 31 * 255 < 65536.
        (8..=31, _) => doubled_sums(columns, window, shift, halves, out),
        _ => running_sums(columns, window, shift, out),
    }
}

/// Sums over two, four and eight neighbouring columns.
#[derive(Debug, Default)]
pub(crate) struct Halves {
    two: Vec<u16>,
    four: Vec<u16>,
    eight: Vec<u16>,
}

/// A window is made of blocks of eight columns, and of a block of four, one of two and a single one as its size
/// asks; every step is one addition per pixel, side by side.
#[inline(always)]
fn doubled_sums(columns: &[u16], window: usize, shift: u32, halves: &mut Halves, out: &mut [u16]) {
    let n = out.len() + window - 1;
    let columns = &columns[..n];
    pair_sums(columns, 1, &mut halves.two);
    pair_sums(&halves.two, 2, &mut halves.four);
    pair_sums(&halves.four, 4, &mut halves.eight);
    let rest = window / 8 * 8;
    let parts: [(&[u16], bool, usize); 3] = [
        (&halves.four, window & 4 != 0, rest),
        (&halves.two, window & 2 != 0, rest + (window & 4)),
        (columns, window & 1 != 0, rest + (window & 6)),
    ];
    let nothing: &[u16] = &[];
    let [four, two, one] = parts.map(|(sums, is_used, start)| if is_used { &sums[start..] } else { nothing });
    match (window / 8, four.is_empty(), two.is_empty(), one.is_empty()) {
        // 21 columns, the window of Perrollaz et al. 2012, in one go.
        (2, false, true, false) => {
            let (first, second) = (&halves.eight[..out.len()], &halves.eight[8..][..out.len()]);
            let (four, one) = (&four[..out.len()], &one[..out.len()]);
            for x in 0..out.len() {
                let sum = u32::from(first[x]) + u32::from(second[x]) + u32::from(four[x]) + u32::from(one[x]);
                out[x] = (sum >> shift) as u16;
            }
        }
        (eights, ..) => {
            for (x, out) in out.iter_mut().enumerate() {
                let eights = (0..eights).map(|k| u32::from(halves.eight[x + 8 * k])).sum::<u32>();
                let rest: u32 =
                    [four, two, one].iter().filter_map(|part| part.get(x)).map(|&v| u32::from(v)).sum();
                *out = ((eights + rest) >> shift) as u16;
            }
        }
    }
}

/// `out[x] = sums[x] + sums[x + apart]`, for all pairs that fit.
#[inline(always)]
fn pair_sums(sums: &[u16], apart: usize, out: &mut Vec<u16>) {
    let n = sums.len() - apart;
    out.resize(n, 0);
    let (first, second, out) = (&sums[..n], &sums[apart..][..n], &mut out[..n]);
    for x in 0..n {
        out[x] = first[x] + second[x];
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
