//! Section VII-D: milliseconds of each stage of a frame, and whether they grow while the robot drives.
//!
//! A drive is made twice into one map, with the same images. What the second drive costs more than the first at
//! the same frames, is what the history of the map costs. Over its early frames the first drive meets an empty map;
//! over its late ones it has seen what there is to see, so that those are compared. Stereo is not counted, as in
//! the paper; everything counted runs on one thread.

use anyhow::Result;
use evigrid_eval::Clock;
use evigrid_safety_map::Stage;
use plotters::style::RGBColor;

use super::mapping::Drive;
use super::published::{LABELS_MS, MODEL_MS};
use crate::chart::{Axis, BLUE, Corner, Marks, ORANGE, Panel, Point, Series, Sheet};
use crate::job::Job;
use crate::table::rounded;

/// 10 x 10 x 3 m in voxels of 0.1 m, as in the paper, and the paper's kind of matcher.
const WORLD: &str = "safety-1";
const MATCHER: &str = "multi-scale";

/// Frames at either end of a drive that count as early and late.
const END: usize = 100;

/// Names of the stages, in order, and the paper's milliseconds.
const STAGES: [(Stage, &str, Option<f64>); 4] = [
    (Stage::Outliers, "outlier readings", None),
    (Stage::Model, "update of the model", Some(MODEL_MS)),
    (Stage::Columns, "columns and their points", None),
    (Stage::Labels, "segments, planes, labels", Some(LABELS_MS)),
];

/// Milliseconds of the stages of each frame that was used, in the order of [`STAGES`].
type Times = Vec<[f64; 4]>;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let drive = Drive::new(WORLD)?;
    let mut map = drive.mapping(MATCHER)?;
    let mut drives: Vec<Times> = Vec::new();
    for name in ["first", "second"] {
        job.say(&format!("synth:{WORLD}, {} frames, {name} drive", drive.frames().len()));
        let mut times = Times::new();
        for index in drive.frames() {
            let mut watch = StageWatch::new(job.tools.clock);
            if drive.add(&drive.frame(index)?, &mut map, &mut |stage| watch.done(stage))? {
                times.push(watch.ms);
            }
        }
        drives.push(times);
    }
    let header = ["stage", "drive", "frames", "count", "mean_ms", "median_ms", "max_ms", "paper_ms"];
    job.write_table(&header, rows(&drives))?;
    job.write_picture(&sheet(&drives))
}

/// Times the stages of one frame.
struct StageWatch<'a> {
    clock: &'a dyn Clock,
    last: f64,
    ms: [f64; 4],
}

impl<'a> StageWatch<'a> {
    fn new(clock: &'a dyn Clock) -> Self {
        Self { clock, last: 0.0, ms: [0.0; 4] }
    }

    /// A stage is done; `None`: the first one begins.
    fn done(&mut self, stage: Option<Stage>) {
        let now = self.clock.now_ms();
        let number = STAGES.iter().position(|(known, ..)| Some(*known) == stage);
        if let Some(number) = number {
            self.ms[number] = now - self.last;
        }
        self.last = now;
    }
}

/// Mean, median and largest of some times; NaN without any.
fn summary(times: &[f64]) -> [f64; 3] {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
    let at = |n: Option<usize>| n.and_then(|n| sorted.get(n)).copied().unwrap_or(f64::NAN);
    [mean, at(Some(sorted.len() / 2)), at(sorted.len().checked_sub(1))]
}

/// A column of the times; the last one is the sum of all stages.
fn column(times: &[[f64; 4]], stage: usize) -> Vec<f64> {
    times.iter().map(|ms| ms.get(stage).copied().unwrap_or_else(|| ms.iter().sum())).collect()
}

