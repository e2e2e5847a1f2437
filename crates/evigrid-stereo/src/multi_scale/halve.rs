use evigrid_core::{CoreError, GrayImage};
use rayon::prelude::*;

/// The image at half its resolution: each pixel is the mean of 2x2 pixels, rounded to the nearest whole
/// number (halves up). A last odd row or column is left out; the image has at least 2x2 pixels.
pub(crate) fn halved(image: &GrayImage) -> Result<GrayImage, CoreError> {
    let (width, height) = (image.width() / 2, image.height() / 2);
    let mut pixels = vec![0; width * height];
    pixels.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(y, out)| {
        let (upper, lower) = (image.row(2 * y).chunks_exact(2), image.row(2 * y + 1).chunks_exact(2));
        for ((out, upper), lower) in out.iter_mut().zip(upper).zip(lower) {
            let sum: u16 = upper.iter().chain(lower).map(|&v| u16::from(v)).sum();
            *out = ((sum + 2) / 4) as u8;
        }
    });
    GrayImage::new(width, height, pixels)
}
