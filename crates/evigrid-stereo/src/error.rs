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
    /// Two images of different size.
    #[error(transparent)]
    Images(#[from] CoreError),
}
