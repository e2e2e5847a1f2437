//! Fig. 7: maps in the making against the true ones, one frame of each world: what is right and what is wrong, cell
//! by cell.

use anyhow::{Context, Result};
use evigrid_grid::SafetyMap;
use evigrid_metrics::{PlanningDisc, SafetyCounts};
use plotters::prelude::RGBColor;

use super::journeys::{SHOWN, entries, up_to_shown};
use super::plan_view::{PANEL, label_key, label_series, panel, patches, robot_series};
use super::worlds::Entry;
use crate::chart::{Key, Marks, Panel, Series, Sheet};
use crate::job::Job;
use crate::journey::{Journey, Shown};

/// What a map says of a cell that the truth classifies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    TruePositive,
    TrueNegative,
    FalseNegative,
    FalsePositive,
    Unclassified,
}

impl Verdict {
    const ALL: [Self; 5] = [
        Self::TruePositive,
        Self::TrueNegative,
        Self::FalseNegative,
        Self::FalsePositive,
        Self::Unclassified,
    ];

    /// Of a cell that is safe or not in truth, and in the map.
    fn of(safe: bool, found: Option<bool>) -> Self {
        match (safe, found) {
            (false, Some(false)) => Self::TruePositive,
            (true, Some(true)) => Self::TrueNegative,
            (false, Some(true)) => Self::FalseNegative,
            (true, Some(false)) => Self::FalsePositive,
            (_, None) => Self::Unclassified,
        }
    }

    /// Right cells are grey; none has the colour of a label.
    fn colour(self) -> RGBColor {
        match self {
            Self::TruePositive => RGBColor(150, 150, 150),
            Self::TrueNegative => RGBColor(226, 226, 226),
            Self::FalseNegative => RGBColor(214, 0, 110),
            Self::FalsePositive => RGBColor(40, 20, 60),
            Self::Unclassified => RGBColor(255, 236, 160),
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Self::TruePositive => "right: unsafe (TP)",
            Self::TrueNegative => "right: safe (TN)",
            Self::FalseNegative => "WRONG: called safe, is unsafe (FN)",
            Self::FalsePositive => "wrong: called unsafe, is safe (FP)",
            Self::Unclassified => "not classified",
        }
    }
}

/// What each world shows, and its columns of maps against the truth.
const SIGHTS: [&str; 5] = [
    "ramp down, drop-off 0.5 m",
    "ramp up, lounge -0.3 m, pit -0.6 m",
    "two ramps, steep wedge",
    "steps of 15 cm",
    "kerbs of 15 cm, stair down",
];
const COLUMNS: [(&str, &str); 3] =
    [("multi-scale", "safety-map"), ("exact", "safety-map"), ("multi-scale", "safety-map-plus")];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let (mut panels, mut rows) = (Vec::new(), Vec::new());
    for ((world, frame), sight) in SHOWN.into_iter().zip(SIGHTS) {
        let journeys = up_to_shown(job, world, frame)?;
        for (entry, journey) in entries().iter().zip(&journeys) {
            rows.push(row(world, frame, entry, &shown(journey)?.case.strict));
        }
        panels.extend(panels_of(&format!("{world}: {sight}"), &journeys)?);
    }
    let header = [
        "world",
        "frame",
        "matcher",
        "method",
        "tp",
        "tn",
        "fn",
        "fp",
        "unclassified_unsafe",
        "unclassified_safe",
    ];
    job.write_table(&header, rows)?;
    let verdicts = Verdict::ALL.map(|v| (v.meaning().to_owned(), v.colour()));
    let key: Vec<Key> = label_key().into_iter().chain(verdicts).collect();
    let sheet = Sheet {
        title: "Safety maps while they are made, against the truth (Murarka and Kuipers 2009, Fig. 7)".into(),
        notes: vec![
            "one frame of each world; counted are the cells within 4 m of the robot (circle; the triangle \
             looks where the robot looks)"
                .into(),
            "titles: TP unsafe cells found, FN unsafe ones called safe, FP safe ones called unsafe, none: cells \
             without a label in the map; inside of circles white is where the truth has no label"
                .into(),
        ],
        columns: 2 + COLUMNS.len(),
        panel: PANEL,
        panels,
    };
    job.write_keyed_picture(&sheet, &key)
}

fn shown(journey: &Journey) -> Result<&Shown> {
    journey.shown.as_ref().context("a drive that ends before the frame that is shown")
}

fn row(world: &str, frame: usize, entry: &Entry, counts: &SafetyCounts) -> Vec<String> {
    let names = [world.to_owned(), frame.to_string(), entry.matcher.to_owned(), entry.method.to_owned()];
    let numbers = [
        counts.true_positives,
        counts.true_negatives,
        counts.false_negatives,
        counts.false_positives,
        counts.unclassified_unsafe,
        counts.unclassified_safe,
    ];
    names.into_iter().chain(numbers.map(|n| n.to_string())).collect()
}

