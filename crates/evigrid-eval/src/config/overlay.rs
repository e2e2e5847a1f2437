//! Tables of settings laid over one another.

use std::path::Path;

use evigrid_core::name_hint;
use toml::{Table, Value};

use super::ConfigError;

/// A TOML file as it is.
pub(crate) fn read_table(path: &Path) -> Result<Table, ConfigError> {
    let origin = path.display().to_string();
    let text =
        std::fs::read_to_string(path).map_err(|source| ConfigError::Io { path: origin.clone(), source })?;
    text.parse::<Table>().map_err(|e| ConfigError::Syntax { message: syntax_error(&text, &e), origin })
}

/// Puts the values of `given` over those of `base`, whose keys are all there are.
pub(super) fn overlay(
    base: &mut Table,
    given: Table,
    origin: &str,
    section: &str,
) -> Result<(), ConfigError> {
    for (key, value) in given {
        let full = format!("{section}{key}");
        if !base.contains_key(&key) {
            let hint = name_hint(&full, base.keys().map(|k| format!("{section}{k}")));
            return Err(ConfigError::Unknown { origin: origin.into(), key: full, hint });
        }
        match (&mut base[&key], value) {
            (Value::Table(inner), Value::Table(value)) => overlay(inner, value, origin, &format!("{full}."))?,
            (Value::Table(_), _) => {
                return Err(ConfigError::Value(format!("`{full}` is a section, not a value ({origin})")));
            }
            // A whole number is fine where the default has a point.
            (slot @ Value::Float(_), Value::Integer(i)) => *slot = Value::Float(i as f64),
            (slot, value) => *slot = value,
        }
    }
    Ok(())
}

/// `a.b=value` as the table `a = { b = value }`.
pub(super) fn parse_set(set: &str) -> Result<Table, ConfigError> {
    let syntax =
        |message: &str| ConfigError::Syntax { origin: format!("--set {set}"), message: message.into() };
    let (key, text) =
        set.split_once('=').ok_or_else(|| syntax("expected SECTION.KEY=VALUE, found no `=`"))?;
    let (key, text) = (key.trim(), text.trim());
    if key.is_empty() || key.split('.').any(str::is_empty) {
        return Err(syntax("expected SECTION.KEY before the `=`"));
    }
    let value = match format!("value = {text}").parse::<Table>() {
        Ok(mut table) if table.len() == 1 => {
            table.remove("value").unwrap_or_else(|| Value::String(text.into()))
        }
        // What begins like a list, a table or a quoted string is meant to be one.
        Err(e) if text.starts_with(['[', '{', '"', '\'']) => return Err(syntax(&one_line(e.message()))),
        _ => Value::String(text.into()),
    };
    Ok(nested(key, value))
}

/// `a.b` and a value as the table `a = { b = value }`.
pub(crate) fn nested(key: &str, value: Value) -> Table {
    let (sections, name) = key.rsplit_once('.').map_or(("", key), |(s, n)| (s, n));
    let mut table = Table::from_iter([(name.to_owned(), value)]);
    for section in sections.split('.').rev().filter(|s| !s.is_empty()) {
        table = Table::from_iter([(section.to_owned(), Value::Table(table))]);
    }
    table
}

fn syntax_error(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map_or(0, |span| text[..span.start.min(text.len())].lines().count().max(1));
    format!("line {line}: {}", one_line(error.message()))
}

pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