/// Parts of a drive: all frames, the early and the late ones.
fn parts(times: &[[f64; 4]]) -> [(&'static str, &[[f64; 4]]); 3] {
    let end = END.min(times.len());
    [("all", times), ("early", &times[..end]), ("late", &times[times.len() - end..])]
}

fn rows(drives: &[Times]) -> Vec<Vec<String>> {
    let paper = |stage: usize| STAGES.get(stage).map_or(Some(MODEL_MS + LABELS_MS), |known| known.2);
    let mut rows = Vec::new();
    for stage in 0..=STAGES.len() {
        let name = STAGES.get(stage).map_or("all", |known| known.1);
        for (number, times) in drives.iter().enumerate() {
            for (part, times) in parts(times) {
                let mut row =
                    vec![name.into(), (number + 1).to_string(), part.into(), times.len().to_string()];
                row.extend(summary(&column(times, stage)).map(|ms| rounded(ms, 3)));
                row.push(paper(stage).map_or_else(String::new, |ms| ms.to_string()));
                rows.push(row);
            }
        }
    }
    rows
}

fn sheet(drives: &[Times]) -> Sheet {
    Sheet {
        title: "Time of a frame, stage by stage (Murarka and Kuipers 2009, section VII-D)".into(),
        notes: vec![
            format!("synth:{WORLD}, {MATCHER} disparities, 640 x 480 pixels, 10 x 10 x 3 m in voxels of 0.1 m"),
            "the same images are driven through twice into one map: the cost of its history would be orange over \
             blue"
                .into(),
        ],
        columns: 2,
        panel: (520, 270),
        panels: (0..STAGES.len()).map(|stage| panel(drives, stage)).collect(),
    }
}

fn panel(drives: &[Times], stage: usize) -> Panel {
    let (_, name, paper) = STAGES[stage];
    let means: Vec<f64> = drives.iter().map(|times| summary(&column(times, stage))[0]).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let paper = paper.map_or_else(String::new, |ms| format!("; the paper: {ms} ms"));
    let frames = drives.iter().map(Vec::len).max().unwrap_or(0);
    let colours = [("first drive", BLUE), ("second drive", ORANGE)];
    let line = |(times, (name, colour)): (&Times, (&str, RGBColor))| {
        let points = (0..).zip(smooth(&column(times, stage))).map(|(n, ms)| (f64::from(n), ms));
        Series::new(name, colour, Marks::Line(points.collect::<Vec<Point>>()))
    };
    Panel {
        title: format!("{name}: mean {mean:.2} ms{paper}"),
        x: Axis::new("frames used, of each drive", 0.0, frames as f64),
        y: Axis::new("ms, median of 9 frames", 0.0, 3.0 * mean),
        series: drives.iter().zip(colours).map(line).collect(),
        legend: (stage == 0).then_some(Corner::UpperRight),
    }
}

/// The median of the nine values around each.
fn smooth(values: &[f64]) -> Vec<f64> {
    let around = |n: usize| &values[n.saturating_sub(4)..(n + 5).min(values.len())];
    (0..values.len()).map(|n| summary(around(n))[1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::View;
    use evigrid_eval::MatchSource;
    use evigrid_grid::{GridSpec, Mapper, Method};
    use evigrid_safety_map::SafetyMapping;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// A clock that moves on by one, two, three ... milliseconds.
    #[derive(Default)]
    struct Counting(AtomicU32);

    impl Clock for Counting {
        fn now_ms(&self) -> f64 {
            let n = f64::from(self.0.fetch_add(1, Ordering::Relaxed));
            0.5 * n * (n + 1.0)
        }
    }

    #[test]
    fn summaries_by_hand() {
        assert_eq!(summary(&[3.0, 1.0, 8.0]), [4.0, 3.0, 8.0]);
        assert!(summary(&[]).iter().all(|ms| ms.is_nan()));
        assert_eq!(smooth(&[1.0, 9.0, 1.0, 1.0, 1.0]), [1.0; 5]);
    }

    #[test]
    fn early_and_late_frames_are_the_ends_and_the_last_rows_are_sums() {
        let times: Times = (0..150).map(|n| [f64::from(n), 1.0, 0.0, 2.0]).collect();
        let rows = rows(&[times]);
        let mean = |stage: usize, part: usize| rows[3 * stage + part][4].clone();
        // Means of 0 to 149, of 0 to 99 and of 50 to 149.
        assert_eq!([0, 1, 2].map(|part| mean(0, part)), ["74.500", "49.500", "99.500"]);
        assert_eq!(mean(4, 0), "77.500");
        assert_eq!(rows[12][7], "228");
    }

    /// The map of the stages is the method's, each stage is timed between its own ends, and a second look from
    /// the same place is dropped.
    #[test]
    fn stages_make_the_map_of_the_method() {
        let drive = Drive::new("safety-1").unwrap();
        let mut map = drive.mapping("exact").unwrap();
        let entry = super::super::worlds::Entry::plain("exact", "safety-map");
        let config = entry.config(&drive.world).unwrap();
        let settings = config.methods.of::<SafetyMapping>().unwrap();
        let mut whole = SafetyMapping::new(GridSpec::new(&config.grid).unwrap(), settings).unwrap();
        let mut source = MatchSource::new(&config, Some(drive.mounting), Some(&drive.world)).unwrap();
        let mut used = Vec::new();
        for index in [40, 60, 60, 80] {
            let clock = Counting::default();
            let (mut watch, frame) = (StageWatch::new(&clock), drive.frame(index).unwrap());
            let is_used = drive.add(&frame, &mut map, &mut |stage| watch.done(stage)).unwrap();
            let matching = source.run(&frame, SafetyMapping::NEEDS).unwrap();
            whole.integrate(&View::new(&frame, Some(drive.mounting), &matching)).unwrap();
            let expected = if is_used { [1.0, 2.0, 3.0, 4.0] } else { [0.0; 4] };
            assert_eq!(watch.ms, expected, "frame {index}");
            used.push(is_used);
        }
        assert_eq!(used, [true, true, false, true]);
        assert_eq!(map.mapper.map().labels(), whole.map().labels());
        assert_eq!(map.model().unwrap().evidence(), whole.model().unwrap().evidence());
        assert!(map.model().unwrap().evidence().iter().any(|&evidence| evidence != 0));
    }
}
