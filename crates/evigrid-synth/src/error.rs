use std::path::PathBuf;

use evigrid_core::name_hint;

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
    #[error("no built-in world `{name}`{hint}")]
    UnknownWorld {
        /// The name asked for.
        name: String,
        /// The nearest name, or all there are.
        hint: String,
    },
    /// A world's file that cannot be read or holds no world.
    #[error("{message} ({})", path.display())]
    File {
        /// What is wrong.
        message: String,
        /// The file.
        path: PathBuf,
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
        let offset = error.span().map_or(0, |span| span.start);
        Self::at(text, offset, &with_hint(error.message()).unwrap_or_else(|| error.message().to_owned()))
    }
}

/// The parser's "unknown field `x`, expected one of `a`, `b`" with the nearest name instead of the list.
fn with_hint(message: &str) -> Option<String> {
    let (start, list) = message.split_once(", expected ")?;
    let unknown =
        start.strip_prefix("unknown field `").or_else(|| start.strip_prefix("unknown variant `"))?;
    let known = list.split('`').skip(1).step_by(2);
    Some(format!("{start}{}", name_hint(unknown.trim_end_matches('`'), known)))
}
