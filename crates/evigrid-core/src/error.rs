/// Why a value could not be built. Callers add where it came from (file, frame).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CoreError {
    /// A buffer whose length is not the product of its dimensions.
    #[error("{what}: expected {expected} values ({shape}), found {found}")]
    Length {
        /// The value that was to be built.
        what: &'static str,
        /// The dimensions that were given.
        shape: String,
        /// Their product.
        expected: usize,
        /// The length of the buffer.
        found: usize,
    },
    /// Two images of one pair, or an image and its rig, that differ in size.
    #[error(
        "image sizes differ: expected {expected_width}x{expected_height}, found {width}x{height} ({what})"
    )]
    Size {
        /// The image at fault.
        what: &'static str,
        /// Expected width, pixels.
        expected_width: usize,
        /// Expected height, pixels.
        expected_height: usize,
        /// Found width, pixels.
        width: usize,
        /// Found height, pixels.
        height: usize,
    },
    /// A number outside its domain.
    #[error("{what}: expected {expected}, found {found}")]
    Domain {
        /// The quantity.
        what: &'static str,
        /// Its domain in words.
        expected: &'static str,
        /// The offending value.
        found: f64,
    },
}

/// `Ok` if `value` satisfies `ok`, else the domain error that names it.
pub(crate) fn require(
    ok: bool,
    what: &'static str,
    expected: &'static str,
    found: f64,
) -> Result<(), CoreError> {
    if ok { Ok(()) } else { Err(CoreError::Domain { what, expected, found }) }
}

/// `Ok` if a buffer of `found` values has the given shape.
pub(crate) fn require_length(what: &'static str, shape: &[usize], found: usize) -> Result<(), CoreError> {
    let expected = shape.iter().product();
    if found == expected && shape.iter().all(|&n| n > 0) {
        return Ok(());
    }
    let shape = shape.iter().map(usize::to_string).collect::<Vec<_>>().join("x");
    Err(CoreError::Length { what, shape, expected, found })
}
