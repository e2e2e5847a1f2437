//! Figs 3, 6 and 8: plans before and after the filter, what the grid says in the image, and the lasers' plans.

use anyhow::{Context, Result};
use evigrid_udisparity::VisibilitySettings;

use super::panels::{SIZE, key, labelled_panel, laser_panel, plan_panel, u_panel};
use super::scene::{Grids, Seen};
use crate::chart::{Panel, Sheet};
use crate::job::Job;
use crate::table::rounded;

/// Worlds and frames that are shown.
const SCENES: [(&str, usize); 3] = [("crossing", 60), ("box-and-pedestrian", 40), ("parked-row", 50)];

const HEADER: [&str; 7] = ["world", "frame", "x_m", "y_m", "p_plain", "p_filtered", "laser"];

/// Fig. 3: before and after the filter.
pub fn make_3(job: &mut Job<'_, '_>) -> Result<()> {
    let title = "The Bayesian occupancy filter over time (Fig. 3)";
    make(job, title, &SCENES[..1], &|seen, shown| {
        let name = |what: &str| format!("{what}, after frame {}", seen.frame.index());
        Ok(vec![
            plan_panel(&name("one frame"), &shown.spec, &shown.plain),
            plan_panel(&name("filtered"), &shown.spec, &shown.filtered),
        ])
    })
}

/// Fig. 6: the image with what the grid says, the grid, the filtered plan.
pub fn make_6(job: &mut Job<'_, '_>) -> Result<()> {
    let title = "Scenes: blue where P < 0.4 on the road, red where P > 0.75, 1.8 m high (Fig. 6)";
    make(job, title, &SCENES, &|seen, shown| {
        let grid = seen.plain.u_disparity().context("no frame")?;
        let view = seen.plain.level_view().context("no frame")?;
        Ok(vec![
            labelled_panel(shown.world, seen, view, grid),
            u_panel("u-disparity grid", grid, |u, d| f64::from(grid.total()[(d - 1) * grid.columns() + u])),
            plan_panel("plan, filtered", &shown.spec, &shown.filtered),
        ])
    })
}

/// Fig. 8: stereo beside the lasers.
pub fn make_8(job: &mut Job<'_, '_>) -> Result<()> {
    let title = "Stereo beside laser scanners (Fig. 8)";
    make(job, title, &SCENES, &|_, shown| {
        let mut panels = vec![
            plan_panel(&format!("{}: stereo, one frame", shown.world), &shown.spec, &shown.plain),
            plan_panel("stereo, filtered", &shown.spec, &shown.filtered),
        ];
        panels.extend(shown.laser.as_ref().map(|plan| laser_panel("lasers", plan)));
        Ok(panels)
    })
}

/// A frame that is shown.
struct Shown {
    world: &'static str,
    spec: evigrid_grid::PlanSpec,
    plain: Vec<f32>,
    filtered: Vec<f32>,
    laser: Option<evigrid_truth::LaserPlan>,
}

impl Shown {
    fn new(world: &'static str, seen: &Seen<'_>) -> Result<Self> {
        let (plain, spec) = Seen::plan(seen.plain)?;
        let (filtered, _) = Seen::plan(seen.filtered)?;
        let [plain, filtered] = [plain, filtered].map(|plan| plan.probabilities().to_vec());
        Ok(Self { world, spec, plain, filtered, laser: seen.laser(spec) })
    }

    fn rows(&self, frame: usize) -> impl Iterator<Item = Vec<String>> {
        (0..self.spec.cell_count()).map(move |cell| {
            let [x, y] = self.spec.centre_m(cell).map(|m| rounded(m, 2));
            let laser =
                self.laser.as_ref().map_or("", |plan| match (plan.occupied()[cell], plan.free()[cell]) {
                    (true, _) => "occupied",
                    (false, true) => "free",
                    (false, false) => "",
                });
            let p = [self.plain[cell], self.filtered[cell]].map(|p| rounded(p.into(), 4));
            let names = [self.world.to_owned(), frame.to_string(), x, y];
            names.into_iter().chain(p).chain([laser.to_owned()]).collect()
        })
    }
}

type Show = dyn Fn(&Seen<'_>, &Shown) -> Result<Vec<Panel>>;

fn make(job: &mut Job<'_, '_>, title: &str, scenes: &[(&'static str, usize)], show: &Show) -> Result<()> {
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    let mut columns = 0;
    for &(world, last) in scenes {
        job.say(&format!("synth:{world}, {} frames", last + 1));
        let mut grids = Grids::new(world, VisibilitySettings::default())?;
        for frame in 0..=last {
            grids.add(frame, &mut |seen| {
                if frame == last {
                    let shown = Shown::new(world, seen)?;
                    rows.extend(shown.rows(frame));
                    let new = show(seen, &shown)?;
                    columns = new.len();
                    panels.extend(new);
                }
                Ok(())
            })?;
        }
    }
    job.write_table(&HEADER, rows)?;
    let notes = vec!["double correlation; 20 m x 20 m in cells of 0.2 m; the car looks to the right".into()];
    let sheet = Sheet { title: title.into(), notes, columns, panel: SIZE, panels };
    job.write_keyed_picture(&sheet, &key())
}
