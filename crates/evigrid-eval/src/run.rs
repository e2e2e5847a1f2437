use anyhow::{Context, Result};
use evigrid_core::{Frame, Matches};
use evigrid_grid::Mapper;
use evigrid_replay::write_disparity_png;
use evigrid_stereo::Matching;

use crate::ground_truth::GroundTruth;
use crate::pair_matcher::{PairMatcher, png_name, view};
use crate::prefetch::read_ahead;
use crate::{
    Clock, MethodResult, MethodStep, Observer, Plan, ResultsFolder, RunResult, Scores, StageTime, Step,
};

/// Runs the plan: every frame is matched once, mapped by every method, added to the reference, scored and shown to
/// the observers. Then the maps and the reference are written.
///
/// # Errors
/// If a frame cannot be read, or an observer or a file fails; the run stops there.
pub fn evaluate(
    plan: &Plan,
    clock: &dyn Clock,
    folder: &ResultsFolder,
    observers: &mut [&mut dyn Observer],
) -> Result<RunResult> {
    for observer in observers.iter_mut() {
        observer.begin(&plan.info)?;
    }
    let start = clock.now_ms();
    let mut run = Run::new(plan, clock, folder)?;
    std::thread::scope(|scope| -> Result<()> {
        let frames = read_ahead(scope, plan.sequence.as_ref(), &plan.info.frames, plan.map_from_world, clock);
        for (position, read) in frames.iter().enumerate() {
            let (frame, read_ms) = read?;
            run.step(position, &frame, read_ms, observers)?;
        }
        Ok(())
    })?;
    let result = run.finish(start);
    let maps: Vec<_> = run.mappers.iter().map(|m| m.map()).collect();
    let truth = run.truth.if_any();
    let mut files = Vec::new();
    for observer in observers.iter_mut() {
        files.extend(observer.end(&result, &maps, truth)?);
    }
    folder.publish(files)?;
    Ok(result)
}

/// The state of a run between frames.
struct Run<'a> {
    plan: &'a Plan,
    clock: &'a dyn Clock,
    folder: &'a ResultsFolder,
    matcher: PairMatcher,
    mappers: Vec<Box<dyn Mapper>>,
    truth: GroundTruth,
    /// Stage times of the current frame, and their sums over all frames.
    times: Vec<StageTime>,
    stage_totals: Vec<(&'static str, f64)>,
}

impl<'a> Run<'a> {
    fn new(plan: &'a Plan, clock: &'a dyn Clock, folder: &'a ResultsFolder) -> Result<Self> {
        let config = &plan.info.config;
        let mappers: Result<Vec<_>> = plan.methods.iter().map(|m| m.build(plan.info.spec, config)).collect();
        Ok(Self {
            plan,
            clock,
            folder,
            matcher: PairMatcher::new(config)?,
            mappers: mappers?,
            truth: GroundTruth::new(plan.info.spec, config.truth)?,
            times: Vec::new(),
            stage_totals: Vec::new(),
        })
    }

    /// One frame: match, integrate, truth, score, record.
    fn step(
        &mut self,
        position: usize,
        frame: &Frame,
        read_ms: f64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<()> {
        self.times.clear();
        self.push_time(StageTime { frame: frame.index(), method: None, stage: "read", ms: read_ms });
        let matching = self.match_pair(frame)?;
        self.integrate(frame, &matching);
        self.add_scan(frame);
        let scores = self.score(frame);
        self.record(position, frame, &matching.matches, &scores, observers)?;
        self.matcher.recycle(matching);
        Ok(())
    }

    /// Computes or reads what all methods share, once.
    fn match_pair(&mut self, frame: &Frame) -> Result<Matching> {
        let start = self.clock.now_ms();
        let keep_volume = self.mappers.iter().any(|m| m.needs_volume());
        let matching = self.matcher.run(frame, keep_volume)?;
        self.time(frame, None, "match", start);
        if self.plan.info.config.output.disparity {
            let dir = self.folder.dir().join("disparity");
            std::fs::create_dir_all(&dir).with_context(|| format!("cannot write {}", dir.display()))?;
            write_disparity_png(&dir.join(png_name(frame)), &matching.matches.disparity)?;
        }
        Ok(matching)
    }

    fn integrate(&mut self, frame: &Frame, matching: &Matching) {
        let view = view(frame, matching);
        for i in 0..self.mappers.len() {
            let start = self.clock.now_ms();
            self.mappers[i].integrate(&view);
            self.time(frame, Some(i), "integrate", start);
        }
    }

    fn add_scan(&mut self, frame: &Frame) {
        let start = self.clock.now_ms();
        self.truth.add(frame);
        self.time(frame, None, "truth", start);
    }

    fn score(&mut self, frame: &Frame) -> Vec<Option<Scores>> {
        let tolerances = &self.plan.info.config.score.tolerances_m;
        (0..self.mappers.len())
            .map(|i| {
                let start = self.clock.now_ms();
                let reference = self.truth.reference();
                let scores = reference.map(|r| Scores::of(self.mappers[i].map(), &r, tolerances));
                self.time(frame, Some(i), "score", start);
                scores
            })
            .collect()
    }

    fn record(
        &mut self,
        position: usize,
        frame: &Frame,
        matches: &Matches,
        scores: &[Option<Scores>],
        observers: &mut [&mut dyn Observer],
    ) -> Result<()> {
        let start = self.clock.now_ms();
        let methods: Vec<_> = self
            .mappers
            .iter()
            .zip(&self.plan.info.methods)
            .zip(scores)
            .map(|((m, method), scores)| MethodStep { method, map: m.map(), scores: scores.as_ref() })
            .collect();
        let step = Step { position, frame, matches, truth: self.truth.if_any(), methods: &methods };
        for observer in observers.iter_mut() {
            observer.frame(&step)?;
        }
        self.time(frame, None, "record", start);
        for observer in observers.iter_mut() {
            observer.times(&self.times)?;
        }
        Ok(())
    }

    fn time(&mut self, frame: &Frame, method: Option<usize>, stage: &'static str, start: f64) {
        let ms = self.clock.now_ms() - start;
        self.push_time(StageTime { frame: frame.index(), method, stage, ms });
    }

    fn push_time(&mut self, time: StageTime) {
        self.times.push(time);
        match self.stage_totals.iter_mut().find(|(stage, _)| *stage == time.stage) {
            Some((_, total)) => *total += time.ms,
            None => self.stage_totals.push((time.stage, time.ms)),
        }
    }

    fn finish(&self, start: f64) -> RunResult {
        let reference = self.truth.reference();
        let tolerances = &self.plan.info.config.score.tolerances_m;
        let methods = self.mappers.iter().zip(&self.plan.info.methods);
        let methods = methods
            .map(|(m, name)| MethodResult::of(name, m.map(), reference.as_ref(), tolerances))
            .collect();
        RunResult {
            methods,
            frames: self.plan.info.frames.len(),
            without_laser: self.truth.without_laser().to_vec(),
            wall_ms: self.clock.now_ms() - start,
            stage_totals: self.stage_totals.clone(),
        }
    }
}
