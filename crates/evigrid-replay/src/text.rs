//! Text files: finite numbers, and tables of `key: value` lines.

use std::fs;
use std::path::Path;

use crate::ReplayError;

/// A fault in the content of a file, before the file's name is known: parsers see bytes, not paths.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    what: String,
    expected: String,
    found: String,
    place: String,
}

impl Fault {
    pub fn new(what: impl Into<String>, expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self { what: what.into(), expected: expected.into(), found: found.into(), place: String::new() }
    }

    /// Places the fault on line `line`, counted from 1.
    pub fn on_line(self, line: usize) -> Self {
        Self { place: format!(":{line}"), ..self }
    }

    /// Places the fault at byte `byte`, counted from 0.
    pub fn at_byte(self, byte: usize) -> Self {
        Self { place: format!(" at byte {byte}"), ..self }
    }

    /// Names the file in which the fault was found.
    pub fn of(self, path: &Path) -> ReplayError {
        let Self { what, expected, found, place } = self;
        ReplayError::Content { what, expected, found, path: path.to_owned(), place }
    }
}

/// The bytes of a file.
pub(crate) fn read_bytes(what: &'static str, path: &Path) -> Result<Vec<u8>, ReplayError> {
    fs::read(path).map_err(|source| ReplayError::Io { what, path: path.to_owned(), source })
}

/// The text of a file, which must be UTF-8.
pub(crate) fn read_text(what: &'static str, path: &Path) -> Result<String, ReplayError> {
    fs::read_to_string(path).map_err(|source| ReplayError::Io { what, path: path.to_owned(), source })
}

/// The beginning of a text, quoted, fit for one line of an error message.
pub(crate) fn excerpt(text: &str) -> String {
    const LIMIT: usize = 40;
    let start: String = text.chars().take(LIMIT).collect();
    let ellipsis = if text.chars().nth(LIMIT).is_some() { "..." } else { "" };
    format!("\"{}{ellipsis}\"", start.escape_debug())
}

/// One finite number.
pub(crate) fn number(what: &str, word: &str) -> Result<f64, Fault> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Fault::new(what, "a finite number", excerpt(word))),
    }
}

/// Exactly `count` finite numbers between white space.
pub(crate) fn number_list(what: &str, text: &str, count: usize) -> Result<Vec<f64>, Fault> {
    let found = text.split_whitespace().count();
    if found != count {
        return Err(Fault::new(what, format!("{count} numbers"), found.to_string()));
    }
    text.split_whitespace().map(|word| number(what, word)).collect()
}

/// Exactly `N` finite numbers between white space.
pub(crate) fn numbers<const N: usize>(what: &str, text: &str) -> Result<[f64; N], Fault> {
    let list = number_list(what, text, N)?;
    list.try_into().map_err(|list: Vec<f64>| Fault::new(what, format!("{N} numbers"), list.len().to_string()))
}

/// The `key: value` (or `key=value`) lines of a calibration file. Other lines are passed over.
pub(crate) struct KeyValues<'a> {
    separator: char,
    lines: Vec<(&'a str, &'a str, usize)>,
}

impl<'a> KeyValues<'a> {
    pub fn parse(text: &'a str, separator: char) -> Self {
        let lines = text
            .lines()
            .enumerate()
            .filter_map(|(index, line)| {
                line.split_once(separator).map(|(key, value)| (key.trim(), value.trim(), index + 1))
            })
            .collect();
        Self { separator, lines }
    }

    /// The value of a key and the line it stands on; of keys that stand twice, the first.
    pub fn get(&self, key: &str) -> Result<(&'a str, usize), Fault> {
        let line = self.lines.iter().find(|(k, _, _)| *k == key);
        line.map(|&(_, value, line)| (value, line)).ok_or_else(|| {
            let expected = format!("a line \"{key}{} ...\"", self.separator);
            Fault::new(format!("calibration key {key}"), expected, "none")
        })
    }

    /// The `count` numbers of a key.
    pub fn number_list(&self, key: &str, count: usize) -> Result<Vec<f64>, Fault> {
        let (value, line) = self.get(key)?;
        number_list(&format!("calibration key {key}"), value, count).map_err(|fault| fault.on_line(line))
    }

    /// The `N` numbers of a key.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], Fault> {
        let (value, line) = self.get(key)?;
        numbers(&format!("calibration key {key}"), value).map_err(|fault| fault.on_line(line))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn message(fault: Fault) -> String {
        fault.of(Path::new("dir/file.txt")).to_string()
    }

    #[test]
    fn values_are_found_by_key() {
        let table = KeyValues::parse("calib_time: 09-Jan-2012 13:57:47\nR: 1 -2.5e0\n\nR: 9 9\n", ':');
        assert_eq!(table.numbers("R"), Ok([1.0, -2.5]));
        assert_eq!(table.get("calib_time"), Ok(("09-Jan-2012 13:57:47", 1)));
    }

    #[test]
    fn faults_say_what_where_expected_and_found() {
        let table = KeyValues::parse("a: 1\nR: 1 two\nT: 1 inf\n", ':');
        for (fault, expected) in [
            (
                table.numbers::<2>("K").unwrap_err(),
                "calibration key K: expected a line \"K: ...\", found none: dir/file.txt",
            ),
            (
                table.numbers::<3>("R").unwrap_err(),
                "calibration key R: expected 3 numbers, found 2: dir/file.txt:2",
            ),
            (
                table.numbers::<2>("R").unwrap_err(),
                "calibration key R: expected a finite number, found \"two\": dir/file.txt:2",
            ),
            (
                table.numbers::<2>("T").unwrap_err(),
                "calibration key T: expected a finite number, found \"inf\": dir/file.txt:3",
            ),
        ] {
            assert_eq!(message(fault), expected);
        }
    }

    #[test]
    fn excerpts_stay_on_one_short_line() {
        assert_eq!(excerpt("a\nb\u{1b}"), r#""a\nb\u{1b}""#);
        assert_eq!(excerpt(&"x".repeat(41)), format!("\"{}...\"", "x".repeat(40)));
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_panic(text in "\\PC*|[-0-9eE.: \n=naif]*", count in 0..40_usize) {
            for separator in [':', '='] {
                let table = KeyValues::parse(&text, separator);
                for (key, _, _) in &table.lines {
                    let list = table.number_list(key, count);
                    prop_assert!(list.iter().flatten().all(|v| v.is_finite()));
                    let _ = table.numbers::<3>(key);
                }
            }
        }
    }
}
