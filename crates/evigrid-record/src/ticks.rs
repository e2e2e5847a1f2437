/// Round whole numbers from 0 to at most `end`, between three and six of them if `end` is at least 2.
pub(crate) fn ticks(end: f64) -> Vec<f64> {
    if !(end.is_finite() && end > 0.0) {
        return vec![0.0];
    }
    let power = 10_f64.powf((end / 5.0).log10().floor()).max(1.0);
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| end / s <= 5.0 + 1e-9);
    let step = step.unwrap_or(end);
    (0..=5).map(|i| f64::from(i) * step).filter(|t| *t <= end * (1.0 + 1e-9)).collect()
}

/// A count in few characters: 950, 20k, 2.5k, 1.5M.
pub(crate) fn short(count: f64) -> String {
    match count {
        c if c >= 1e6 => format!("{}M", c / 1e6),
        c if c >= 1e3 => format!("{}k", c / 1e3),
        c => format!("{c}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        for (end, expected) in [
            (29_216.0, vec![0.0, 10_000.0, 20_000.0]),
            (100.0, vec![0.0, 20.0, 40.0, 60.0, 80.0, 100.0]),
            (7.0, vec![0.0, 2.0, 4.0, 6.0]),
            (1.0, vec![0.0, 1.0]),
            (0.0, vec![0.0]),
            (f64::NAN, vec![0.0]),
        ] {
            assert_eq!(ticks(end), expected, "{end}");
        }
        for end in 2..3000 {
            let n = ticks(f64::from(end)).len();
            assert!((3..=6).contains(&n), "{end}: {n}");
        }
    }

    #[test]
    fn counts_are_short() {
        assert_eq!([0.0, 950.0, 2500.0, 20_000.0, 1.5e6].map(short), ["0", "950", "2.5k", "20k", "1.5M"]);
    }
}
