/// A setting outside its domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{method}.{key}: expected {expected}, found {found}")]
pub struct SettingError {
    method: &'static str,
    key: &'static str,
    expected: String,
    found: String,
}

/// `Ok` if a setting of a method is possible.
pub(crate) fn require(
    method: &'static str,
    ok: bool,
    key: &'static str,
    expected: impl Into<String>,
    found: impl ToString,
) -> Result<(), SettingError> {
    if ok {
        Ok(())
    } else {
        Err(SettingError { method, key, expected: expected.into(), found: found.to_string() })
    }
}
