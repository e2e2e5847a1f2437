use evigrid_core::{CoreError, SettingError};

/// Error of building or running a matcher.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StereoError {
    /// A setting outside its domain.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A pair that is too large for its matcher.
    #[error("{matcher}: expected {expected}, found {found}")]
    TooLarge {
        /// Name of the matcher.
        matcher: &'static str,
        /// Largest size, in words.
        expected: String,
        /// Size of the pair.
        found: String,
    },
    /// A matcher that looks for the ground, and nobody tells where it is.
    #[error(
        "stereo.matcher double-correlation: expected ground in the frame or a known mounting of the camera \
         (input.mounting), found neither"
    )]
    NoGround,
    /// Two images of different size.
    #[error(transparent)]
    Images(#[from] CoreError),
}
