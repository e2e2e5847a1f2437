use anyhow::{Context, Result, bail};

/// No recording has more frames than this.
const MAX_STRIDE: usize = 1_000_000;

/// Frame numbers `A..B`; either end may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    from: usize,
    to: Option<usize>,
}

impl std::str::FromStr for FrameRange {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || format!("run.frames: expected A..B, A.. or ..B with whole numbers, found `{text}`");
        let (from, to) = text.split_once("..").with_context(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().with_context(wrong);
        let from = if from.trim().is_empty() { 0 } else { number(from)? };
        let to = if to.trim().is_empty() { None } else { Some(number(to)?) };
        Ok(Self { from, to })
    }
}

impl FrameRange {
    /// The frame numbers within a recording of `count` frames, every `stride`-th.
    ///
    /// # Errors
    /// If the stride is 0, the range is empty or it goes beyond the recording.
    pub fn frames(&self, count: usize, stride: usize) -> Result<Vec<usize>> {
        if !(1..=MAX_STRIDE).contains(&stride) {
            bail!("run.stride: expected a number from 1 to {MAX_STRIDE}, found {stride}");
        }
        let to = self.to.unwrap_or(count);
        if to > count {
            bail!("run.frames: expected frames within 0..{count}, found {}..{to}", self.from);
        }
        if self.from >= to {
            bail!("run.frames: expected at least one frame within 0..{count}, found {}..{to}", self.from);
        }
        Ok((self.from..to).step_by(stride).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn frames(text: &str, stride: usize) -> Result<Vec<usize>> {
        text.parse::<FrameRange>()?.frames(10, stride)
    }

    #[test]
    fn frame_ranges() {
        assert_eq!(frames("2..5", 1).unwrap(), [2, 3, 4]);
        assert_eq!(frames("..", 4).unwrap(), [0, 4, 8]);
        assert_eq!(frames("7..", 2).unwrap(), [7, 9]);
        assert_eq!(frames("..1", 1).unwrap(), [0]);
    }

    #[test]
    fn impossible_ranges_are_refused() {
        for (text, stride, part) in [
            ("5..5", 1, "at least one frame"),
            ("6..2", 1, "at least one frame"),
            ("0..11", 1, "within 0..10"),
            ("0..3", 0, "run.stride"),
            ("3", 1, "expected A..B"),
            ("a..3", 1, "expected A..B"),
            ("-1..3", 1, "expected A..B"),
        ] {
            let message = format!("{:#}", frames(text, stride).unwrap_err());
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
