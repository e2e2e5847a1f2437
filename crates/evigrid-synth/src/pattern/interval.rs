/// A piece of one surface coordinate, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    from: f64,
    to: f64,
}

impl Interval {
    /// The interval of length `extent` centred at `x`.
    pub fn around(x: f64, extent: f64) -> Self {
        Self { from: x - 0.5 * extent, to: x + 0.5 * extent }
    }

    /// The interval between two places, in either order.
    pub fn between(a: f64, b: f64) -> Self {
        Self { from: a.min(b), to: a.max(b) }
    }

    /// Its length.
    pub fn length(self) -> f64 {
        self.to - self.from
    }

    /// Its centre.
    pub fn centre(self) -> f64 {
        0.5 * (self.from + self.to)
    }

    /// Where it begins.
    pub fn start(self) -> f64 {
        self.from
    }

    /// The numbers of the cells of size `cell` that it touches; cell i is [i, i + 1] * cell.
    pub fn cells(self, cell: f64) -> std::ops::RangeInclusive<i64> {
        (self.from / cell).floor() as i64..=(self.to / cell).floor() as i64
    }

    /// At most `length` of it, about the same centre.
    pub fn at_most(self, length: f64) -> Self {
        Self::around(self.centre(), self.length().min(length))
    }

    /// Its part in common with another one, empty (of length 0) if there is none.
    pub fn common(self, other: Self) -> Self {
        let from = self.from.max(other.from);
        Self { from, to: self.to.min(other.to).max(from) }
    }

    /// The length that is covered by pulses of `width` every `period`, the first of which begins at `first`.
    pub fn covered(self, first: f64, period: f64, width: f64) -> f64 {
        let width = width.clamp(0.0, period);
        let covered_until = |x: f64| {
            let cycles = (x / period).floor();
            cycles * width + (x - cycles * period).min(width)
        };
        (covered_until(self.to - first) - covered_until(self.from - first)).max(0.0).min(self.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_cover_their_share() {
        // Pulses [0, 1], [4, 5], [8, 9] ...
        for (x, extent, expected) in [
            (0.5, 0.2, 1.0),
            (2.5, 0.2, 0.0),
            (1.0, 0.5, 0.5),
            (2.0, 4.0, 0.25),
            (-3.5, 1.0, 1.0),
            (2.5, 4000.0, 0.25),
        ] {
            let share = |first: f64| Interval::around(x + first, extent).covered(first, 4.0, 1.0) / extent;
            assert!((share(0.0) - expected).abs() < 1e-9, "{x} {extent}");
            assert!((share(-7.3) - expected).abs() < 1e-9, "{x} {extent}");
        }
    }

    #[test]
    fn pulses_wider_than_their_period_cover_everything() {
        assert_eq!(Interval::between(7.0, 3.0).covered(0.0, 1.0, 5.0), 4.0);
        assert_eq!(Interval::between(3.0, 7.0).covered(0.0, 1.0, -5.0), 0.0);
    }

    #[test]
    fn intervals_have_in_common_what_lies_in_both() {
        let common = |a, b| Interval::between(0.0, 2.0).common(Interval::between(a, b)).length();
        assert_eq!(common(1.0, 5.0), 1.0);
        assert_eq!(common(-1.0, 5.0), 2.0);
        assert_eq!(common(0.5, 0.75), 0.25);
        assert_eq!(common(3.0, 5.0), 0.0);
        assert_eq!(common(-3.0, -1.0), 0.0);
    }

    #[test]
    fn cells_are_those_it_touches() {
        assert_eq!(Interval::between(-0.1, 0.9).cells(0.4), -1..=2);
        assert_eq!(Interval::around(0.6, 0.2).cells(0.4), 1..=1);
    }
}
