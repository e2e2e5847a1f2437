use evigrid_core::CoreError;

use crate::text::Fault;

/// Largest width or height that is read, so that a header cannot ask for any amount of memory.
pub(crate) const MAX_SIDE_PX: u32 = 16_384;

/// Width and height of an image, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ImageSize {
    pub width: usize,
    pub height: usize,
}

impl ImageSize {
    /// Takes the numbers that a calibration file gives, which must be whole and possible.
    pub fn from_numbers(what: &str, width: f64, height: f64) -> Result<Self, Fault> {
        let possible = |v: f64| v.fract() == 0.0 && (1.0..=f64::from(MAX_SIDE_PX)).contains(&v);
        if possible(width) && possible(height) {
            return Ok(Self { width: width as usize, height: height as usize });
        }
        let expected = format!("whole numbers of pixels from 1 to {MAX_SIDE_PX}");
        Err(Fault::new(what, expected, format!("{width} x {height}")))
    }

    /// `Ok` if this is the expected size.
    pub fn require(self, what: &'static str, expected: Self) -> Result<(), CoreError> {
        if self == expected {
            return Ok(());
        }
        let Self { width, height } = self;
        let Self { width: expected_width, height: expected_height } = expected;
        Err(CoreError::Size { what, expected_width, expected_height, width, height })
    }
}
