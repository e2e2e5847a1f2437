use evigrid_core::{GrayImage, NO_COST};
use multiversion::multiversion;
use rayon::prelude::*;

use crate::matching::{Buffers, Matching, Shape};
use crate::rows::{add_differences, slide_differences, window_sums};
use crate::winner::{LANES, RowCosts, is_unique, peak_ratio};
use crate::{BlockMatchingSettings, StereoError};

/// Block matching by the sum of absolute differences (SAD): cost volume, winner-take-all with a parabola for the
/// sub-pixel part, peak ratio, left-right difference.
///
/// Pixel (x, y) of the left image is compared with (x - d, y) of the right one. A hypothesis has a cost where its
/// window lies in both images. Buffers are kept from frame to frame.
#[derive(Debug)]
pub struct BlockMatcher {
    settings: BlockMatchingSettings,
    uniqueness_percent: u32,
    bands: Vec<Scratch>,
}

impl BlockMatcher {
    /// A matcher with these settings.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(settings: BlockMatchingSettings) -> Result<Self, StereoError> {
        Ok(Self { settings: settings.checked()?, uniqueness_percent: 0, bands: Vec::new() })
    }

    /// The same matcher, which drops a match if a hypothesis that is no neighbour of the winner costs less than
    /// `100 / (100 - percent)` times as much; 0 (at first) drops none. The rule is OpenCV's.
    #[must_use]
    pub fn with_uniqueness(self, percent: u32) -> Self {
        Self { uniqueness_percent: percent.min(99), ..self }
    }

    /// Matches a pair. `keep_volume` keeps all costs; `recycled` is the result of an earlier frame, whose buffers are
    /// filled again. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If the images differ in size or are smaller than the window.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        keep_volume: bool,
        recycled: Option<Matching>,
    ) -> Result<Matching, StereoError> {
        let job =
            Job { uniqueness_percent: self.uniqueness_percent, ..Job::new(self.settings, left, right)? };
        let mut out = Buffers::new(job.shape(), keep_volume, recycled);
        clear_border(&mut out, &job);
        let band_count = rayon::current_num_threads().clamp(1, job.rows());
        let band_rows = job.rows().div_ceil(band_count);
        self.bands.resize_with(band_count, Scratch::default);
        bands(&mut out, &job, band_rows)
            .into_par_iter()
            .zip(&mut self.bands)
            .for_each(|(band, scratch)| match_rows(&job, band, scratch));
        out.into_matching(job.shape())
    }
}

/// One pair to match.
struct Job<'a> {
    settings: BlockMatchingSettings,
    uniqueness_percent: u32,
    left: &'a GrayImage,
    right: &'a GrayImage,
}

impl<'a> Job<'a> {
    fn new(
        settings: BlockMatchingSettings,
        left: &'a GrayImage,
        right: &'a GrayImage,
    ) -> Result<Self, StereoError> {
        require_same_size(left, right)?;
        let (width, height) = (left.width(), left.height());
        let window = settings.window;
        if window > width.min(height) {
            return Err(StereoError::WindowTooLarge { window, width, height });
        }
        Ok(Self { settings, uniqueness_percent: 0, left, right })
    }

    fn shape(&self) -> Shape {
        let BlockMatchingSettings { min_disparity, disparities, .. } = self.settings;
        Shape { width: self.left.width(), height: self.left.height(), min_disparity, disparities }
    }

    fn width(&self) -> usize {
        self.left.width()
    }

    /// Rows whose window fits into the image.
    fn rows(&self) -> usize {
        self.left.height() - self.settings.window + 1
    }

    /// Length of a row of costs: the image's width, and as many columns as a search may run over its edge.
    fn stride(&self) -> usize {
        self.width() + self.settings.min_disparity + self.settings.disparities + LANES
    }
}

/// What one task needs for itself.
#[derive(Debug, Default)]
struct Scratch {
    /// Sum of absolute differences down the window, `[disparity][column]`.
    columns: Vec<u16>,
    /// Costs of the current row, `[disparity][stride]`.
    costs: Vec<u16>,
    /// Winner of every pixel of the current row, and of the right image's pixels.
    left_index: Vec<u16>,
    right_index: Vec<u16>,
}

impl Scratch {
    fn reset(&mut self, job: &Job<'_>) {
        let (d, w) = (job.settings.disparities, job.width());
        self.columns.clear();
        self.columns.resize(d * w, 0);
        self.costs.clear();
        self.costs.resize(d * job.stride(), NO_COST);
        self.left_index.clear();
        self.left_index.resize(w + LANES, 0);
        self.right_index.clear();
        self.right_index.resize(w + LANES, 0);
    }
}

/// The part of the output that one task fills.
struct Band<'a> {
    first_row: usize,
    disparity: &'a mut [f32],
    peak_ratio: &'a mut [f32],
    left_right: &'a mut [u16],
    volume: Option<&'a mut [u16]>,
}

