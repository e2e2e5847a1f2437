use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use evigrid_eval::{Config, Observer, Step, SweepStep, Truth};
use evigrid_results::{MethodMaps, RunInfo, RunResult, SealedFile};
use evigrid_synth::WriteStep;
use indicatif::{ProgressBar, ProgressStyle};

use crate::output::note;

/// Shows how far a run is: a bar on a terminal, a line every tenth of the run otherwise. Both on standard
/// error.
#[derive(Debug, Default)]
pub struct Progress {
    bar: Option<ProgressBar>,
    total: usize,
}

impl Observer for Progress {
    fn begin(&mut self, info: &RunInfo, _: &Config) -> Result<()> {
        self.total = info.frames.len();
        let bar = ProgressBar::new(self.total as u64);
        if !bar.is_hidden() {
            bar.set_style(ProgressStyle::with_template("{bar:30} frame {pos}/{len}, {per_sec} {msg}")?);
            bar.enable_steady_tick(Duration::from_millis(200));
            self.bar = Some(bar);
        }
        Ok(())
    }

    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        let done = step.position + 1;
        let scores = step.methods.iter().flat_map(|m| {
            let main = m.scores.iter().filter_map(|scores| scores.main());
            main.map(|score| {
                format!("{} {} {}", m.method, score.metric.heading().unwrap_or_default(), score.shown())
            })
        });
        let scores = scores.collect::<Vec<_>>().join(", ");
        match &self.bar {
            Some(bar) => {
                bar.set_message(scores);
                bar.set_position(done as u64);
            }
            None if done * 10 / self.total > (done - 1) * 10 / self.total => {
                note(&format!("frame {done}/{}: {scores}", self.total));
            }
            None => {}
        }
        Ok(())
    }

    fn end(&mut self, _: &RunResult, _: &[MethodMaps<'_>], _: &Truth) -> Result<Vec<SealedFile>> {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        Ok(Vec::new())
    }
}

/// Shows how far writing a data set is, as [`Progress`] does.
#[derive(Debug, Default)]
pub struct WriteProgress {
    bar: Option<ProgressBar>,
    shown_tenths: usize,
}

impl WriteProgress {
    /// The next step of writing to the folder `out`.
    pub fn show(&mut self, step: WriteStep, out: &Path) {
        match step {
            WriteStep::LeftOver => {
                log::warn!("an earlier run for {} did not finish; removed what it left", out.display());
            }
            WriteStep::Truth => self.begin(),
            WriteStep::Frames { done, total } => self.frames(done, total),
        }
    }

    fn begin(&mut self) {
        let bar = ProgressBar::new_spinner();
        if bar.is_hidden() {
            note("exact truth");
            return;
        }
        bar.set_message("exact truth");
        bar.enable_steady_tick(Duration::from_millis(200));
        self.bar = Some(bar);
    }

    fn frames(&mut self, done: usize, total: usize) {
        let tenths = done * 10 / total;
        match &self.bar {
            Some(bar) => {
                if let (0, Ok(style)) = (done, ProgressStyle::with_template("{bar:30} frame {pos}/{len}")) {
                    bar.set_style(style);
                    bar.set_length(total as u64);
                }
                bar.set_position(done as u64);
            }
            None if tenths > self.shown_tenths => note(&format!("frame {done}/{total}")),
            None => {}
        }
        self.shown_tenths = tenths;
    }
}

impl Drop for WriteProgress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Shows how far a sweep is, as [`Progress`] does.
#[derive(Debug, Default)]
pub struct SweepProgress {
    bar: Option<ProgressBar>,
    frames: usize,
}

impl SweepProgress {
    /// The next step of a sweep into the folder `out`.
    pub fn show(&mut self, step: SweepStep<'_>, out: &Path) {
        match step {
            SweepStep::LeftOver(names) => {
                let names = names.join(", ");
                log::warn!(
                    "an earlier sweep in {} did not finish; removed what it left: {names}",
                    out.display()
                );
            }
            SweepStep::Kept { kept: 0, .. } => {}
            SweepStep::Kept { kept, total } => note(&format!("{kept} of {total} points are there already")),
            SweepStep::Pass { dataset, points, frames } => self.begin(dataset, points, frames),
            SweepStep::Frame(done) => self.frame(done),
        }
    }

    fn begin(&mut self, dataset: &str, points: usize, frames: usize) {
        self.frames = frames;
        self.clear();
        note(&format!("{dataset}: {points} points, {frames} frames"));
        let bar = ProgressBar::new(frames as u64);
        if let (false, Ok(style)) =
            (bar.is_hidden(), ProgressStyle::with_template("{bar:30} frame {pos}/{len}, {per_sec}"))
        {
            bar.set_style(style);
            self.bar = Some(bar);
        }
    }

    fn frame(&self, done: usize) {
        match &self.bar {
            Some(bar) => bar.set_position(done as u64),
            None if done * 10 / self.frames > (done - 1) * 10 / self.frames => {
                note(&format!("frame {done}/{}", self.frames));
            }
            None => {}
        }
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for SweepProgress {
    fn drop(&mut self) {
        self.clear();
    }
}
