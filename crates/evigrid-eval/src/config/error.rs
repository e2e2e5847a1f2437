/// Why settings could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A file that cannot be read.
    #[error("cannot read the settings: {source}: {path}")]
    Io {
        /// The file.
        path: String,
        /// The system's message.
        source: std::io::Error,
    },
    /// A text that is no TOML.
    #[error("{origin}: {message}")]
    Syntax {
        /// The file, or `--set`.
        origin: String,
        /// The parser's message, in one line.
        message: String,
    },
    /// A key that does not exist.
    #[error("{origin}: unknown setting `{key}`{hint}")]
    Unknown {
        /// The file, or `--set`.
        origin: String,
        /// The key with its section.
        key: String,
        /// The nearest name.
        hint: String,
    },
    /// A value of the wrong type or outside its domain.
    #[error("{0}")]
    Value(String),
}