/// Matches the rows of one band. The vector code is chosen for the processor at run time; all arithmetic is on
/// integers or single divisions, so every choice gives the same bytes.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn match_rows(job: &Job<'_>, mut band: Band<'_>, scratch: &mut Scratch) {
    scratch.reset(job);
    let width = job.width();
    for (i, y) in (band.first_row..).take(band.disparity.len() / width).enumerate() {
        update_columns(job, y, i == 0, scratch);
        update_costs(job, scratch);
        let row = i * width..(i + 1) * width;
        search_row(
            job,
            scratch,
            &mut band.disparity[row.clone()],
            &mut band.peak_ratio[row.clone()],
            &mut band.left_right[row],
        );
        if let Some(volume) = &mut band.volume {
            let len = job.shape().volume_row_len();
            copy_costs(job, scratch, &mut volume[i * len..(i + 1) * len]);
        }
    }
}

/// Column sums for the window around row `y`.
#[inline(always)]
fn update_columns(job: &Job<'_>, y: usize, first: bool, scratch: &mut Scratch) {
    let (radius, width) = (job.settings.radius(), job.width());
    for (d, columns) in scratch.columns.chunks_exact_mut(width).enumerate() {
        let shift = (job.settings.min_disparity + d).min(width);
        let columns = &mut columns[shift..];
        // Rows of both images, so that column x of the left faces x - d of the right.
        let rows = |y: usize| (&job.left.row(y)[shift..], &job.right.row(y)[..width - shift]);
        if first {
            for y in y - radius..=y + radius {
                add_differences(columns, rows(y).0, rows(y).1);
            }
        } else {
            slide_differences(columns, rows(y + radius), rows(y - radius - 1));
        }
    }
}

/// Costs of the current row from its column sums.
#[inline(always)]
fn update_costs(job: &Job<'_>, scratch: &mut Scratch) {
    let (window, radius, width) = (job.settings.window, job.settings.radius(), job.width());
    let (shift_bits, stride) = (job.settings.cost_shift(), job.stride());
    let columns = scratch.columns.chunks_exact(width);
    for (d, (columns, costs)) in columns.zip(scratch.costs.chunks_exact_mut(stride)).enumerate() {
        let shift = job.settings.min_disparity + d;
        if shift + window <= width {
            let fits = shift + radius..width - radius;
            window_sums(&columns[shift..], window, shift_bits, &mut costs[fits]);
        }
    }
}

/// Disparity, peak ratio and left-right difference of the current row.
#[inline(always)]
fn search_row(
    job: &Job<'_>,
    scratch: &mut Scratch,
    disparity: &mut [f32],
    ratio: &mut [f32],
    left_right: &mut [u16],
) {
    let (width, min_disparity) = (job.width(), job.settings.min_disparity);
    let costs =
        RowCosts { costs: &scratch.costs, stride: job.stride(), disparities: job.settings.disparities };
    for x in (0..width).step_by(LANES) {
        let winners = costs.search(x);
        scratch.left_index[x..x + LANES].copy_from_slice(&winners.index);
        scratch.right_index[x..x + LANES].copy_from_slice(&costs.search_right(x, min_disparity));
        for i in 0..LANES.min(width - x) {
            ratio[x + i] = peak_ratio(winners.first[i], winners.second[i]);
        }
        if job.uniqueness_percent > 0 {
            let runners_up = costs.runners_up(x, &winners.index);
            for i in 0..LANES.min(width - x) {
                if !is_unique(winners.first[i], runners_up[i], job.uniqueness_percent) {
                    ratio[x + i] = f32::NAN;
                }
            }
        }
    }
    for x in 0..width {
        if ratio[x].is_nan() {
            (disparity[x], left_right[x]) = (f32::NAN, u16::MAX);
            continue;
        }
        let index = scratch.left_index[x];
        let whole = min_disparity + usize::from(index);
        disparity[x] = whole as f32 + costs.vertex(x, usize::from(index));
        left_right[x] = index.abs_diff(scratch.right_index[x - whole]);
    }
}

/// Copies the current row's costs into the volume.
#[inline(always)]
fn copy_costs(job: &Job<'_>, scratch: &Scratch, volume: &mut [u16]) {
    let rows = scratch.costs.chunks_exact(job.stride());
    for (costs, row) in rows.zip(volume.chunks_exact_mut(job.width())) {
        row.copy_from_slice(&costs[..job.width()]);
    }
}

/// Rows above and below the first and last window hold "no match": what an earlier frame left there is overwritten.
fn clear_border(out: &mut Buffers, job: &Job<'_>) {
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

/// The inner rows, cut into bands of `band_rows` rows.
fn bands<'a>(out: &'a mut Buffers, job: &Job<'_>, band_rows: usize) -> Vec<Band<'a>> {
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

/// Refuses images of different size.
pub(crate) fn require_same_size(left: &GrayImage, right: &GrayImage) -> Result<(), StereoError> {
    if (right.width(), right.height()) == (left.width(), left.height()) {
        return Ok(());
    }
    Err(StereoError::Images(evigrid_core::CoreError::Size {
        what: "right image",
        expected_width: left.width(),
        expected_height: left.height(),
        width: right.width(),
        height: right.height(),
    }))
}
