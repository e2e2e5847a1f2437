//! Fig. 10: hits against mistakes on a real drive, winner-take-all over its peak ratio, the whole curve as a
//! point and over the threshold on its log-odds.

use anyhow::Result;
use evigrid_eval::{Mapped, Recording, map_together};
use evigrid_grid::LayerKind;
use evigrid_metrics::CurvePoint;

use super::methods::{self, CHECKED, DEPTH_M, Reading};
use crate::chart::{Axis, COLOURS, Corner, DARK, Marks, Panel, Series, Sheet};
use crate::drive;
use crate::job::Job;
use crate::table::rounded;

/// Peak ratios of the baseline in the paper, and those below, which reach more hits.
const RATIOS: [f64; 3] = [1.5, 12.0, 0.5];
const LOWER_RATIOS: [f64; 5] = [1.0, 1.1, 1.2, 1.3, 1.4];
/// The baseline's default, metres.
const NEAR_M: f64 = 25.0;
const PAPER: &str = "fewer mistakes than winner-take-all at equal hits";

/// A condition under which methods are compared.
#[derive(Debug, Clone, Copy)]
struct Condition {
    depth_m: f64,
    check: bool,
}

/// The first one is the paper's.
const CONDITIONS: [Condition; 3] = [
    Condition { depth_m: DEPTH_M, check: false },
    Condition { depth_m: NEAR_M, check: false },
    Condition { depth_m: NEAR_M, check: true },
];

/// A method's map, by its curve over the threshold.
struct Curve {
    reading: Reading,
    points: Vec<CurvePoint>,
    true_cells: usize,
}

/// All methods under one condition.
struct Group {
    condition: Condition,
    baseline: Vec<Curve>,
    whole: Vec<Curve>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let drive = drive::require(job)?;
    let recording = Recording::from(evigrid_replay::open(&drive.dir)?);
    let id = recording.sequence().info().id.clone();
    let base = [format!("run.frames={}", drive.frames)];
    let readings: Vec<Reading> = CONDITIONS.iter().flat_map(Condition::readings).collect();
    let configs: Result<Vec<_>> = readings.iter().map(|reading| reading.config(&base)).collect();
    job.say(&format!("{} maps of {}, frames {}", readings.len(), id, drive.frames));
    let look = |mapped: &Mapped<'_>| {
        Ok(mapped.result.scores_of(LayerKind::Voxels).and_then(|scores| scores.curve.clone()))
    };
    let found = map_together(&recording, configs?, job.tools.clock, &look, &mut || {})?;
    let mut curves = readings.into_iter().zip(found).map(|(reading, curve)| {
        let (points, true_cells) = curve.map_or((Vec::new(), 0), |c| (c.points, c.true_cells));
        Curve { reading, points, true_cells }
    });
    let groups: Vec<Group> =
        CONDITIONS.iter().map(|condition| Group::take(*condition, &mut curves)).collect();
    let header = [
        "method",
        "setting",
        "max_depth_m",
        "left_right_check",
        "log_odds_threshold",
        "hits",
        "mistakes",
        "precision",
        "recall",
        "f1",
        "winner_take_all_mistakes_at_equal_hits",
        "over_its_threshold_instead",
        "paper",
    ];
    job.write_table(&header, groups.iter().flat_map(Group::rows))?;
    job.write_picture(&Sheet {
        title: format!("Fig. 10: hits against mistakes, {id}, frames {}", drive.frames),
        notes: vec![
            "winner-take-all: one dot per peak ratio, 1 to 12 (the paper: from 1.5 on); whole curve: the \
             dot is P > 0.5, the line other thresholds; better is up and to the left"
                .into(),
            format!("the paper, on other drives: the whole curve has {PAPER}"),
        ],
        columns: CONDITIONS.len(),
        panel: (560, 520),
        panels: groups.iter().map(Group::panel).collect(),
    })
}

impl Condition {
    /// The baseline over its peak ratios, then the methods that are shown over their threshold.
    fn readings(&self) -> Vec<Reading> {
        let all = ratios().map(|ratio| methods::winner_take_all(ratio, "")).chain(over_threshold());
        let all = all.map(|reading| reading.within_depth(self.depth_m));
        all.map(|reading| if self.check { reading.checked() } else { reading.unchecked() }).collect()
    }

    fn name(&self) -> String {
        let check = if self.check { "with left-right check" } else { "no left-right check" };
        format!("up to {} m, {check}", self.depth_m)
    }
}

/// The whole-curve methods, and the baseline without a filter.
fn over_threshold() -> Vec<Reading> {
    // The baseline is last.
    let mut readings = methods::quick_whole_curve(PAPER);
    readings.push(methods::winner_take_all(1.0, ""));
    readings
}

fn ratios() -> impl Iterator<Item = f64> {
    let [from, to, step] = RATIOS;
    let count = ((to - from) / step).round() as usize + 1;
    LOWER_RATIOS.into_iter().chain((0..count).map(move |i| from + i as f64 * step))
}

impl Curve {
    /// Hits and mistakes at P > 0.5.
    fn point(&self) -> Option<CurvePoint> {
        self.points.iter().copied().find(|point| point.log_odds == 0.0)
    }

