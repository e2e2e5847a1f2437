//! The pair that both benches match.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::GrayImage;

/// A textured pair whose disparity grows downwards, as on a road.
pub fn pair(width: usize, height: usize) -> (GrayImage, GrayImage) {
    let noise = |x: usize, y: usize| {
        let mut h =
            (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (h >> 56) as u8
    };
    let left = (0..width * height).map(|i| noise(i % width, i / width)).collect();
    let right = (0..width * height).map(|i| noise(i % width + i / width * 60 / height, i / width)).collect();
    (GrayImage::new(width, height, left).unwrap(), GrayImage::new(width, height, right).unwrap())
}
