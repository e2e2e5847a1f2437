//! Pictures of a stereo frame: the left image beside the true and the matched disparity.

use anyhow::Result;
use evigrid_core::{Disparity, GrayImage};
use evigrid_eval::turbo;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};

/// Width of one panel, pixels.
const PANEL: u32 = 480;
const GAP: u32 = 6;
const JPEG_QUALITY: u8 = 82;

/// The panels side by side as a JPEG.
pub fn stereo_panels(left: &GrayImage, truth: &Disparity, matched: &Disparity) -> Result<Vec<u8>> {
    let largest = truth.values().iter().copied().filter(|d| !d.is_nan()).fold(1.0, f32::max);
    let panels = [grey(left), coloured(truth, largest), coloured(matched, largest)].map(|panel| {
        let height = panel.height() * PANEL / panel.width();
        resize(&panel, PANEL, height.max(1), FilterType::Triangle)
    });
    let count = panels.len() as u32;
    let mut sheet =
        RgbImage::from_pixel(count * PANEL + (count - 1) * GAP, panels[0].height(), Rgb([255; 3]));
    for (i, panel) in (0..).zip(&panels) {
        image::imageops::replace(&mut sheet, panel, i * i64::from(PANEL + GAP), 0);
    }
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY).encode_image(&sheet)?;
    Ok(bytes)
}

fn grey(image: &GrayImage) -> RgbImage {
    let width = image.width();
    RgbImage::from_fn(width as u32, image.height() as u32, |x, y| {
        Rgb([image.pixels()[y as usize * width + x as usize]; 3])
    })
}

/// Blue is far, red near, black unknown; the root of the disparity sets the colour, as in the recordings.
fn coloured(disparity: &Disparity, largest: f32) -> RgbImage {
    let width = disparity.width();
    RgbImage::from_fn(width as u32, disparity.height() as u32, |x, y| {
        match disparity.values()[y as usize * width + x as usize] {
            d if d.is_nan() => Rgb([0; 3]),
            d => Rgb(turbo((d / largest).clamp(0.0, 1.0).sqrt())),
        }
    })
}
