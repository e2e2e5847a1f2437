use super::{Plan, Segments};

/// What Algorithm 2 says of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// A robot can drive there.
    Safe,
    /// Too steep.
    Steep,
    /// No way over low steps leads there.
    Unreached,
    /// Too small or too thin to tell.
    Unknown,
}

impl Plan<'_> {
    /// Whether a segment has too few cells, or too few interior ones, to tell whether it is ground.
    pub fn is_small_or_thin(&self, segments: &Segments, segment: usize) -> bool {
        let (cells, interior) = (segments.cells[segment].len(), segments.interior[segment]);
        let least = self.rules.min_interior_per_boundary * (cells - interior) as f64;
        cells < self.rules.min_segment_cells || (interior as f64) < least
    }

    /// Algorithm 2: a verdict for each segment, given the number of the one under the robot.
    pub fn verdicts(&self, segments: &Segments, start: usize) -> Vec<Verdict> {
        let (plan, rules) = (self, self.rules);
        let is_examined = segments.reached(start, |_, border| border.step_m <= rules.max_examined_step_m);
        let unsafe_from_the_start = |segment: usize| {
            let cells = &segments.cells[segment];
            let is_steep = cells.iter().any(|&cell| plan.surfaces[cell].is_some_and(|s| plan.is_steep(&s)));
            if segment == start {
                None
            } else if is_steep {
                Some(Verdict::Steep)
            } else if !is_examined[segment] {
                Some(Verdict::Unreached)
            } else if self.is_small_or_thin(segments, segment) {
                Some(Verdict::Unknown)
            } else {
                None
            }
        };
        let first: Vec<Option<Verdict>> = (0..segments.cells.len()).map(unsafe_from_the_start).collect();
        let is_safe = segments.reached(start, |other, border| {
            first[other].is_none() && border.agreeing.len() >= rules.min_border_cells
        });
        let verdict = |(first, is_safe): (Option<Verdict>, bool)| match first {
            Some(verdict) => verdict,
            None if is_safe => Verdict::Safe,
            None => Verdict::Unreached,
        };
        first.into_iter().zip(is_safe).map(verdict).collect()
    }
}
