/// The way a pass goes over the image: row by row from the top, each from the left; or from the bottom, each
/// from the right. Steps count rows and positions count columns along the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Travel {
    pub upwards: bool,
    pub width: usize,
    pub height: usize,
}

impl Travel {
    /// Row of the image at a step.
    #[inline(always)]
    pub fn row(self, step: usize) -> usize {
        if self.upwards { self.height - 1 - step } else { step }
    }

    /// Column of the image at a position.
    #[inline(always)]
    pub fn column(self, position: usize) -> usize {
        if self.upwards { self.width - 1 - position } else { position }
    }

    /// Row of the image that lies `offset` steps after a step, the border repeated outwards.
    #[inline(always)]
    pub fn row_near(self, step: usize, offset: isize) -> usize {
        self.row(step.saturating_add_signed(offset).min(self.height - 1))
    }
}

/// Offset between two pixels along the way of a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Offset {
    pub positions: isize,
    pub steps: isize,
}
