//! Section 6.3: milliseconds of each stage of a frame, on all cores.

use anyhow::{Context, Result};
use evigrid_core::{GroundPlane, MatchFilter, MatchLimits};
use evigrid_grid::{GridSpec, Method, Needs};
use evigrid_stereo::{Extras, GroundSource, Matcher, PairTask};
use evigrid_udisparity::{
    Filter, GroundView, LevelView, Pixels, Smoother, UDisparityGrid, VisibilityFiltered,
    VisibilityFilteredSettings, map_to_ground,
};

use super::exact::{DISPARITIES, PAPER, TOP_M};
use super::scene::config;
use crate::job::Job;
use crate::murarka::mapping::Drive;
use crate::stopwatch::Stopwatch;
use crate::table::rounded;

const WORLD: &str = "crossing";
const FRAME: usize = 40;
const REPETITIONS: usize = 31;
/// Milliseconds that the paper's graphics processor takes; its processor: about 150 for the whole chain.
const PAPER_MS: [Option<f64>; 5] = [Some(6.0), Some(0.1), None, Some(0.1), None];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let drive = Drive::new(WORLD)?;
    let frame = drive.frame(FRAME)?;
    let (config, settings) = (config(GroundSource::Mounting), VisibilityFilteredSettings::default().0);
    let ground = GroundPlane::below(&drive.mounting).disparities(frame.rig());
    let watch = Stopwatch { clock: job.tools.clock, repetitions: REPETITIONS };
    let mut matcher = Matcher::new(config.stereo)?;
    let wanted =
        Extras { costs: false, road: <VisibilityFiltered as Method>::NEEDS.and(Needs::NOTHING).road };
    let mut kept = None;
    let matching = watch.time(|| {
        let task = PairTask::new(frame.left(), frame.right(), wanted);
        kept = Some(matcher.run(PairTask { ground: Some(ground), recycled: kept.take(), ..task })?);
        Ok(())
    })?;
    let matched = kept.context("no match")?;
    let split = matched.road.as_ref().context("no road")?;
    let view = LevelView::new(frame.rig(), &ground)?;
    let filter = MatchFilter::new(&matched.matches, &MatchLimits::left_right(Some(1)));
    let (mut pixels, parts) = (Pixels::default(), [&split.obstacles, &split.road]);
    let mut grid = UDisparityGrid::new(&view, TOP_M, DISPARITIES, PAPER, false);
    view.fill(&filter, parts, &split.tried, &mut pixels);
    let of_grid = watch.time(|| {
        grid.fill(&pixels);
        Ok(())
    })?;
    let mut smoother = Smoother::new(settings.sigma_u_px, settings.sigma_d_px, grid.columns());
    let smoothing = watch.time(|| {
        smoother.run(grid.total());
        Ok(())
    })?;
    let smooth = smoother.run(grid.total()).to_vec();
    let spec = GridSpec::new(&config.grid)?.plan();
    let place = GroundView::of(frame.rig(), frame.map_from_left()).context("a camera")?;
    let mut plan = vec![0.0; spec.cell_count()];
    let mapping = watch.time(|| {
        map_to_ground(&smooth, grid.columns(), &place, &spec, &mut plan);
        Ok(())
    })?;
    let mut over_time = Filter::new(settings.filter_settings(), spec.shape(), spec.cell_size_m());
    let mut stamp_ns = 0;
    let filtering = watch.time(|| {
        stamp_ns += 80_000_000;
        Ok(over_time.step(stamp_ns, [0, 0], &plan)?)
    })?;
    let names = ["double correlation", "u-disparity grid", "Gaussian", "mapping to the ground", "filter"];
    let times = [matching, of_grid, smoothing, mapping, filtering];
    let rows = names.into_iter().zip(times).zip(PAPER_MS).map(|((name, [median, fastest]), paper)| {
        let [median, fastest] = [median, fastest].map(|s| rounded(1e3 * s, 3));
        let paper = paper.map_or(String::new(), |ms| rounded(ms, 1));
        vec![name.to_owned(), median, fastest, paper]
    });
    job.write_table(&["stage", "median_ms", "fastest_ms", "paper_ms"], rows.collect::<Vec<_>>())
}
