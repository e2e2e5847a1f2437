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
        /// The line itself.
        found: String,
        /// The fault.
        reason: String,
    },
    /// Values that are possible one by one but not together.
    #[error("{key}: expected {expected}, found {found}")]
    Value {
        /// The key at fault, e.g. `trajectory.waypoints`.
        key: String,
        /// The possible values.
        expected: String,
        /// The value that was given.
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
        /// The fault, in one line.
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

    /// Adds the line of the error's key in `text`, where that can be found.
    pub(crate) fn located(self, text: &str) -> Self {
        let Self::Value { key, .. } = &self else { return self };
        match offset_of(text, key) {
            Some(offset) => Self::at(text, offset, &self.to_string()),
            None => self,
        }
    }

    /// The error that the TOML parser gave for `text`.
    pub(crate) fn from_parser(text: &str, error: &toml::de::Error) -> Self {
        let offset = error.span().map_or(0, |span| span.start);
        Self::at(text, offset, &with_hint(error.message()).unwrap_or_else(|| error.message().to_owned()))
    }
}

/// Byte offset of the key `section.name` in a TOML text, or of its section's header if the name is
/// not there. The section may have a number (`laser 1` is the second `[[laser]]`), and another key
/// may follow after the word "and".
fn offset_of(text: &str, key: &str) -> Option<usize> {
    let first = key.split(" and ").next().unwrap_or(key);
    let (section, name) = first.split_once('.').unwrap_or((first, ""));
    let (section, number) = section.split_once(' ').unwrap_or((section, "0"));
    let (plain, listed) = (format!("[{section}]"), format!("[[{section}]]"));
    let starts = text.split_inclusive('\n').scan(0, |offset, line| {
        *offset += line.len();
        Some((*offset - line.len(), line.trim()))
    });
    let is_header = |line: &str| line.starts_with(&plain) || line.starts_with(&listed);
    let headers = starts.clone().filter(|(_, line)| is_header(line));
    let (header, _) = headers.clone().nth(number.parse().ok()?)?;
    let mut body =
        starts.skip_while(|&(offset, _)| offset <= header).take_while(|(_, l)| !l.starts_with('['));
    let is_key = |line: &str| line.strip_prefix(name).is_some_and(|rest| rest.trim_start().starts_with('='));
    Some(body.find(|(_, line)| !name.is_empty() && is_key(line)).map_or(header, |(offset, _)| offset))
}

/// The parser's "unknown field `x`, expected one of `a`, `b`" with the nearest name instead of the list.
fn with_hint(message: &str) -> Option<String> {
    let (start, list) = message.split_once(", expected ")?;
    let unknown =
        start.strip_prefix("unknown field `").or_else(|| start.strip_prefix("unknown variant `"))?;
    let known = list.split('`').skip(1).step_by(2);
    Some(format!("{start}{}", name_hint(unknown.trim_end_matches('`'), known)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_in_their_sections() {
        let text = "seed = 1\n[stereo]\nwidth = 3\n\n[[laser]]\nbeams = 1\n[[laser]]\n# beams\nbeams = 2\n";
        let line = |key: &str| offset_of(text, key).map(|offset| text[..offset].matches('\n').count() + 1);
        assert_eq!(line("stereo.width"), Some(3));
        assert_eq!(line("stereo.height and stereo.width"), Some(2));
        assert_eq!(line("laser 0.beams"), Some(6));
        assert_eq!(line("laser 1.beams and step_deg"), Some(9));
        assert_eq!(line("laser 2.beams"), None);
        assert_eq!(line("light.sun"), None);
    }
}
