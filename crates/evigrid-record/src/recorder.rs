use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use evigrid_eval::{Observer, PendingFile, RunInfo, RunResult, SealedFile, Step, markdown_summary};
use evigrid_grid::{GridSpec, LogOddsGrid};
use evigrid_truth::LaserTruth;
use rerun::archetypes::RecordingInfo;
use rerun::components::MediaType;
use rerun::{EntityPath, StoreKind, TextDocument, TimeCell, TimePoint, ViewCoordinates};

use crate::blueprint::write_blueprint;
use crate::camera::CameraWriter;
use crate::classes::Laser;
use crate::curve_plot::write_curves;
use crate::disparity_image::DisparityWriter;
use crate::layout::{SUMMARY, Shown, window};
use crate::map::MapWriter;
use crate::rrd::{Rrd, Store};
use crate::trajectory::TrajectoryWriter;
use crate::{laser, series};

/// Timeline of frame numbers.
const FRAME: &str = "frame";
/// Timeline of the time since the first frame.
const TIME: &str = "time";

/// Writes the Rerun recording (.rrd) of a run.
///
/// The file gets its name when the run has ended; a run that fails leaves none.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    /// Taken when the file is complete.
    rrd: Option<Rrd<PendingFile>>,
    /// From the beginning of the run.
    run: Option<Run>,
}

/// What is kept between frames.
#[derive(Debug)]
struct Run {
    info: RunInfo,
    seed: u64,
    store: Store,
    camera: CameraWriter,
    trajectory: TrajectoryWriter,
    disparity: DisparityWriter,
    maps: Vec<MapWriter>,
    first_stamp_ns: Option<i64>,
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
    fn begin(&mut self, info: &RunInfo) -> Result<()> {
        let seed = seed(&self.path, info)?;
        self.run = Some(Run::new(info, seed));
        let (rrd, run) = self.parts()?;
        run.begin(rrd)
    }

    fn frame(&mut self, step: &Step<'_>) -> Result<()> {
        let (rrd, run) = self.parts()?;
        run.frame(rrd, step)
    }

    fn end(
        &mut self,
        result: &RunResult,
        _maps: &[&LogOddsGrid],
        _truth: Option<&LaserTruth>,
    ) -> Result<Vec<SealedFile>> {
        let (rrd, run) = self.parts()?;
        run.end(rrd, result)?;
        let rrd = self.rrd.take().context("the recording has already ended")?;
        Ok(vec![rrd.seal()?])
    }
}

impl Run {
    fn new(info: &RunInfo, seed: u64) -> Self {
        let stereo = &info.config.stereo;
        Self {
            info: info.clone(),
            seed,
            store: Store::new(StoreKind::Recording, seed),
            camera: CameraWriter::default(),
            trajectory: TrajectoryWriter::default(),
            disparity: DisparityWriter::new((stereo.min_disparity + stereo.disparities) as f32),
            maps: info.methods.iter().map(|_| MapWriter::new(info.spec)).collect(),
            first_stamp_ns: None,
        }
    }

    /// What holds at all times.
    fn begin(&mut self, rrd: &mut Rrd<PendingFile>) -> Result<()> {
        let always = TimePoint::default();
        let store = &mut self.store;
        rrd.open(store)?;
        let name = format!("{} {}", self.info.dataset, self.info.methods.join(", "));
        rrd.log(store, EntityPath::properties(), &always, &RecordingInfo::new().with_name(name))?;
        rrd.log(store, "world", &always, &ViewCoordinates::FLU())?;
        laser::begin(rrd, store)?;
        self.disparity.begin(rrd, store)?;
        for (i, (map, method)) in self.maps.iter().zip(&self.info.methods).enumerate() {
            map.begin(rrd, store, method)?;
            let label = if self.info.methods.len() == 1 { "" } else { method.as_str() };
            series::begin(rrd, store, method, label, 0.7_f32.powi(i as i32))?;
        }
        // What a viewer shows while it reads the rest; the layout at the end knows what was seen.
        self.lay_out(rrd, self.seed, true)
    }

    fn frame(&mut self, rrd: &mut Rrd<PendingFile>, step: &Step<'_>) -> Result<()> {
        let at = self.moment(step);
        let store = &mut self.store;
        self.camera.frame(rrd, store, &at, step.frame)?;
        self.trajectory.frame(rrd, store, &at, step.frame.map_from_left())?;
        laser::write_scan(rrd, store, &at, step.frame.laser())?;
        self.disparity.frame(rrd, store, &at, step.matches)?;
        let laser = step.truth.map(|t| Laser { occupied: t.occupied(), observed: t.observed() });
        for (map, m) in self.maps.iter_mut().zip(step.methods) {
            map.frame(rrd, store, &at, (m.method, m.map), laser)?;
            if let Some(scores) = m.scores {
                series::frame(rrd, store, &at, m.method, scores)?;
            }
        }
        Ok(())
    }

    fn moment(&mut self, step: &Step<'_>) -> TimePoint {
        let stamp_ns = step.frame.stamp_ns();
        let first_ns = *self.first_stamp_ns.get_or_insert(stamp_ns);
        TimePoint::default()
            .with_index(FRAME, TimeCell::from_sequence(step.frame.index() as i64))
            .with_index(TIME, TimeCell::from_duration_nanos(stamp_ns.saturating_sub(first_ns)))
    }

    fn end(&mut self, rrd: &mut Rrd<PendingFile>, result: &RunResult) -> Result<()> {
        let curves: Vec<_> =
            result.methods.iter().filter_map(|m| Some((m.method.as_str(), m.curve.as_ref()?))).collect();
        write_curves(rrd, &mut self.store, &curves)?;
        let text = markdown_summary(&self.info, result);
        let summary = TextDocument::new(text).with_media_type(MediaType::MARKDOWN);
        rrd.log(&mut self.store, SUMMARY, &TimePoint::default(), &summary)?;
        self.lay_out(rrd, !self.seed, !curves.is_empty())
    }

    fn lay_out(&self, rrd: &mut Rrd<PendingFile>, seed: u64, scored: bool) -> Result<()> {
        let mut blueprint = Store::new(StoreKind::Blueprint, seed);
        write_blueprint(rrd, &mut blueprint, &window(&self.shown(scored)), FRAME)
    }

    fn shown(&self, scored: bool) -> Shown<'_> {
        let spec: &GridSpec = &self.info.spec;
        let [nx, ny, _] = spec.shape();
        let extents = self.maps.iter().filter_map(MapWriter::extent_x);
        let extent_x = extents.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0, nx - 1));
        let [x0, y0, _] = spec.origin_m();
        let metres = |cells: usize| cells as f64 * spec.cell_size_m();
        let x_m = [x0 + metres(extent_x.0), x0 + metres(extent_x.1 + 1)].map(|v| v as f32);
        let y_m = (y0 + metres(ny) / 2.0) as f32;
        Shown { methods: &self.info.methods, scored, extent_x, cells_y: ny, extent_m: (x_m, y_m, 0.0) }
    }
}

/// Tells recordings apart in a viewer: equal runs into the same file have equal seeds, and nothing else.
fn seed(path: &Path, info: &RunInfo) -> Result<u64> {
    let path = std::path::absolute(path).with_context(|| format!("cannot write {}", path.display()))?;
    let settings = info.config.to_toml()?;
    let text = format!("{}\n{}\n{:?}\n{settings}", path.display(), info.dataset, info.frames);
    // FNV-1a.
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    Ok(text.bytes().fold(0xcbf2_9ce4_8422_2325, step))
}
