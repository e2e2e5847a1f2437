//! Section 4.1 compares block matching and graph cuts in words ("considered fast"; "the most precise"). Here
//! they are measured, with semi-global matching beside them, where the true disparity is known.

use std::path::Path;

use anyhow::Result;
use evigrid_core::{Disparity, Frame, MatchFilter, MatchLimits, Matches, Pose};
use evigrid_eval::Clock;
use evigrid_metrics::MatchingScores;
use evigrid_replay::{Sequence, middlebury_truth};
use evigrid_stereo::{Extras, Matcher, PairTask};
use evigrid_synth::{LeftViewTruth, SyntheticSequence, World};
use evigrid_truth::projected_disparity;

use super::contenders::{Contender, contenders, variants};
use crate::chart::{Axis, COLOURS, Corner, Marks, Panel, Series, Sheet};
use crate::job::Job;
use crate::table::rounded;

/// Real data: id, disparities, frames.
const REAL: [(&str, usize, &[usize]); 2] =
    [("middlebury-cones", 64, &[0]), ("2011_09_26_drive_0013", 128, &[0])];
/// Worlds, of which the first frame is matched.
const WORLDS: [&str; 3] = ["street", "bars", "corridor"];
const WORLD_DISPARITIES: usize = 64;
/// A measurement off by more than this is wrong, pixels. The laser is hardly better than the first itself.
const TOLERANCES_PX: [f32; 2] = [1.0, 3.0];
/// Timed runs, of which the fastest counts; a matcher that takes longer than this runs once.
const REPETITIONS: usize = 3;
const LONG_MS: f64 = 1000.0;

/// Frames with their true disparity.
struct Data {
    name: String,
    pairs: Vec<(Frame, Disparity)>,
}

/// The result of one matcher on one data set.
struct Row {
    data: String,
    frames: usize,
    matcher: &'static str,
    scores: [MatchingScores; 2],
    milliseconds: f64,
}

const HEADER: [&str; 8] = [
    "data_set",
    "frames",
    "matcher",
    "wrong_over_1px_percent",
    "wrong_over_3px_percent",
    "mean_error_px",
    "density_percent",
    "milliseconds",
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut rows = Vec::new();
    for (id, disparities, frames) in REAL {
        let Some(data) = real(job, id, frames)? else {
            log::warn!("{id} is left out: {}", job.missing(id));
            continue;
        };
        rows.extend(compare(job, &data, contenders(disparities))?);
        if id == REAL[0].0 {
            let variants = compare(job, &data, variants(disparities))?;
            job.write_more("variants", &HEADER, variants.iter().map(Row::cells))?;
        }
    }
    for name in WORLDS {
        rows.extend(compare(job, &synthetic(name)?, contenders(WORLD_DISPARITIES))?);
    }
    job.write_table(&HEADER, rows.iter().map(Row::cells))?;
    job.write_picture(&picture(&rows))
}

/// Matchers on one data set.
fn compare(job: &mut Job<'_, '_>, data: &Data, contenders: Vec<Contender>) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for contender in contenders {
        job.say(&format!("{}, {}", data.name, contender.name));
        rows.push(contender.run(data, job.tools.clock)?);
    }
    Ok(rows)
}

impl Contender {
    fn run(&self, data: &Data, clock: &dyn Clock) -> Result<Row> {
        let mut matcher = Matcher::new(self.settings)?;
        let (mut scores, mut milliseconds) = ([MatchingScores::default(); 2], 0.0);
        for (frame, truth) in &data.pairs {
            let mut fastest = f64::INFINITY;
            let mut last = None;
            for _ in 0..REPETITIONS {
                let start = clock.now_ms();
                let task = PairTask::new(frame.left(), frame.right(), Extras::default());
                last = Some(matcher.run(PairTask { recycled: last.take(), ..task })?);
                fastest = fastest.min(clock.now_ms() - start);
                if fastest > LONG_MS {
                    break;
                }
            }
            milliseconds += fastest;
            if let Some(matching) = last {
                let found = self.found(matching.matches)?;
                for (scores, tolerance_px) in scores.iter_mut().zip(TOLERANCES_PX) {
                    *scores = scores.plus(MatchingScores::new(&found, truth, tolerance_px)?);
                }
            }
        }
        let frames = data.pairs.len();
        let milliseconds = milliseconds / frames as f64;
        Ok(Row { data: data.name.clone(), frames, matcher: self.name, scores, milliseconds })
    }

    /// The disparities that count.
    fn found(&self, matches: Matches) -> Result<Disparity> {
        if !self.checked {
            return Ok(matches.disparity);
        }
        Ok(MatchFilter::new(&matches, &MatchLimits::left_right(Some(1))).disparity()?)
    }
}

