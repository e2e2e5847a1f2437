//! Fig. 2: one frame through the u-disparity plane.

use anyhow::{Context, Result};
use evigrid_udisparity::{UDisparityGrid, VisibilitySettings};

use super::panels::{SIZE, image_panel, key, u_panel};
use super::scene::{Grids, Seen};
use crate::chart::Sheet;
use crate::job::Job;
use crate::table::rounded;

const WORLD: &str = "crossing";
const FRAME: usize = 40;
/// Pixels of a cell that are drawn black.
const MANY: f64 = 40.0;

const HEADER: [&str; 9] = [
    "u",
    "d",
    "obstacle_pixels",
    "road_cells_of_9",
    "p_visible",
    "p_confidence",
    "p_road",
    "p_obstacle",
    "p_total",
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut grids = Grids::new(WORLD, VisibilitySettings::default())?;
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    grids.add(FRAME, &mut |seen| {
        let grid = seen.plain.u_disparity().context("no frame")?;
        rows = table(grid);
        panels = panels_of(seen, grid);
        Ok(())
    })?;
    job.write_table(&HEADER, rows)?;
    let sheet = Sheet {
        title: format!("From pixels to occupancy in the u-disparity plane, {WORLD}, frame {FRAME} (Fig. 2)"),
        notes: vec![
            "matched by double correlation; the grid before its Gaussian; nearer is higher up".into(),
        ],
        columns: 3,
        panel: SIZE,
        panels,
    };
    job.write_keyed_picture(&sheet, &key())
}

fn table(grid: &UDisparityGrid) -> Vec<Vec<String>> {
    let cells = (0..grid.columns()).flat_map(|u| (1..=grid.disparities()).map(move |d| (u, d)));
    let row = |(u, d): (usize, usize)| {
        let (counts, p) = (grid.counts(u, d), grid.probabilities(u, d));
        let whole = [u, d, counts.observed.into(), counts.road.into()].map(|n: usize| n.to_string());
        let shares = [p.visible, p.confidence, p.road, p.obstacle, p.total].map(|p| rounded(p, 6));
        whole.into_iter().chain(shares).collect()
    };
    cells.map(row).collect()
}

fn panels_of(seen: &Seen<'_>, grid: &UDisparityGrid) -> Vec<crate::chart::Panel> {
    let counts = |u, d| grid.counts(u, d);
    let p = |u, d| grid.probabilities(u, d);
    vec![
        image_panel("a) left image", seen),
        u_panel("b) obstacle pixels (black: 40 and more)", grid, |u, d| {
            f64::from(counts(u, d).observed) / MANY
        }),
        u_panel("c) road pixels: cells of the 9 around", grid, |u, d| f64::from(counts(u, d).road) / 9.0),
        u_panel("d) visible (black)", grid, |u, d| p(u, d).visible),
        u_panel("e) confidence that an obstacle is seen", grid, |u, d| p(u, d).confidence),
        u_panel("f) confidence that only road is seen", grid, |u, d| p(u, d).road),
        u_panel("g) occupancy P(T)", grid, |u, d| p(u, d).total),
    ]
}
