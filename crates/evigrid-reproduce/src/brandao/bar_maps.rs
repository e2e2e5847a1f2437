//! Maps of the world `bars` by several methods.

use anyhow::Result;
use evigrid_eval::{Recording, map_together};
use evigrid_synth::World;

use super::bar_picture::BarViews;
use super::bar_score::BarScore;
use super::bars::{Bars, WORLD, grid_sets};
use super::methods::Reading;
use crate::job::Job;

/// How the world is mapped.
#[derive(Debug, Clone, Copy)]
pub struct BarRun {
    /// Frames, as in `run.frames`.
    pub frames: &'static str,
    /// The bars are 0.04 m wide and 0.2 m apart: cells of 0.05 m tell them from the space between.
    pub cell_size_m: f64,
}

/// Behind the grid's far end, so that no method need draw beyond it, metres.
const DEPTH_M: f64 = 10.0;

/// The paper's 20 frames.
pub const FULL: BarRun = BarRun { frames: "0..20", cell_size_m: 0.05 };

/// One map, scored and drawn.
#[derive(Debug, Clone)]
pub struct BarMap {
    pub reading: Reading,
    pub score: BarScore,
    pub views: BarViews,
}

/// One map for each reading, in one pass over the frames.
pub fn bar_maps(job: &mut Job<'_, '_>, readings: Vec<Reading>, run: BarRun) -> Result<Vec<BarMap>> {
    let bars = Bars::new(run.cell_size_m)?;
    let readings: Vec<Reading> = readings.into_iter().map(|reading| reading.within_depth(DEPTH_M)).collect();
    let base = [grid_sets(run.cell_size_m), vec![format!("run.frames={}", run.frames)]].concat();
    let configs: Result<Vec<_>> = readings.iter().map(|reading| reading.config(&base)).collect();
    let recording = Recording::from(World::builtin(WORLD)?);
    job.say(&format!("{} maps of synth:{WORLD}, frames {}", readings.len(), run.frames));
    let found = map_together(
        &recording,
        configs?,
        job.tools.clock,
        &|mapped| {
            let log_odds = mapped.voxels()?.values();
            Ok((BarScore::new(&bars, log_odds), BarViews::new(&bars, log_odds)))
        },
        &mut || {},
    )?;
    let maps = readings.into_iter().zip(found);
    Ok(maps.map(|(reading, (score, views))| BarMap { reading, score, views }).collect())
}
