use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use evigrid_core::stable_hash;
use evigrid_eval::{Config, Observer, Step, Truth};
use evigrid_grid::LayerKind;
use evigrid_results::{MethodMaps, PendingFile, RunInfo, RunResult, SealedFile};
use rerun::archetypes::RecordingInfo;
use rerun::{EntityPath, StoreKind, TimeCell, TimePoint, ViewCoordinates};

use crate::blueprint::write_blueprint;
use crate::layout::window;
use crate::part::{Out, Part, Shown, Start};
use crate::parts::parts;
use crate::rrd::{Rrd, Store};

/// Timeline of frame numbers.
const FRAME: &str = "frame";
/// Timeline of the time since the first frame.
const TIME: &str = "time";

/// Writes the Rerun recording (.rrd) of a run.
///
/// The file gets its name when the run has ended; a run that fails leaves none.
pub struct Recorder {
    path: PathBuf,
    /// Taken when the file is complete.
    rrd: Option<Rrd<PendingFile>>,
    /// From the beginning of the run.
    run: Option<Run>,
}

/// The state of a recording between frames.
struct Run {
    info: RunInfo,
    seed: u64,
    store: Store,
    parts: Vec<Box<dyn Part>>,
    first_stamp_ns: Option<i64>,
}

impl std::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Recorder {
    /// Opens the recording under its temporary name, `<path>.partial`.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: PathBuf) -> Result<Self> {
        let rrd = Rrd::create(path.clone())?;
        Ok(Self { path, rrd: Some(rrd), run: None })
    }

    /// The stream and the run, which are there between `begin` and `end`.
    fn parts(&mut self) -> Result<(&mut Rrd<PendingFile>, &mut Run)> {
        let rrd = self.rrd.as_mut().context("the recording has already ended")?;
        Ok((rrd, self.run.as_mut().context("the recording has not begun")?))
    }
}

impl Observer for Recorder {
    fn begin(&mut self, info: &RunInfo, config: &Config) -> Result<()> {
        let seed = seed(&self.path, info)?;
        let start = Start { info, config };
        self.run = Some(Run {
            info: info.clone(),
            seed,
            store: Store::new(StoreKind::Recording, seed),
            parts: parts(start),
            first_stamp_ns: None,
        });
        let (rrd, run) = self.parts()?;
        run.begin(rrd)
    }

    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        let (rrd, run) = self.parts()?;
        run.frame(rrd, step)
    }

    fn end(&mut self, result: &RunResult, _: &[MethodMaps<'_>], _: &Truth) -> Result<Vec<SealedFile>> {
        let (rrd, run) = self.parts()?;
        run.end(rrd, result)?;
        let rrd = self.rrd.take().context("the recording has already ended")?;
        Ok(vec![rrd.seal()?])
    }
}

impl Run {
    /// Logs everything that holds at all times.
    fn begin(&mut self, rrd: &mut Rrd<PendingFile>) -> Result<()> {
        let Self { info, store, parts, .. } = self;
        rrd.open(store)?;
        let mut out = Out { rrd, store, at: TimePoint::default() };
        let methods: Vec<_> = info.methods.iter().map(|m| m.name.as_str()).collect();
        let name = format!("{} {}", info.dataset, methods.join(", "));
        out.always(EntityPath::properties(), &RecordingInfo::new().with_name(name))?;
        out.always("world", &ViewCoordinates::FLU())?;
        parts.iter_mut().try_for_each(|part| part.begin(&mut out))?;
        // The layout that a viewer has while it reads the rest; the one at the end knows what was seen.
        self.lay_out(rrd, self.seed, true)
    }

    fn frame(&mut self, rrd: &mut Rrd<PendingFile>, step: &Step<'_>) -> Result<()> {
        let at = self.moment(step);
        let mut out = Out { rrd, store: &mut self.store, at };
        self.parts.iter_mut().try_for_each(|part| part.frame(&mut out, step))
    }

    fn moment(&mut self, step: &Step<'_>) -> TimePoint {
        let stamp_ns = step.frame.stamp_ns();
        let first_ns = *self.first_stamp_ns.get_or_insert(stamp_ns);
        TimePoint::default()
            .with_index(FRAME, TimeCell::from_sequence(step.frame.index() as i64))
            .with_index(TIME, TimeCell::from_duration_nanos(stamp_ns.saturating_sub(first_ns)))
    }

    fn end(&mut self, rrd: &mut Rrd<PendingFile>, result: &RunResult) -> Result<()> {
        let mut out = Out { rrd, store: &mut self.store, at: TimePoint::default() };
        self.parts.iter_mut().try_for_each(|part| part.end(&mut out, result))?;
        let scored =
            LayerKind::ALL.iter().any(|&kind| result.methods.iter().any(|m| m.scores_of(kind).is_some()));
        self.lay_out(rrd, !self.seed, scored)
    }

    fn lay_out(&self, rrd: &mut Rrd<PendingFile>, seed: u64, scored: bool) -> Result<()> {
        let mut blueprint = Store::new(StoreKind::Blueprint, seed);
        let shown = self.shown(scored);
        let panes = self.parts.iter().flat_map(|part| part.panes(&shown)).collect();
        write_blueprint(rrd, &mut blueprint, &window(panes), FRAME)
    }

    fn shown(&self, scored: bool) -> Shown {
        let extents = self.parts.iter().filter_map(|part| part.extent_x());
        let extent_x = extents.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let extent_x = extent_x.unwrap_or((0, self.info.spec.shape()[0] - 1));
        Shown { scored, extent_x }
    }
}

/// Tells recordings apart in a viewer: equal runs into the same file have equal seeds, and nothing else.
fn seed(path: &Path, info: &RunInfo) -> Result<u64> {
    let path = std::path::absolute(path).with_context(|| format!("cannot write {}", path.display()))?;
    let (dataset, frames, settings) = (&info.dataset, &info.frames, &info.settings.toml);
    Ok(stable_hash(&format!("{}\n{dataset}\n{frames:?}\n{settings}", path.display())))
}
