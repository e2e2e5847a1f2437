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
    /// A weight of the smoothness that no energy could have.
    #[error("stereo.graph_cuts.lambda: expected a number from 0 to 10000, found {found}")]
    Lambda {
        /// The offending value, squared grey levels.
        found: f32,
    },
    /// An image too large for graph cuts.
    #[error("graph cuts: expected an image of at most {most} pixels, found {width}x{height}")]
    TooManyPixels {
        /// Width of the image, pixels.
        width: usize,
        /// Height of the image, pixels.
        height: usize,
        /// The largest number of pixels.
        most: usize,
    },
    /// Hypotheses of an image that take too much memory.
    #[error(
        "semi-global matching: expected at most {most} costs, found {width}x{height} pixels with {disparities} disparities"
    )]
    TooManyCosts {
        /// Width of the image, pixels.
        width: usize,
        /// Height of the image, pixels.
        height: usize,
        /// Hypotheses of each.
        disparities: usize,
        /// The largest product of the three.
        most: usize,
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
