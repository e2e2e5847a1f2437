//! Times of frames: dates in KITTI raw, seconds in KITTI odometry.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use crate::text::{Fault, excerpt, number};

/// Nanoseconds since 1970-01-01 UTC of lines such as `2011-09-26 13:10:51.174740992` (taken as UTC), one per
/// frame.
pub(crate) fn parse_dates(text: &str) -> Result<Vec<i64>, Fault> {
    parse_lines(text, |line| {
        let date = DateTime::strptime("%Y-%m-%d %H:%M:%S%.f", line).ok();
        let stamp = date.and_then(|date| TimeZone::UTC.to_timestamp(date).ok());
        stamp
            .and_then(|stamp| i64::try_from(stamp.as_nanosecond()).ok())
            .ok_or_else(|| Fault::new("time stamp", "a date YYYY-MM-DD HH:MM:SS.nnnnnnnnn", excerpt(line)))
    })
}

/// Nanoseconds since the start of the recording of lines with seconds, one per frame.
pub(crate) fn parse_seconds(text: &str) -> Result<Vec<i64>, Fault> {
    const MOST_SECONDS: f64 = 9e9;
    parse_lines(text, |line| {
        let seconds = number("time", line)?;
        if seconds.abs() > MOST_SECONDS {
            return Err(Fault::new("time", "at most 9e9 seconds", seconds.to_string()));
        }
        Ok((seconds * 1e9).round() as i64)
    })
}

/// One value per line. Empty lines are allowed at the end alone: anywhere else they would shift all that
/// follow.
fn parse_lines<T>(text: &str, parse: impl Fn(&str) -> Result<T, Fault>) -> Result<Vec<T>, Fault> {
    let lines = text.trim_end().lines().enumerate();
    lines.map(|(index, line)| parse(line.trim()).map_err(|fault| fault.on_line(index + 1))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use std::path::Path;

    #[test]
    fn dates_become_nanoseconds_since_1970() {
        // 2011-09-26 00:00 UTC is day 15243: 41 years of 365 days + 10 leap days + 268 days of 2011.
        let midnight = 15_243 * 86_400 * 1_000_000_000_i64;
        let morning = ((13 * 60 + 10) * 60 + 51) * 1_000_000_000 + 174_740_992;
        let text = "1970-01-01 00:00:00.000000001\n2011-09-26 13:10:51.174740992\n1970-01-02 00:00:00\n\n";
        assert_eq!(parse_dates(text), Ok(vec![1, midnight + morning, 86_400_000_000_000]));
    }

    #[test]
    fn seconds_become_nanoseconds() {
        assert_eq!(parse_seconds("0.000000e+00\n1.036224e-01\n"), Ok(vec![0, 103_622_400]));
    }

    #[test]
    fn faults_name_the_line() {
        let message = |fault: Fault| fault.of(Path::new("t.txt")).to_string();
        assert_eq!(
            message(parse_dates("1970-01-01 00:00:00\n\n1970-01-01 00:00:00\n").unwrap_err()),
            "time stamp: expected a date YYYY-MM-DD HH:MM:SS.nnnnnnnnn, found \"\": t.txt:2"
        );
        assert!(parse_dates("2011-13-01 00:00:00\n").is_err());
        assert!(parse_dates("9999-01-01 00:00:00\n").is_err());
        let late = message(parse_seconds("0\n1e10\n").unwrap_err());
        assert_eq!(late, "time: expected at most 9e9 seconds, found 10000000000: t.txt:2");
        let word = message(parse_seconds("0\nsoon\n").unwrap_err());
        assert_eq!(word, "time: expected a finite number, found \"soon\": t.txt:2");
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_panic(
            text in "\\PC*|[-0-9: .\n]*|[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9:.]{8,20}\n"
        ) {
            let _ = (parse_dates(&text), parse_seconds(&text));
        }
    }
}
