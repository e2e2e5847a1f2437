use crate::CoreError;
use crate::error::require_length;

/// An 8-bit grey image, row-major, row 0 at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrayImage {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl GrayImage {
    /// An image of `width` x `height` pixels from its rows.
    ///
    /// # Errors
    /// If either dimension is zero or `pixels` has another length than their product.
    pub fn new(width: usize, height: usize, pixels: Vec<u8>) -> Result<Self, CoreError> {
        require_length("grey image", &[width, height], pixels.len())?;
        Ok(Self { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All grey values, row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The grey values of row `y`.
    pub fn row(&self, y: usize) -> &[u8] {
        &self.pixels[y * self.width..(y + 1) * self.width]
    }
}
