use std::time::Duration;

use anyhow::Result;
use evigrid_eval::{Observer, RunInfo, RunResult, SealedFile, Step};
use evigrid_grid::LogOddsGrid;
use evigrid_truth::LaserTruth;
use indicatif::{ProgressBar, ProgressStyle};

/// Shows how far a run is: a bar on a terminal, a line every tenth of the run otherwise. Both on standard error.
#[derive(Debug, Default)]
pub struct Progress {
    bar: Option<ProgressBar>,
    total: usize,
}

impl Observer for Progress {
    fn begin(&mut self, info: &RunInfo) -> Result<()> {
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
        let scores = step.methods.iter().filter_map(|m| {
            let counts = m.scores?.counts;
            Some(format!("{} F1 {:.3}", m.method, counts.f1()))
        });
        let scores = scores.collect::<Vec<_>>().join(", ");
        match &self.bar {
            Some(bar) => {
                bar.set_message(scores);
                bar.set_position(done as u64);
            }
            None if done * 10 / self.total > (done - 1) * 10 / self.total => {
                eprintln!("frame {done}/{}: {scores}", self.total);
            }
            None => {}
        }
        Ok(())
    }

    fn end(&mut self, _: &RunResult, _: &[&LogOddsGrid], _: Option<&LaserTruth>) -> Result<Vec<SealedFile>> {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        Ok(Vec::new())
    }
}
