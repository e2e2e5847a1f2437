//! Fig. 5: against the ternary grid. A pedestrian stands behind a box; and one wrong match in every column.

use anyhow::{Context, Result};
use evigrid_grid::PlanSpec;
use evigrid_metrics::{FrameCell, PlanTally};
use evigrid_synth::{Track, tracks};
use evigrid_truth::LaserPlan;
use evigrid_udisparity::{
    GroundView, LevelView, Pixels, Smoother, UDisparityGrid, VisibilitySettings, map_to_ground, ternary,
};

use super::exact::{DISPARITIES, PAPER, TOP_M};
use super::panels::{SIZE, image_panel, key, plan_panel, u_panel};
use super::scene::{Grids, Seen};
use crate::chart::Sheet;
use crate::job::Job;
use crate::table::rounded;

const WORLD: &str = "box-and-pedestrian";
const SHOWN: usize = 20;
const FRAMES: usize = 50;
/// The object behind the box, and the box.
const BEHIND: &str = "pedestrian";
/// The wrong match of every column: this disparity in a row that depends on the column.
const WRONG_PX: u16 = 40;

/// Plans of one frame by both methods, from the same pixels.
struct Plans {
    visibility: Vec<f32>,
    ternary: Vec<f32>,
}

impl Plans {
    fn new(pixels: &Pixels, view: &LevelView, ground: &GroundView, spec: &PlanSpec) -> Self {
        let s = VisibilitySettings::default();
        let mut grid = UDisparityGrid::new(view, TOP_M, DISPARITIES, PAPER, false);
        grid.fill(pixels);
        let mut smoother = Smoother::new(s.sigma_u_px, s.sigma_d_px, pixels.width);
        let mut plain = vec![0.5; pixels.width * DISPARITIES];
        ternary(pixels, &PAPER, &mut plain);
        let map = |grid: &[f32]| {
            let mut out = vec![f32::NAN; spec.cell_count()];
            map_to_ground(grid, pixels.width, ground, spec, &mut out);
            out
        };
        Self { visibility: map(smoother.run(grid.total())), ternary: map(&plain) }
    }
}

/// One wrong match in every column that has none at the same place.
fn with_wrong_matches(pixels: &Pixels) -> Pixels {
    let mut wrong = pixels.clone();
    for column in 0..wrong.width {
        // Rows within those that could show the wrong disparity, one after the other.
        let row = wrong.height / 3 + column * 7 % (wrong.height / 3);
        let at = row * wrong.width + column;
        (wrong.obstacles[at], wrong.road[at]) = (WRONG_PX, 0);
    }
    wrong
}

const METHODS: [&str; 2] = ["visibility", "ternary"];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut grids = Grids::new(WORLD, VisibilitySettings::default())?;
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    // For each method as it is, and with wrong matches.
    let mut tallies: [PlanTally; 4] = std::array::from_fn(|_| PlanTally::default());
    job.say(&format!("synth:{WORLD}, {FRAMES} frames"));
    for index in 0..FRAMES {
        grids.add(index, &mut |seen| {
            let (filtered, spec) = Seen::plan(seen.filtered)?;
            let view = seen.plain.level_view().context("no frame")?;
            let ground = GroundView::of(seen.frame.rig(), seen.frame.map_from_left()).context("a camera")?;
            let plans = Plans::new(seen.plain.pixels(), view, &ground, &spec);
            let wrong = Plans::new(&with_wrong_matches(seen.plain.pixels()), view, &ground, &spec);
            if let Some(laser) = seen.laser(spec) {
                let maps = [&plans.visibility, &plans.ternary, &wrong.visibility, &wrong.ternary];
                tallies.iter_mut().zip(maps).for_each(|(tally, map)| tally.add(cells(map, &laser, &ground)));
            }
            let objects = tracks(&seen.drive.world, &seen.drive.map_from_world, index);
            if let Some(behind) = objects.iter().find(|track| track.name.contains(BEHIND)) {
                let maps = [&plans.visibility[..], filtered.probabilities(), &plans.ternary];
                let best = maps.map(|map| rounded(largest(map, &spec, behind).into(), 4));
                rows.push([index.to_string()].into_iter().chain(best).collect::<Vec<_>>());
            }
            if index == SHOWN {
                panels = vec![
                    image_panel("a) left image", seen),
                    u_panel("d) visibility", seen.plain.u_disparity().context("no frame")?, |u, d| {
                        seen.plain.u_disparity().map_or(0.5, |grid| grid.probabilities(u, d).total)
                    }),
                    plan_panel("visibility", &spec, &plans.visibility),
                    plan_panel("c) ternary: highest disparity of each column", &spec, &plans.ternary),
                    plan_panel("visibility, one wrong match per column", &spec, &wrong.visibility),
                    plan_panel("ternary, one wrong match per column", &spec, &wrong.ternary),
                ];
            }
            Ok(())
        })?;
    }
    job.write_table(&["frame", "visibility", "visibility_filtered", "ternary"], rows)?;
    let auc = |method: usize, wrong: usize| rounded(tallies[2 * wrong + method].all().auc(), 4);
    let losses = METHODS.iter().enumerate().map(|(n, name)| vec![(*name).to_owned(), auc(n, 0), auc(n, 1)]);
    job.write_more("wrong-matches", &["method", "auc", "auc_with_wrong_matches"], losses)?;
    let sheet = Sheet {
        title: format!("A pedestrian behind a box, {WORLD}, frame {SHOWN} (Fig. 5)"),
        notes: vec![format!(
            "wrong matches: {WRONG_PX} px in one row of every column; the car looks to the right"
        )],
        columns: 2,
        panel: SIZE,
        panels,
    };
    job.write_keyed_picture(&sheet, &key())
}

/// The cells that the laser knows and the camera looks at.
fn cells<'a>(
    map: &'a [f32],
    laser: &'a LaserPlan,
    ground: &'a GroundView,
) -> impl Iterator<Item = FrameCell> + 'a {
    let spec = laser.spec();
    let known = (0..spec.cell_count()).filter(|&cell| laser.occupied()[cell] || laser.free()[cell]);
    known.filter_map(move |cell| {
        let at = spec.centre_m(cell);
        let [column, _] = ground.image_of(at)?;
        let is_seen = (-0.5..2.0 * ground.centre_x_px + 0.5).contains(&column);
        let range_m = (at[0] - ground.camera_m[0]).hypot(at[1] - ground.camera_m[1]);
        let probability = if map[cell].is_nan() { 0.5 } else { map[cell] };
        let occupied = laser.occupied()[cell];
        is_seen.then_some(FrameCell { probability, occupied, beside_occupied: false, range_m })
    })
}

/// The largest probability of the cells that an object stands on; 0.5 where nothing is known.
fn largest(map: &[f32], spec: &PlanSpec, object: &Track) -> f32 {
    let on =
        super::objects::cells_of(spec, object).map(|cell| if map[cell].is_nan() { 0.5 } else { map[cell] });
    on.fold(f32::NAN, f32::max)
}
