use std::fmt;
use std::ops::Range;

/// Frame numbers as ranges. Shown as `17, 30..33`; as everywhere in this project 30..33 is 30, 31, 32.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FrameRanges(Vec<Range<usize>>);

impl FrameRanges {
    /// The ranges in ascending order; no two of them touch.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.0
    }

    /// How many frames there are in all ranges.
    pub fn frame_count(&self) -> usize {
        self.0.iter().map(Range::len).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromIterator<usize> for FrameRanges {
    /// The ranges of ascending frame numbers.
    fn from_iter<I: IntoIterator<Item = usize>>(frames: I) -> Self {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for frame in frames {
            match ranges.last_mut() {
                Some(last) if last.end == frame => last.end += 1,
                _ => ranges.push(frame..frame + 1),
            }
        }
        Self(ranges)
    }
}

impl fmt::Display for FrameRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, range) in self.0.iter().enumerate() {
            let separator = if index == 0 { "" } else { ", " };
            match range.len() {
                1 => write!(f, "{separator}{}", range.start)?,
                _ => write!(f, "{separator}{}..{}", range.start, range.end)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_become_ranges() {
        for (frames, text, count) in [
            (vec![], "", 0),
            (vec![17], "17", 1),
            (vec![17, 30, 31, 32], "17, 30..33", 4),
            (vec![0, 1, 3, 4], "0..2, 3..5", 4),
        ] {
            let ranges: FrameRanges = frames.into_iter().collect();
            assert_eq!((ranges.to_string().as_str(), ranges.frame_count()), (text, count));
        }
    }
}
