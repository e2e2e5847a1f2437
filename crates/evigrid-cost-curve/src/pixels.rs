//! Names for pixels, runs of pixels and sizes of images, which would otherwise be pairs of numbers.

/// A pixel of an image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pixel {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
}

/// A run of neighbouring columns or rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// The first of them.
    pub first: usize,
    /// The last of them; no less than the first.
    pub last: usize,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelBox {
    /// Its columns.
    pub columns: Span,
    /// Its rows.
    pub rows: Span,
}

/// Size of an image, pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImageSize {
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
}

impl PixelBox {
    /// All pixels of an image.
    pub fn whole(size: ImageSize) -> Self {
        Self {
            columns: Span { first: 0, last: size.width - 1 },
            rows: Span { first: 0, last: size.height - 1 },
        }
    }

    /// The rows in two parts, from the middle on downwards and from the top to the middle, in which it
    /// belongs to both.
    #[inline(always)]
    pub fn halves(self) -> [Self; 2] {
        let Span { first: top, last: bottom } = self.rows;
        let middle = top.midpoint(bottom);
        let rows = |first, last| Self { rows: Span { first, last }, ..self };
        [rows(middle, bottom), rows(top, middle)]
    }
}
