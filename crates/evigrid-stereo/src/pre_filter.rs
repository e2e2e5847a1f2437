//! Filters that the images go through before matching, so that brightness counts less and texture more (Souza
//! et al. 2012, section 4.1: "a previous filtering of the images to normalize brightness and texture
//! enhancement").

use evigrid_core::{CoreError, GrayImage};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A filter that both images go through before they are matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PreFilter {
    /// The images as they are.
    #[default]
    None,
    /// The horizontal Sobel response (OpenCV: PREFILTER_XSOBEL).
    SobelX,
    /// The grey level minus the mean of a window, rounded down (as OpenCV's PREFILTER_NORMALIZED_RESPONSE,
    /// which also blurs the first).
    Normalized,
}

impl PreFilter {
    /// The filtered image: responses clipped to `-cap ..= cap`, plus `cap` (at most 127). `window` (odd) is
    /// the edge of the window of the mean; borders are repeated outwards. Without a filter, the image itself.
    ///
    /// # Errors
    /// Never for an image.
    pub fn apply(self, image: &GrayImage, cap: usize, window: usize) -> Result<GrayImage, CoreError> {
        let (width, height) = (image.width(), image.height());
        let mut out = vec![0; width * height];
        match self {
            Self::None => out.copy_from_slice(image.pixels()),
            Self::SobelX => {
                out.chunks_exact_mut(width).enumerate().for_each(|(y, row)| sobel_x(image, y, cap, row));
            }
            Self::Normalized => {
                let (cap, pixels) = (cap as i32, (window * window) as u32);
                for_each_box_sum(image, window, |y, sums| {
                    let row = out[y * width..(y + 1) * width].iter_mut();
                    for ((out, &pixel), sum) in row.zip(image.row(y)).zip(sums) {
                        let response = i32::from(pixel) - (sum / pixels) as i32;
                        *out = (response.clamp(-cap, cap) + cap) as u8;
                    }
                });
            }
        }
        GrayImage::new(width, height, out)
    }
}

/// The horizontal Sobel response of row `y`, clipped to `-cap ..= cap`, plus `cap`. The border is repeated
/// outwards.
pub(crate) fn sobel_x(image: &GrayImage, y: usize, cap: usize, out: &mut [u8]) {
    let (last_x, last_y) = (image.width() - 1, image.height() - 1);
    let [above, here, below] = [y.saturating_sub(1), y, (y + 1).min(last_y)].map(|y| image.row(y));
    let cap = cap as i16;
    let column = |x: usize| i16::from(above[x]) + 2 * i16::from(here[x]) + i16::from(below[x]);
    let clipped = |response: i16| (response.clamp(-cap, cap) + cap) as u8;
    out[0] = clipped(column(1.min(last_x)) - column(0));
    out[last_x] = clipped(column(last_x) - column(last_x.saturating_sub(1)));
    let shifted = |by: usize| {
        let rows = above[by..].iter().zip(&here[by..]).zip(&below[by..]);
        rows.map(|((a, h), b)| i16::from(*a) + 2 * i16::from(*h) + i16::from(*b))
    };
    if let Some(inner) = out.get_mut(1..last_x) {
        let responses = shifted(2.min(last_x)).zip(shifted(0));
        inner.iter_mut().zip(responses).for_each(|(out, (right, left))| *out = clipped(right - left));
    }
}

/// Texture around every pixel, row-major: the sum over a window (odd edge) of the absolute horizontal Sobel
/// response, clipped to `cap` (at most 127); grey levels. The border is repeated outwards. OpenCV compares it
/// with `textureThreshold`.
///
/// # Errors
/// Never for an image.
pub fn texture(image: &GrayImage, cap: usize, window: usize) -> Result<Vec<u32>, CoreError> {
    let sobel = PreFilter::SobelX.apply(image, cap, window)?;
    let strength = sobel.pixels().iter().map(|&v| v.abs_diff(cap as u8)).collect();
    let strength = GrayImage::new(image.width(), image.height(), strength)?;
    let mut out = Vec::with_capacity(image.width() * image.height());
    for_each_box_sum(&strength, window, |_, sums| out.extend_from_slice(sums));
    Ok(out)
}

/// Gives the sums over the windows around the pixels of each row, from the first row on, by running sums.
fn for_each_box_sum(image: &GrayImage, window: usize, mut visit: impl FnMut(usize, &[u32])) {
    let (width, radius) = (image.width(), (window / 2) as isize);
    let row = |y: usize, offset: isize| image.row(near(y, offset, image.height()));
    let mut columns = vec![0_u32; width];
    let mut sums = vec![0_u32; width];
    for y in 0..image.height() {
        let entering = if y == 0 { -radius..=radius } else { radius..=radius };
        for offset in entering {
            columns.iter_mut().zip(row(y, offset)).for_each(|(sum, v)| *sum += u32::from(*v));
        }
        if y > 0 {
            let leaving = row(y - 1, -radius);
            columns.iter_mut().zip(leaving).for_each(|(sum, v)| *sum -= u32::from(*v));
        }
        let mut sum: u32 = (-radius..=radius).map(|offset| columns[near(0, offset, width)]).sum();
        for (x, out) in sums.iter_mut().enumerate() {
            *out = sum;
            sum += columns[near(x, radius + 1, width)];
            sum -= columns[near(x, -radius, width)];
        }
        visit(y, &sums);
    }
}

fn near(at: usize, offset: isize, len: usize) -> usize {
    at.saturating_add_signed(offset).min(len - 1)
}
