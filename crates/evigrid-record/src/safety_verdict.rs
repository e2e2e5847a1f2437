use evigrid_grid::{SafetyLabel, SafetyMap};
use rerun::AnnotationContext;
use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};

/// A cell of the true safety map, as a found map sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Verdict {
    /// The truth does not say whether the cell is safe.
    Unjudged,
    /// Safe in both.
    Safe,
    /// Unsafe in both.
    Unsafe,
    /// Unsafe in truth and safe in the map: a robot would drive into it.
    Danger,
    /// Safe in truth and unsafe in the map: a robot would drive around it.
    Alarm,
    /// The truth knows the cell, the map does not.
    Unclassified,
}

use Verdict::{Alarm, Danger, Safe, Unclassified, Unjudged, Unsafe};

impl Verdict {
    /// All verdicts, in the order of their numbers.
    const ALL: [Self; 6] = [Unjudged, Safe, Unsafe, Danger, Alarm, Unclassified];

    /// Name and colour.
    fn look(self) -> (&'static str, [u8; 3]) {
        match self {
            Unjudged => ("the truth is unknown", [24, 26, 30]),
            Safe => ("safe, and called so", [28, 92, 54]),
            Unsafe => ("unsafe, and called so", [52, 199, 89]),
            Danger => ("unsafe, but called safe", [235, 52, 52]),
            Alarm => ("safe, but called unsafe", [255, 159, 28]),
            Unclassified => ("not classified by the map", [122, 112, 255]),
        }
    }

    /// All verdicts with names and colours, for images of their numbers.
    pub fn annotations() -> AnnotationContext {
        AnnotationContext::new(Self::ALL.map(|verdict| {
            let (name, [r, g, b]) = verdict.look();
            ClassDescription::from(AnnotationInfo::from((verdict as u16, name, Rgba32::from_rgb(r, g, b))))
        }))
    }
}

/// Numbers of the verdicts on the cells of the true map, by flat index. The found map may have other cells:
/// the one that holds the true cell's centre is judged, as in the scores.
pub(crate) fn verdicts(found: &SafetyMap, truth: &SafetyMap) -> Vec<u8> {
    let verdict = |(flat, label): (usize, &SafetyLabel)| {
        let cell = found.spec().cell_of(truth.spec().centre_m(flat));
        let found = cell.and_then(|cell| found.labels()[cell].is_safe());
        judge(label.is_safe(), found) as u8
    };
    truth.labels().iter().enumerate().map(verdict).collect()
}

/// Whether a cell is safe, in truth and in the map; `None` = not known.
fn judge(truth: Option<bool>, found: Option<bool>) -> Verdict {
    match (truth, found) {
        (None, _) => Unjudged,
        (Some(true), Some(true)) => Safe,
        (Some(false), Some(false)) => Unsafe,
        (Some(false), Some(true)) => Danger,
        (Some(true), Some(false)) => Alarm,
        (Some(_), None) => Unclassified,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use SafetyLabel::{Inclined, Level, NonGround, Unknown};
    use evigrid_grid::PlanSpec;

    fn map(x_m: [f64; 2], y_m: [f64; 2], labels: &[SafetyLabel]) -> SafetyMap {
        let mut map = SafetyMap::unknown(PlanSpec::of_area(x_m, y_m, 1.0).unwrap());
        labels.iter().enumerate().for_each(|(flat, label)| map.set(flat, *label, None));
        map
    }

    #[test]
    fn cells_are_judged_where_they_lie() {
        // Columns from right to left, the rear one first. The found map lies one cell further forward.
        let truth =
            map([3.0, 5.0], [-1.0, 2.0], &[Level, NonGround, Unknown, Inclined, NonGround, NonGround]);
        let found = map([4.0, 6.0], [-1.0, 2.0], &[NonGround, Inclined, NonGround, Level, Level, Level]);
        let expected = [Unclassified, Unclassified, Unjudged, Alarm, Danger, Unsafe].map(|v| v as u8);
        assert_eq!(verdicts(&found, &truth), expected);
        let same = [Safe, Unsafe, Unjudged, Safe, Unsafe, Unsafe].map(|v| v as u8);
        assert_eq!(verdicts(&truth, &truth), same);
    }

    #[test]
    fn numbers_and_looks_are_distinct() {
        for (number, verdict) in Verdict::ALL.into_iter().enumerate() {
            assert_eq!(verdict as usize, number);
            for other in &Verdict::ALL[..number] {
                let ((name, rgb), (other_name, other_rgb)) = (verdict.look(), other.look());
                assert!(name != other_name && rgb != other_rgb, "{verdict:?} {other:?}");
            }
        }
    }
}
