//! The pairs that matchers are tested on.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::GrayImage;

/// A textured right image and a left image that is it, shifted, with noise: some structure and many ties.
pub fn pair(width: usize, height: usize, shift: usize, grey_levels: u8, seed: u64) -> (GrayImage, GrayImage) {
    let mut state = seed | 1;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u8
    };
    let step = 255 / grey_levels.max(1);
    let right: Vec<u8> = (0..width * height).map(|_| random() % (grey_levels + 1) * step).collect();
    let left = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            if random() % 8 == 0 { random() } else { right[y * width + x.saturating_sub(shift)] }
        })
        .collect();
    (GrayImage::new(width, height, left).unwrap(), GrayImage::new(width, height, right).unwrap())
}