    fn row(&self, condition: Condition, point: &CurvePoint, equal: [Option<f64>; 2]) -> [String; 13] {
        let CurvePoint { log_odds, hits, mistakes } = *point;
        let share = |part: usize, whole: usize| part as f64 / whole as f64;
        let missed = self.true_cells - hits;
        [
            self.reading.method.to_owned(),
            self.reading.name.clone(),
            condition.depth_m.to_string(),
            condition.check.to_string(),
            log_odds.to_string(),
            hits.to_string(),
            mistakes.to_string(),
            rounded(share(hits, hits + mistakes), 4),
            rounded(share(hits, self.true_cells), 4),
            rounded(share(2 * hits, 2 * hits + mistakes + missed), 4),
            rounded(equal[0].unwrap_or(f64::NAN), 0),
            rounded(equal[1].unwrap_or(f64::NAN), 0),
            if log_odds == 0.0 { self.reading.paper.to_owned() } else { String::new() },
        ]
    }
}

impl Group {
    fn take(condition: Condition, curves: &mut impl Iterator<Item = Curve>) -> Self {
        let baseline = curves.by_ref().take(ratios().count()).collect();
        let whole = curves.by_ref().take(over_threshold().len()).collect();
        Self { condition, baseline, whole }
    }

    fn rows(&self) -> Vec<[String; 13]> {
        let (points, threshold) = (self.baseline_points(), self.baseline_over_threshold());
        let baseline =
            self.baseline.iter().filter_map(|c| Some(c.row(self.condition, &c.point()?, [None; 2])));
        let whole = self.whole.iter().flat_map(|curve| {
            let equal = |p: &CurvePoint| [&points, &threshold].map(|line| mistakes_at(line, p.hits as f64));
            curve.points.iter().map(move |p| (curve, p, equal(p))).collect::<Vec<_>>()
        });
        baseline.chain(whole.map(|(curve, p, equal)| curve.row(self.condition, p, equal))).collect()
    }

    /// (mistakes, hits) of the baseline without a filter, by its threshold.
    fn baseline_over_threshold(&self) -> Vec<(f64, f64)> {
        let unfiltered = self.whole.last().map(|curve| &curve.points[..]).unwrap_or_default();
        unfiltered.iter().copied().map(place).collect()
    }

    /// (mistakes, hits) of the baseline, from the smallest peak ratio on.
    fn baseline_points(&self) -> Vec<(f64, f64)> {
        self.baseline.iter().filter_map(Curve::point).map(place).collect()
    }

    fn panel(&self) -> Panel {
        let baseline = self.baseline_points();
        let dots: Vec<(f64, f64)> = self.whole.iter().filter_map(Curve::point).map(place).collect();
        let all = || baseline.iter().chain(&dots);
        let end = 1.05 * all().map(|p| p.0).fold(1.0, f64::max);
        let true_cells = self.whole.iter().map(|c| c.true_cells).max().unwrap_or(1) as f64;
        let mut series = vec![
            Series::new("winner-take-all over the peak ratio", DARK, Marks::Line(baseline.clone())),
            Series::new("", DARK, Marks::Dots(baseline, 3)),
        ];
        for (curve, colour) in self.whole.iter().zip(COLOURS.into_iter().cycle()) {
            let line = curve.points.iter().copied().map(place).filter(|p| p.0 <= end).collect();
            series.push(Series::new(curve.reading.name.trim_end_matches(CHECKED), colour, Marks::Line(line)));
            series.push(Series::new(
                "",
                colour,
                Marks::Dots(curve.point().map(place).into_iter().collect(), 6),
            ));
        }
        Panel {
            title: self.condition.name(),
            x: Axis::new("mistakes (cells)", 0.0, end),
            // Room for the legend above the curves.
            y: Axis::new(&format!("hits (cells, of {true_cells})"), 0.0, 1.3 * true_cells),
            series,
            legend: Some(Corner::UpperLeft),
        }
    }
}

fn place(point: CurvePoint) -> (f64, f64) {
    (point.mistakes as f64, point.hits as f64)
}

/// Mistakes of the baseline where it has so many hits, straight between its
/// points; `None` where it never has.
fn mistakes_at(baseline: &[(f64, f64)], hits: f64) -> Option<f64> {
    baseline.windows(2).find_map(|pair| {
        let [(m0, h0), (m1, h1)] = [pair[0], pair[1]];
        let is_between = (h0.min(h1)..=h0.max(h1)).contains(&hits);
        let share = if h1 == h0 { 0.0 } else { (hits - h0) / (h1 - h0) };
        is_between.then_some(m0 + share * (m1 - m0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_the_paper() {
        let all: Vec<f64> = ratios().collect();
        assert_eq!((all.len(), all[0], all[5], all[26]), (27, 1.0, 1.5, 12.0));
    }

    #[test]
    fn mistakes_at_equal_hits_by_hand() {
        let baseline = [(100.0, 50.0), (40.0, 30.0), (10.0, 30.0), (0.0, 10.0)];
        assert_eq!(mistakes_at(&baseline, 40.0), Some(70.0));
        assert_eq!(mistakes_at(&baseline, 30.0), Some(40.0));
        assert_eq!(mistakes_at(&baseline, 20.0), Some(5.0));
        assert_eq!(mistakes_at(&baseline, 51.0), None);
        assert_eq!(mistakes_at(&baseline, 5.0), None);
    }
}
