//! Records a run and says what the recording cost: `record DATASET FRAMES OUT_DIR`, e.g. `record synth:street .. out`.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result};
use evigrid_eval::{
    Config, Observer, Plan, RealClock, ResultsFolder, RunInfo, RunResult, Step, evaluate, peak_memory_mib,
};
use evigrid_grid::LogOddsGrid;
use evigrid_record::Recorder;
use evigrid_truth::LaserTruth;

/// Measures another observer.
struct Timed {
    recorder: Recorder,
    frames_ms: Vec<f64>,
    end_ms: f64,
}

impl Observer for Timed {
    fn begin(&mut self, info: &RunInfo) -> Result<()> {
        self.recorder.begin(info)
    }

    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        let start = Instant::now();
        self.recorder.frame(step)?;
        self.frames_ms.push(start.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }

    fn end(&mut self, result: &RunResult, maps: &[&LogOddsGrid], truth: Option<&LaserTruth>) -> Result<()> {
        let start = Instant::now();
        self.recorder.end(result, maps, truth)?;
        self.end_ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(())
    }
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().context("expected DATASET FRAMES OUT_DIR");
    let mut config = Config::default();
    config.run.dataset = next()?;
    config.run.frames = next()?;
    let out = PathBuf::from(next()?);
    let plan = Plan::new(config)?;
    let (folder, _) = ResultsFolder::open(&out)?;
    let path = out.join("recording.rrd");
    let recorder = Recorder::create(path.clone())?;
    let mut timed = Timed { recorder, frames_ms: Vec::new(), end_ms: 0.0 };
    let result = evaluate(&plan, &RealClock::default(), &folder, &mut [&mut timed])?;
    let sum: f64 = timed.frames_ms.iter().sum();
    let longest = timed.frames_ms.iter().copied().fold(0.0, f64::max);
    let frames = result.frames as f64;
    let bytes = std::fs::metadata(&path)?.len() as f64;
    eprintln!(
        "{:.1} ms a frame in the run, of them recording {:.1} (longest {longest:.1}), end {:.1} ms; {:.0} kB a frame; \
         peak memory {:.0} MiB",
        result.wall_ms / frames,
        sum / frames,
        timed.end_ms,
        bytes / frames / 1e3,
        peak_memory_mib().unwrap_or(f64::NAN)
    );
    Ok(())
}
