/// Why a world could not be built; the message is one line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SynthError {
    /// A text that is no world description.
    #[error("line {line}, `{found}`: {reason}")]
    Text {
        /// Line within the text, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Values that are possible one by one but not together.
    #[error("{key}: expected {expected}, found {found}")]
    Value {
        /// The key at fault, e.g. `trajectory.waypoints_m`.
        key: String,
        /// What would be possible.
        expected: String,
        /// What was given.
        found: String,
    },
    /// A built-in world that does not exist.
    #[error("no built-in world `{name}`: expected one of {known}")]
    UnknownWorld {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
}

impl SynthError {
    /// The error of the key `key`.
    pub(crate) fn value(key: impl Into<String>, expected: impl Into<String>, found: impl ToString) -> Self {
        Self::Value { key: key.into(), expected: expected.into(), found: found.to_string() }
    }

    /// The error at byte `offset` of `text`.
    pub(crate) fn at(text: &str, offset: usize, reason: &str) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line = before.matches('\n').count();
        let found = text.lines().nth(line).unwrap_or_default().trim().chars().take(100).collect();
        let reason = reason.split_whitespace().collect::<Vec<_>>().join(" ");
        Self::Text { line: line + 1, found, reason }
    }

    /// The error that the TOML parser gave for `text`.
    pub(crate) fn from_parser(text: &str, error: &toml::de::Error) -> Self {
        Self::at(text, error.span().map_or(0, |span| span.start), error.message())
    }
}
