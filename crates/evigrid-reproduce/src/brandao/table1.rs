//! Table I: how long matching and the inverse sensor model take.

use anyhow::{Context, Result};
use evigrid_core::{Frame, GrayImage, Pose, StereoRig, View};
use evigrid_cost_curve::{CostCurve, WinnerTakeAll};
use evigrid_eval::Config;
use evigrid_grid::{GridSpec, Method};
use evigrid_replay::Sequence;
use evigrid_stereo::BlockMatcher;
use evigrid_synth::{SyntheticSequence, World};

use super::bars::WORLD;
use super::methods::{self, Reading};
use crate::chart::{Axis, BLUE, Corner, GREY, Marks, ORANGE, Panel, Series, Sheet, rectangle};
use crate::job::Job;
use crate::stopwatch::Stopwatch;
use crate::table::{Column, rounded};

/// An image size of the table, with the paper's seconds: matching, and the inverse model of both methods.
#[derive(Debug, Clone, Copy)]
struct Size {
    /// The frame is rendered at 640x480; means over squares of so many pixels make it smaller.
    shrink: usize,
    disparities: usize,
    paper_matching_s: f64,
    paper_winner_s: f64,
    paper_whole_s: f64,
}

const SIZES: [Size; 2] = [
    Size { shrink: 2, disparities: 32, paper_matching_s: 0.04, paper_winner_s: 0.02, paper_whole_s: 0.06 },
    Size { shrink: 1, disparities: 64, paper_matching_s: 0.20, paper_winner_s: 0.12, paper_whole_s: 0.16 },
];

/// Timed runs, after one that is not; the median counts.
const REPETITIONS: usize = 9;
/// The frame of the world, which looks at the bars squarely.
const FRAME: usize = 10;

/// One cell of the table.
struct Timing {
    size: (usize, usize),
    disparities: usize,
    task: &'static str,
    method: String,
    threads: usize,
    seconds: f64,
    /// The fastest run, which other work on the machine disturbs least.
    fastest_s: f64,
    paper_s: f64,
}

const COLUMNS: [Column<Timing>; 9] = [
    ("width", |t| t.size.0.to_string()),
    ("height", |t| t.size.1.to_string()),
    ("disparities", |t| t.disparities.to_string()),
    ("task", |t| t.task.to_owned()),
    ("method", |t| t.method.clone()),
    ("threads", |t| t.threads.to_string()),
    ("median_seconds", |t| rounded(t.seconds, 5)),
    ("fastest_seconds", |t| rounded(t.fastest_s, 5)),
    ("paper_seconds_one_core_of_2.7_ghz", |t| rounded(t.paper_s, 2)),
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let timings = measure(job, &SIZES, REPETITIONS)?;
    let header = COLUMNS.map(|(name, _)| name);
    job.write_table(&header, timings.iter().map(|timing| COLUMNS.map(|(_, cell)| cell(timing))))?;
    job.write_picture(&picture(&timings))
}

/// All sizes with one thread and with all, every method.
fn measure(job: &mut Job<'_, '_>, sizes: &[Size], repetitions: usize) -> Result<Vec<Timing>> {
    let sequence = SyntheticSequence::new(World::builtin(WORLD)?);
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let mut threads = vec![1, all];
    threads.dedup();
    let mut timings = Vec::new();
    for size in sizes {
        let frame = shrunk(&sequence.frame(FRAME, &Pose::identity())?, size.shrink)?;
        for &threads in &threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            job.say(&format!("{}x{}, {threads} threads", frame.rig().width, frame.rig().height));
            let watch = Stopwatch { clock: job.tools.clock, repetitions };
            let row = Measurer { watch, threads };
            timings.extend(pool.install(|| row.time_size(size, &frame))?);
        }
    }
    Ok(timings)
}

/// Times one size after the other.
struct Measurer<'a> {
    watch: Stopwatch<'a>,
    threads: usize,
}

impl Measurer<'_> {
    fn time_size(&self, size: &Size, frame: &Frame) -> Result<Vec<Timing>> {
        let mut timings = Vec::new();
        let winner = methods::winner_take_all(1.5, "");
        for reading in std::iter::once(winner).chain(methods::quick_whole_curve("")) {
            let config = reading.config(&[format!("stereo.disparities={}", size.disparities)])?;
            timings.extend(self.time_method(size, frame, &reading, &config)?);
        }
        Ok(timings)
    }

    fn time_method(
        &self,
        size: &Size,
        frame: &Frame,
        reading: &Reading,
        config: &Config,
    ) -> Result<[Timing; 2]> {
        let method = config.methods.methods().find(reading.method).context("no such method")?;
        let mut mapper = method.build(GridSpec::new(&config.grid)?, &config.methods.table(method.name))?;
        let keep_volume = method.needs.costs;
        let mut matcher = BlockMatcher::new(config.stereo.block())?;
        let mut last = None;
        let matching_s = self.watch.time(|| {
            last = Some(matcher.run(frame.left(), frame.right(), keep_volume, last.take())?);
            Ok(())
        })?;
        let matching = last.context("nothing was matched")?;
        let view = View::new(frame, None, &matching);
        let model_s = self.watch.time(|| {
            mapper.integrate(&view)?;
            Ok(())
        })?;
        let timing = |task, [seconds, fastest_s]: [f64; 2], paper_s| Timing {
            size: (frame.rig().width, frame.rig().height),
            disparities: size.disparities,
            task,
            method: reading.name.clone(),
            threads: self.threads,
            seconds,
            fastest_s,
            paper_s,
        };
        let paper_s = match reading.method {
            WinnerTakeAll::NAME => size.paper_winner_s,
            CostCurve::NAME => size.paper_whole_s,
            _ => f64::NAN,
        };
        Ok([timing("matching", matching_s, size.paper_matching_s), timing("inverse model", model_s, paper_s)])
    }
}

