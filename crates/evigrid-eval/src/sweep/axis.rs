use anyhow::{Context, Result, bail};
use toml::{Table, Value};

/// A sweep of more points is a mistake in the plan.
pub(super) const MAX_POINTS: usize = 10_000;

/// A setting and the values it is given.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// The setting with its section.
    pub key: String,
    /// At least one value.
    pub values: Vec<Value>,
}

impl Axis {
    /// From `SECTION.KEY=A..B:STEP` or `SECTION.KEY=[VALUE, ...]`, as on the command line.
    pub fn parse(text: &str) -> Result<Self> {
        let origin = format!("--sweep {text}");
        let wrong = || format!("{origin}: expected SECTION.KEY=A..B:STEP or SECTION.KEY=[VALUE, ...]");
        let (key, values) = text.split_once('=').with_context(wrong)?;
        let (key, values) = (key.trim(), values.trim());
        if key.split('.').any(str::is_empty) {
            bail!(wrong());
        }
        let value = if values.starts_with('[') {
            let table = format!("v = {values}").parse::<Table>().ok();
            table.and_then(|mut t| t.remove("v")).with_context(wrong)?
        } else {
            let (from, rest) = values.split_once("..").with_context(wrong)?;
            let (to, step) = rest.split_once(':').with_context(wrong)?;
            let bounds = [("from", from), ("to", to), ("step", step)];
            let bounds = bounds.map(|(name, text)| number(text).map(|n| (name.to_owned(), n)));
            let bounds: Option<Vec<_>> = bounds.into_iter().collect();
            Value::Table(Table::from_iter(bounds.with_context(wrong)?))
        };
        Self::new(key.to_owned(), value, &origin)
    }

    /// From a list of values, or a table of `from`, `to` and `step`; `origin` is where it stands.
    pub fn new(key: String, values: Value, origin: &str) -> Result<Self> {
        let values = match values {
            Value::Array(values) => values,
            Value::Table(range) => range_values(&range, origin)?,
            other => bail!(
                "{origin}: expected a list of values or {{ from = A, to = B, step = S }}, found `{other}`"
            ),
        };
        if values.is_empty() {
            bail!("{origin}: expected at least one value, found an empty list");
        }
        Ok(Self { key, values })
    }
}

/// A number as TOML would read it.
fn number(text: &str) -> Option<Value> {
    let text = text.trim();
    let whole = text.parse().ok().map(Value::Integer);
    whole.or_else(|| text.parse().ok().map(Value::Float))
}

const BOUNDS: [&str; 3] = ["from", "to", "step"];

/// Whether a table of a plan is a range, not a section of settings.
pub(super) fn is_range(table: &Table) -> bool {
    BOUNDS.iter().any(|name| table.contains_key(*name))
}

/// The values of a range, the end included.
fn range_values(range: &Table, origin: &str) -> Result<Vec<Value>> {
    if let Some(key) = range.keys().find(|key| !BOUNDS.contains(&key.as_str())) {
        bail!("{origin}: expected from, to and step, found `{key}`");
    }
    let [from, to, step] =
        BOUNDS.map(|name| range.get(name).with_context(|| format!("{origin}: {name} is missing")));
    let (from, to, step) = (from?, to?, step?);
    if let [Value::Integer(from), Value::Integer(to), Value::Integer(step)] = [from, to, step] {
        let count = count(*from as f64, *to as f64, *step as f64, origin)?;
        return Ok((0..count as i64).map(|i| Value::Integer(from + i * step)).collect());
    }
    let real = |value: &Value| match value {
        Value::Integer(i) => Ok(*i as f64),
        Value::Float(f) if f.is_finite() => Ok(*f),
        other => bail!("{origin}: expected a finite number, found `{other}`"),
    };
    let (from, to, step) = (real(from)?, real(to)?, real(step)?);
    let places = decimal_places(from).max(decimal_places(step));
    let value = |i: usize| round(from + i as f64 * step, places);
    Ok((0..count(from, to, step, origin)?).map(|i| Value::Float(value(i))).collect())
}

