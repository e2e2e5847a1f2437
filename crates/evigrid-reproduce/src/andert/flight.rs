//! A flight: the maps of one image and of all.

use anyhow::{Context, Result};
use evigrid_core::{Frame, Matching, View};
use evigrid_eval::{Config, Mapped, Recording, map_together};
use evigrid_grid::{GridSpec, LogOddsGrid, Mapper};
use evigrid_inverse_model::{InverseModelMapper, LinePyramid};
use evigrid_metrics::{Counts, VoxelReference, count};
use evigrid_replay::map_from_world;
use evigrid_stereo::BlockMatcher;
use evigrid_synth::World;

use crate::job::Job;
use crate::stopwatch::Stopwatch;

/// The paper's cells, metres, and the thresholds of a single image and of all.
pub const CELL_M: f64 = 0.25;
pub const SINGLE: f32 = 0.1;
pub const FINAL: f32 = 1.0;
/// The frame that is shown, and those that are mapped.
pub const SHOWN: usize = 60;
pub const FRAMES: &str = "0..120";
pub const STRIDE: usize = 2;

/// The last frame of a flight and its maps.
pub struct Flight {
    pub world: &'static str,
    pub frame: Frame,
    pub matching: Matching,
    pub single: LogOddsGrid,
    pub fused: LogOddsGrid,
    /// Of both maps above their thresholds, against the laser of all frames.
    pub counts: [Counts; 2],
    /// Of line-pyramid for the shown image, one thread: median and fastest, milliseconds.
    pub ms: [f64; 2],
    /// The camera in frame 0 above the ground, metres.
    pub camera_m: f64,
}

impl Flight {
    pub fn new(job: &mut Job<'_, '_>, world: &'static str, repetitions: usize) -> Result<Self> {
        let built = World::builtin(world)?;
        let first = built.true_world_from_left(0);
        let recording = Recording::from(built);
        let config = config()?;
        let frame = recording.sequence().frame(SHOWN, &map_from_world(&first))?;
        let matching =
            BlockMatcher::new(config.stereo.block())?.run(frame.left(), frame.right(), false, None)?;
        let settings = config.methods.of::<LinePyramid>()?;
        let mut mapper = InverseModelMapper::line_pyramid(GridSpec::new(&config.grid)?, settings)?;
        let (single, ms) = {
            let view = View::new(&frame, None, &matching);
            let single = mapper.single_image(&view).0;
            (single, time(job, &mut mapper, &view, repetitions)?)
        };
        job.say(&format!("synth:{world}, frames {FRAMES}, every {STRIDE}nd"));
        let look = |mapped: &Mapped<'_>| {
            let (map, reference) = (mapped.voxels()?, mapped.truth.voxels());
            let reference = reference.context("a world without a laser")?;
            let over = |map: &LogOddsGrid, limit| above(map, limit, &reference);
            Ok((map.clone(), [over(&single, SINGLE), over(map, FINAL)]))
        };
        let found = map_together(&recording, vec![config], job.tools.clock, &look, &mut || {})?;
        let (fused, counts) = found.into_iter().next().context("no map")?;
        let camera_m = first.translation.z;
        Ok(Self { world, frame, matching, single, fused, counts, ms, camera_m })
    }
}

/// The paper's method in a grid along the way.
fn config() -> Result<Config> {
    let sets = [
        "grid.x_m=[0, 60]".to_owned(),
        "grid.y_m=[-15, 15]".to_owned(),
        "grid.z_m=[-7, 6]".to_owned(),
        format!("grid.cell_size_m={CELL_M}"),
        format!("run.frames={FRAMES}"),
        format!("run.stride={STRIDE}"),
    ];
    let mut config = Config::load(None, &sets)?;
    config.run.methods = vec!["line-pyramid".to_owned()];
    Ok(config)
}

fn time(
    job: &Job<'_, '_>,
    mapper: &mut InverseModelMapper,
    view: &View<'_>,
    repetitions: usize,
) -> Result<[f64; 2]> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let watch = Stopwatch { clock: job.tools.clock, repetitions };
    let seconds = watch.time(|| Ok(pool.install(|| mapper.integrate(view))?))?;
    Ok(seconds.map(|s| 1e3 * s))
}

/// Scores of the cells above a threshold.
fn above(map: &LogOddsGrid, threshold: f32, reference: &VoxelReference<'_>) -> Counts {
    let shifted: Vec<f32> = map.values().iter().map(|l| l - threshold).collect();
    count(&shifted, reference)
}