/// Frames of a data set that the project knows, if it is there: their truth is
/// the laser's, or the pair's own.
fn real(job: &Job<'_, '_>, id: &str, frames: &[usize]) -> Result<Option<Data>> {
    let Some((_, dir)) = job.dataset(id)? else { return Ok(None) };
    let sequence = evigrid_replay::open(&dir)?;
    let pair = |&index: &usize| {
        let frame = sequence.frame(index, &Pose::identity())?;
        let truth = truth_of(&frame, &dir)?;
        Ok((frame, truth))
    };
    let pairs = frames.iter().map(pair).collect::<Result<_>>()?;
    Ok(Some(Data { name: id.to_owned(), pairs }))
}

fn truth_of(frame: &Frame, dir: &Path) -> Result<Disparity> {
    Ok(match frame.laser() {
        Some(scan) => projected_disparity(scan, frame.rig(), frame.map_from_left())?,
        None => middlebury_truth(dir)?,
    })
}

/// The first frame of a world.
fn synthetic(name: &str) -> Result<Data> {
    let world = World::builtin(name)?;
    let truth = LeftViewTruth::new(&world, 0).disparity()?;
    let frame = SyntheticSequence::new(world).frame(0, &Pose::identity())?;
    Ok(Data { name: format!("synth:{name}"), pairs: vec![(frame, truth)] })
}

impl Row {
    fn wrong_percent(&self) -> [f64; 2] {
        self.scores.map(|scores| 100.0 * scores.error_rate())
    }

    fn density_percent(&self) -> f64 {
        100.0 * self.scores[0].density()
    }

    fn cells(&self) -> [String; 8] {
        let [over_1, over_3] = self.wrong_percent();
        [
            self.data.clone(),
            self.frames.to_string(),
            self.matcher.to_owned(),
            rounded(over_1, 2),
            rounded(over_3, 2),
            rounded(self.scores[0].mean_error_px(), 3),
            rounded(self.density_percent(), 2),
            rounded(self.milliseconds, 1),
        ]
    }
}

/// One panel per data set, one dot per matcher: density against error.
fn picture(rows: &[Row]) -> Sheet {
    let panels = rows.chunk_by(|a, b| a.data == b.data).map(panel).collect();
    Sheet {
        title: "Matchers: how much is matched, and how much of that is wrong".into(),
        notes: vec![
            "of the pixels with known disparity; truth: structured light (Cones), laser (drive), exact \
             (worlds)"
                .into(),
        ],
        columns: 2,
        panel: (640, 420),
        panels,
    }
}

fn panel(rows: &[Row]) -> Panel {
    let highest = rows.iter().map(|row| row.wrong_percent()[0]).filter(|v| !v.is_nan()).fold(0.0, f64::max);
    let dot = |(at, row): (usize, &Row)| {
        let point = (row.density_percent(), row.wrong_percent()[0]);
        let dots = Marks::Dots(if point.1.is_nan() { vec![] } else { vec![point] }, 6);
        let name = format!("{} ({:.0} ms)", row.matcher, row.milliseconds);
        Series::new(name, COLOURS[at % COLOURS.len()], dots)
    };
    Panel {
        title: rows.first().map(|row| row.data.clone()).unwrap_or_default(),
        x: Axis::new("matched, percent", 0.0, 102.0),
        y: Axis::new("of these off by more than 1 px, percent", 0.0, 1.8 * highest),
        series: rows.iter().enumerate().map(dot).collect(),
        legend: Some(Corner::UpperLeft),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::{GrayImage, StereoRig};
    use evigrid_eval::RealClock;

    #[test]
    fn a_shifted_image_is_matched_by_all() {
        let (width, height, shift) = (90, 40, 5);
        let noise = |i: usize| (i.wrapping_mul(2_654_435_761) >> 13) as u8;
        let image =
            |by: usize| (0..width * height).map(|i| noise(i % width + by + i / width * 977)).collect();
        let left = GrayImage::new(width, height, image(0)).unwrap();
        let right = GrayImage::new(width, height, image(shift)).unwrap();
        let (focal_px, baseline_m) = (50.0, 0.2);
        let rig = StereoRig { width, height, focal_px, centre_x_px: 45.0, centre_y_px: 20.0, baseline_m };
        let frame = Frame::new(0, 0, rig, left, right, Pose::identity(), None).unwrap();
        let known =
            (0..width * height).map(|i| if i % width < 16 { f32::NAN } else { shift as f32 }).collect();
        let truth = Disparity::new(width, height, known).unwrap();
        let data = Data { name: "noise".into(), pairs: vec![(frame, truth)] };
        for contender in contenders(16).into_iter().chain(variants(16)) {
            let row = contender.run(&data, &RealClock::default()).unwrap();
            assert!(row.wrong_percent()[0] < 1.0, "{}: {:?}", row.matcher, row.scores);
            assert!(row.density_percent() > 70.0, "{}: {:?}", row.matcher, row.scores);
        }
    }
}
