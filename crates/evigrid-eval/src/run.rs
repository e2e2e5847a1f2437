use anyhow::{Context, Result};
use evigrid_core::Matching;
use evigrid_grid::Layer;
use evigrid_metrics::Scores;
use evigrid_replay::write_disparity_png;
use evigrid_results::{MethodResult, ResultsFolder, RunResult, StageTime};

use crate::match_source::png_name;
use crate::pass::{Entrant, Moment, Order, Pass};
use crate::{Clock, LazyModel, LazyPictures, MethodStep, Observer, Plan, Step};

/// Runs the plan: every frame is matched once, mapped by every method, added to the truth, scored and shown
/// to the observers. Then the maps and the truth are written.
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
        observer.begin(&plan.job.info, &plan.job.config)?;
    }
    let start = clock.now_ms();
    let mut pass = Pass::new(&plan.recording, Entrant::all_of(&plan.job))?;
    let mut run = Run { plan, clock, folder, observers, stage_totals: Vec::new() };
    pass.drive(&plan.recording, clock, Order::InTurn, &mut |pass, moment| run.follow(pass, moment))?;
    let maps: Vec<_> = (0..pass.len()).map(|number| pass.maps(number)).collect();
    let methods: Vec<MethodResult> =
        maps.iter().enumerate().map(|(number, maps)| pass.method_result(number, &maps.layers)).collect();
    let result = RunResult {
        wall_ms: clock.now_ms() - start,
        stage_totals: run.stage_totals,
        ..pass.run_result(0, methods)
    };
    let mut files = Vec::new();
    for observer in observers.iter_mut() {
        files.extend(observer.end(&result, &maps, pass.truth(0))?);
    }
    folder.publish(files)?;
    Ok(result)
}

/// The part of a run that looks at the maps after every frame.
struct Run<'a, 'o> {
    plan: &'a Plan,
    clock: &'a dyn Clock,
    folder: &'a ResultsFolder,
    observers: &'a mut [&'o mut dyn Observer],
    /// Sums of the stages' times over all frames.
    stage_totals: Vec<(&'static str, f64)>,
}

impl Run<'_, '_> {
    /// After the frame has been matched, integrated and added to the truth: score, record.
    fn follow(&mut self, pass: &Pass<'_>, moment: Moment<'_>) -> Result<()> {
        let Moment { position, frame, mut times } = moment;
        if let (true, Some(matching)) = (self.plan.job.config.output.disparity, pass.matching(0)) {
            self.write_disparity(&png_name(frame), matching)?;
        }
        let mut scores = Vec::new();
        for number in 0..pass.len() {
            let start = self.clock.now_ms();
            scores.push(pass.scores(number));
            let ms = self.clock.now_ms() - start;
            times.push(StageTime { frame: frame.index(), method: Some(number), stage: "score", ms });
        }
        let start = self.clock.now_ms();
        self.show(pass, position, frame, &scores)?;
        let ms = self.clock.now_ms() - start;
        times.push(StageTime { frame: frame.index(), method: None, stage: "record", ms });
        times.iter().for_each(|time| self.add_time(time));
        self.observers.iter_mut().try_for_each(|observer| observer.times(&times))
    }

    fn show(
        &mut self,
        pass: &Pass<'_>,
        position: usize,
        frame: &evigrid_core::Frame,
        scores: &[Vec<Scores>],
    ) -> Result<()> {
        let layers: Vec<Vec<Layer<'_>>> = (0..pass.len()).map(|number| pass.layers(number)).collect();
        let models: Vec<_> = (0..pass.len()).map(|number| move || pass.hybrid_model(number)).collect();
        let pictures: Vec<_> = (0..pass.len()).map(|number| move || pass.pictures(number)).collect();
        let method = |number: usize| MethodStep {
            method: pass.entrant(number).name(),
            layers: &layers[number],
            scores: &scores[number],
            hybrid: LazyModel::new(&models[number]),
            pictures: LazyPictures::new(&pictures[number]),
        };
        let methods: Vec<_> = (0..pass.len()).map(method).collect();
        let (matching, truth) = (pass.matching(0), pass.truth(0));
        let step = Step { position, frame, matching, truth, methods: &methods };
        self.observers.iter_mut().try_for_each(|observer| observer.frame(&step))
    }

    fn write_disparity(&self, name: &str, matching: &Matching) -> Result<()> {
        let dir = self.folder.dir().join("disparity");
        std::fs::create_dir_all(&dir).with_context(|| format!("cannot write {}", dir.display()))?;
        Ok(write_disparity_png(&dir.join(name), &matching.matches.disparity)?)
    }

    fn add_time(&mut self, time: &StageTime) {
        match self.stage_totals.iter_mut().find(|(stage, _)| *stage == time.stage) {
            Some((_, total)) => *total += time.ms,
            None => self.stage_totals.push((time.stage, time.ms)),
        }
    }
}