/// How many values a range has.
fn count(from: f64, to: f64, step: f64, origin: &str) -> Result<usize> {
    if step <= 0.0 {
        bail!("{origin}: expected a step above 0, found {step}");
    }
    if from > to {
        bail!("{origin}: expected a range with at least one value, found {from}..{to}");
    }
    // The end belongs to the range even where steps fall short of it by rounding.
    let steps = ((to - from) / step + 1e-9).floor();
    if steps >= MAX_POINTS as f64 {
        bail!("{origin}: expected at most {MAX_POINTS} values, found {}", steps + 1.0);
    }
    Ok(steps as usize + 1)
}

/// Digits after the point of the shortest decimal that is this number.
fn decimal_places(value: f64) -> usize {
    value.to_string().split_once('.').map_or(0, |(_, digits)| digits.len())
}

/// The number that a person would write: 0.3, not 0.1 + 2 * 0.1 = 0.30000000000000004.
fn round(value: f64, places: usize) -> f64 {
    format!("{value:.places$}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn values(text: &str) -> Vec<Value> {
        Axis::parse(&format!("a.b={text}")).unwrap().values
    }

    #[test]
    fn ranges_include_their_end_and_do_not_add_up_rounding() {
        let ratios = values("1.5..12:0.5");
        assert_eq!(ratios.len(), 22);
        assert_eq!((&ratios[0], &ratios[21]), (&Value::Float(1.5), &Value::Float(12.0)));
        let tenths: Vec<_> = (1..=9).map(|i| Value::Float(format!("0.{i}").parse().unwrap())).collect();
        assert_eq!(values("0.1..0.9:0.1"), tenths);
        assert_eq!(values("5..9:2"), [5, 7, 9].map(Value::Integer));
        assert_eq!(values("5..8:2"), [5, 7].map(Value::Integer));
        assert_eq!(values("-1..-0.5:0.5"), [-1.0, -0.5].map(Value::Float));
        assert_eq!(values("3..3:1"), [Value::Integer(3)]);
        assert_eq!(values("[1, \"x\"]"), [Value::Integer(1), Value::String("x".into())]);
    }

    #[test]
    fn impossible_ranges_are_refused() {
        for (text, part) in [
            ("a.b", "expected SECTION.KEY=A..B:STEP"),
            ("a.b=1..2", "expected SECTION.KEY=A..B:STEP"),
            ("a.b=1..x:1", "expected SECTION.KEY=A..B:STEP"),
            ("=1..2:1", "expected SECTION.KEY=A..B:STEP"),
            ("a.b=2..1:1", "at least one value, found 2..1"),
            ("a.b=1..2:0", "a step above 0, found 0"),
            ("a.b=1..2:-0.5", "a step above 0, found -0.5"),
            ("a.b=1..2:nan", "a finite number"),
            ("a.b=1..inf:1", "a finite number"),
            ("a.b=0..1:1e-9", "at most 10000 values"),
            ("a.b=[]", "an empty list"),
            ("a.b=[1", "expected SECTION.KEY=A..B:STEP"),
        ] {
            let message = Axis::parse(text).unwrap_err().to_string();
            assert!(message.starts_with(&format!("--sweep {text}: ")) && message.contains(part), "{message}");
        }
    }

    proptest! {
        #[test]
        fn random_text_never_panics(text in ".{0,30}", range in "[-0-9.e:]{0,30}") {
            let _ = Axis::parse(&text);
            let _ = Axis::parse(&format!("a={range}"));
        }

        #[test]
        fn values_lie_within_their_range(from in -50..50_i32, steps in 0..40_i32, step in 1..30_i32, places in 0..4_i32) {
            let unit = 10_f64.powi(-places);
            let [from, to, step] = [from, from + steps * step, step].map(|n| f64::from(n) * unit);
            let found = values(&format!("{from}..{to}:{step}"));
            prop_assert_eq!(found.len(), steps as usize + 1);
            let last = found.last().unwrap();
            let last = last.as_float().or(last.as_integer().map(|i| i as f64)).unwrap();
            prop_assert!((last - to).abs() <= 1e-9 * step);
        }
    }
}