/// The frame with every pixel the mean of a square of the original's.
fn shrunk(frame: &Frame, by: usize) -> Result<Frame> {
    let rig = *frame.rig();
    let n = by as f64;
    // Pixel centres are whole numbers: the square of pixel 0 has its centre at (n - 1) / 2.
    let centre = |pixel: f64| (pixel - (n - 1.0) / 2.0) / n;
    let small = StereoRig {
        width: rig.width / by,
        height: rig.height / by,
        focal_px: rig.focal_px / n,
        centre_x_px: centre(rig.centre_x_px),
        centre_y_px: centre(rig.centre_y_px),
        ..rig
    };
    let image = |image: &GrayImage| {
        let mean = |x: usize, y: usize| {
            let rows = (0..by).flat_map(|i| &image.row(y * by + i)[x * by..(x + 1) * by]);
            let sum: usize = rows.map(|&grey| usize::from(grey)).sum();
            ((sum + by * by / 2) / (by * by)) as u8
        };
        let pixels = (0..small.height).flat_map(|y| (0..small.width).map(move |x| mean(x, y)));
        GrayImage::new(small.width, small.height, pixels.collect())
    };
    let (left, right) = (image(frame.left())?, image(frame.right())?);
    Ok(Frame::new(frame.index(), frame.stamp_ns(), small, left, right, *frame.map_from_left(), None)?)
}

fn picture(timings: &[Timing]) -> Sheet {
    let mut panels = Vec::new();
    for size in SIZES {
        let here: Vec<&Timing> = timings.iter().filter(|t| t.disparities == size.disparities).collect();
        if !here.is_empty() {
            panels.push(panel(&here));
        }
    }
    Sheet {
        title: "Table I: time for one stereo pair".into(),
        notes: vec![
            format!(
                "median of {REPETITIONS}; frame {FRAME} of the world `{WORLD}`, grid of 800x50x20 \
                 cells; the paper: one core at 2.7 GHz"
            ),
            "matching: SAD 7x7 with peak ratio and left-right difference; inverse model: with drawing and \
             fusion"
                .into(),
        ],
        columns: 1,
        panel: (1000, 460),
        panels,
    }
}

/// Three bars per task and method: one thread, all threads, the paper. The first method is on top.
fn panel(timings: &[&Timing]) -> Panel {
    let most = timings.iter().map(|t| t.threads).max().unwrap_or(1);
    let single: Vec<&&Timing> = timings.iter().filter(|t| t.threads == 1).rev().collect();
    let mut bars: [Vec<Vec<(f64, f64)>>; 3] = Default::default();
    for (at, timing) in single.iter().enumerate() {
        let same = |t: &&&Timing| t.threads == most && t.task == timing.task && t.method == timing.method;
        let all = timings.iter().find(same).map_or(f64::NAN, |t| t.seconds);
        for (k, seconds) in [timing.seconds, all, timing.paper_s].into_iter().enumerate() {
            let top = at as f64 + 0.36 - 0.24 * k as f64;
            bars[k].push(rectangle([0.0, 1e3 * seconds], [top - 0.22, top]));
        }
    }
    let longest = bars.iter().flatten().flatten().map(|p| p.0).fold(0.0, f64::max);
    let [one, all, paper] = bars;
    let (width, height) = timings[0].size;
    Panel {
        title: format!("{width}x{height}, {} disparities", timings[0].disparities),
        x: Axis::new("milliseconds", 0.0, 1.1 * longest),
        y: Axis {
            label: String::new(),
            range: [-0.5, single.len() as f64 - 0.5],
            names: single.iter().map(|t| format!("{}: {}", t.method, t.task)).collect(),
        },
        series: vec![
            Series::new("one thread", BLUE, Marks::Areas(one)),
            Series::new(format!("{most} threads"), ORANGE, Marks::Areas(all)),
            Series::new("the paper, one core", GREY, Marks::Areas(paper)),
        ],
        legend: Some(Corner::UpperRight),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shrunk_frame_sees_the_same_directions() {
        let rig = StereoRig {
            width: 4,
            height: 2,
            focal_px: 6.0,
            centre_x_px: 1.5,
            centre_y_px: 0.5,
            baseline_m: 0.1,
        };
        let image = GrayImage::new(4, 2, vec![1, 2, 10, 10, 3, 4, 10, 12]).unwrap();
        let frame = Frame::new(0, 0, rig, image.clone(), image, Pose::identity(), None).unwrap();
        let small = shrunk(&frame, 2).unwrap();
        // Means 2.5 and 10.5, rounded up.
        assert_eq!(small.left().pixels(), [3, 11]);
        // The corner between the four pixels of a square is where the small pixel looks.
        let (a, b) = (frame.rig().ray(0.5, 0.5), small.rig().ray(0.0, 0.0));
        assert!((a - b).norm() < 1e-12, "{a} {b}");
    }
}
