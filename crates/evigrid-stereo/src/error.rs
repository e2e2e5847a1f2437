/// Why a matcher could not be built or run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StereoError {
    /// A setting outside its domain.
    #[error("stereo.{key}: expected {expected}, found {found}")]
    Setting {
        /// The setting.
        key: &'static str,
        /// Its domain in words.
        expected: &'static str,
        /// The offending value.
        found: usize,
    },
    /// A step between neighbours that no region could have.
    #[error("stereo.speckle_step_px: expected a finite number from 0, found {found}")]
    SpeckleStep {
        /// The offending value, pixels.
        found: f32,
    },
    /// An image in which not one window fits.
    #[error("stereo.window: expected a window within the {width}x{height} image, found {window}")]
    WindowTooLarge {
        /// Edge of the window, pixels.
        window: usize,
        /// Width of the image, pixels.
        width: usize,
        /// Height of the image, pixels.
        height: usize,
    },
    /// Two images of different size.
    #[error(transparent)]
    Images(#[from] evigrid_core::CoreError),
}