/// The panels of a world: truth, the map of the paper's method, then the errors.
fn panels_of(title: &str, journeys: &[Journey]) -> Result<Vec<Panel>> {
    let of = |(matcher, method): (&'static str, &'static str)| {
        let number = entries().iter().position(|entry| *entry == Entry::plain(matcher, method));
        shown(&journeys[number.with_context(|| format!("no map of {method} on {matcher}"))?])
    };
    let first = of(COLUMNS[0])?;
    let mut panels = vec![
        map_panel(format!("TRUTH  {title}"), &first.truth, first),
        map_panel("MAP  safety-map, multi-scale matching".into(), &first.map, first),
    ];
    for (matcher, method) in COLUMNS {
        panels.push(error_panel(&format!("{method}, {matcher}"), of((matcher, method))?));
    }
    Ok(panels)
}

fn map_panel(title: String, map: &SafetyMap, shown: &Shown) -> Panel {
    let mut series = label_series(map);
    series.extend(robot_series(&shown.robot));
    panel(title, map.spec(), series)
}

fn error_panel(name: &str, shown: &Shown) -> Panel {
    let disc = PlanningDisc { at_m: shown.robot.at_m, radius_m: 4.0 };
    let (verdicts, ny) = (verdicts(&shown.map, &shown.truth, disc), shown.truth.spec().shape()[1]);
    let patches = patches(shown.truth.spec());
    let mut series: Vec<Series> = Verdict::ALL
        .into_iter()
        .map(|own| {
            let areas = patches.areas(|i, j| verdicts[i * ny + j] == Some(own));
            Series::new("", own.colour(), Marks::Areas(areas))
        })
        .collect();
    series.extend(robot_series(&shown.robot));
    panel(format!("{name}: {}", summary(&shown.case.strict)), shown.truth.spec(), series)
}

/// The counts of one map.
fn summary(counts: &SafetyCounts) -> String {
    let (hits, missed, alarms) = (counts.true_positives, counts.false_negatives, counts.false_positives);
    format!("TP {hits}, FN {missed}, FP {alarms}, none {}", counts.unclassified())
}

/// What a map says of each cell of the truth within a disc; `None` where the truth says nothing.
fn verdicts(map: &SafetyMap, truth: &SafetyMap, disc: PlanningDisc) -> Vec<Option<Verdict>> {
    let found =
        |flat| map.spec().cell_of(truth.spec().centre_m(flat)).and_then(|cell| map.labels()[cell].is_safe());
    let verdict = |(flat, safe): (usize, Option<bool>)| {
        let safe = safe.filter(|_| disc.contains(truth.spec(), flat))?;
        Some(Verdict::of(safe, found(flat)))
    };
    truth.labels().iter().map(|label| label.is_safe()).enumerate().map(verdict).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::{PlanSpec, SafetyLabel};
    use evigrid_metrics::{SafetyCase, SafetyReference};

    fn map(labels: [SafetyLabel; 8]) -> SafetyMap {
        let mut map = SafetyMap::unknown(PlanSpec::of_area([0.0, 8.0], [0.0, 1.0], 1.0).unwrap());
        labels.into_iter().enumerate().for_each(|(cell, label)| map.set(cell, label, None));
        map
    }

    /// The last cell is out of reach, the one before has no truth.
    #[test]
    fn verdicts_by_hand_and_as_they_are_counted() {
        use SafetyLabel::{Inclined, Level, NonGround, Unknown};
        let truth = map([NonGround, NonGround, NonGround, Level, Inclined, Level, Unknown, Level]);
        let found = map([NonGround, Level, Unknown, NonGround, Level, Unknown, Level, Level]);
        let disc = PlanningDisc { at_m: [0.5, 0.5], radius_m: 6.5 };
        let expected = [
            Some(Verdict::TruePositive),
            Some(Verdict::FalseNegative),
            Some(Verdict::Unclassified),
            Some(Verdict::FalsePositive),
            Some(Verdict::TrueNegative),
            Some(Verdict::Unclassified),
            None,
            None,
        ];
        let verdicts = verdicts(&found, &truth, disc);
        assert_eq!(verdicts, expected);
        let counts = SafetyCase::new(&found, &SafetyReference::new(truth), Some(disc)).strict;
        let drawn = |own| verdicts.iter().filter(|v| **v == Some(own)).count();
        assert_eq!(
            Verdict::ALL.map(drawn),
            [
                counts.true_positives,
                counts.true_negatives,
                counts.false_negatives,
                counts.false_positives,
                counts.unclassified(),
            ]
        );
        assert_eq!(summary(&counts), "TP 1, FN 1, FP 1, none 2");
        assert_eq!(row("w", 3, &Entry::plain("exact", "m"), &counts)[4..], ["1", "1", "1", "1", "1", "1"]);
    }
}
