use evigrid_core::NO_COST;

use super::job::Job;
use crate::buffers::Buffers;

/// Rows of the output that one task fills.
pub(crate) struct Band<'a> {
    pub first_row: usize,
    pub disparity: &'a mut [f32],
    pub peak_ratio: &'a mut [f32],
    pub left_right: &'a mut [u16],
    pub volume: Option<&'a mut [u16]>,
}

/// The rows whose window fits into the image, cut into bands of `band_rows` rows.
pub(crate) fn bands<'a>(out: &'a mut Buffers, job: &Job<'_>, band_rows: usize) -> Vec<Band<'a>> {
    let (width, top) = (job.width(), job.settings.radius());
    let pixels = top * width..(top + job.rows()) * width;
    let row_len = job.shape().volume_row_len();
    let mut volumes = out
        .volume
        .as_mut()
        .map(|v| v[top * row_len..(top + job.rows()) * row_len].chunks_mut(band_rows * row_len));
    out.disparity[pixels.clone()]
        .chunks_mut(band_rows * width)
        .zip(out.peak_ratio[pixels.clone()].chunks_mut(band_rows * width))
        .zip(out.left_right[pixels].chunks_mut(band_rows * width))
        .enumerate()
        .map(|(i, ((disparity, peak_ratio), left_right))| Band {
            first_row: top + i * band_rows,
            disparity,
            peak_ratio,
            left_right,
            volume: volumes.as_mut().and_then(Iterator::next),
        })
        .collect()
}

/// Writes "no match" into the rows above and below the first and last window, over the values of an earlier
/// frame.
pub(crate) fn clear_border(out: &mut Buffers, job: &Job<'_>) {
    let (top, row_len) = (job.settings.radius(), job.shape().volume_row_len());
    for rows in [0..top, top + job.rows()..job.left.height()] {
        let pixels = rows.start * job.width()..rows.end * job.width();
        out.disparity[pixels.clone()].fill(f32::NAN);
        out.peak_ratio[pixels.clone()].fill(f32::NAN);
        out.left_right[pixels].fill(u16::MAX);
        if let Some(volume) = &mut out.volume {
            volume[rows.start * row_len..rows.end * row_len].fill(NO_COST);
        }
    }
}
