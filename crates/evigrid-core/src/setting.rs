/// A setting outside its domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{section}.{key}: expected {expected}, found {found}")]
pub struct SettingError {
    /// The section of the settings: `grid`, or the name of a method.
    pub section: &'static str,
    /// The setting within its section.
    pub key: &'static str,
    /// Its domain in words.
    pub expected: String,
    /// The offending value.
    pub found: String,
}

/// `Ok` if `ok`, else the error that names the setting, its domain and its value.
///
/// # Errors
/// If `ok` is false.
pub fn require_setting(
    ok: bool,
    section: &'static str,
    key: &'static str,
    expected: impl Into<String>,
    found: impl ToString,
) -> Result<(), SettingError> {
    if ok {
        return Ok(());
    }
    Err(SettingError { section, key, expected: expected.into(), found: found.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_setting_domain_and_value() {
        let error = require_setting(false, "grid", "cell_size_m", "a positive number", -1.0).unwrap_err();
        assert_eq!(error.to_string(), "grid.cell_size_m: expected a positive number, found -1");
        assert!(require_setting(true, "grid", "cell_size_m", "a positive number", 1.0).is_ok());
    }
}
