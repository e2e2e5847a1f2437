//! Grids and images in a picture.

use evigrid_grid::PlanSpec;
use evigrid_truth::LaserPlan;
use evigrid_udisparity::{LevelView, Rows, UDisparityGrid};
use plotters::prelude::RGBColor;

use super::exact::TOP_M;
use super::scene::Seen;
use crate::cells::{Patches, blend};
use crate::chart::{Axis, Key, Marks, Panel, Series};
use crate::image_view::{PANEL, SHRINK, grey_panel};

pub const SIZE: (u32, u32) = PANEL;
const WHITE: RGBColor = RGBColor(255, 255, 255);
const BLACK: RGBColor = RGBColor(0, 0, 0);
/// Nothing is known.
const UNKNOWN: RGBColor = RGBColor(150, 170, 215);
const BLUE: RGBColor = RGBColor(0, 114, 178);
const RED: RGBColor = RGBColor(213, 60, 0);
/// Columns of the image per column of a u-disparity panel.
const STEP: usize = 4;
/// P below this is free, above that occupied, where they are drawn into the image (Fig. 6).
pub const FREE: f64 = 0.4;
pub const OCCUPIED: f64 = 0.75;

/// What the shades of grids mean.
pub fn key() -> Vec<Key> {
    let shade = |p: f64| blend(WHITE, BLACK, p);
    let shades = [(0.0, "free (P = 0)"), (0.5, "P = 0.5"), (1.0, "occupied (P = 1)")];
    let grids = shades.map(|(p, text)| (text.to_owned(), shade(p)));
    grids.into_iter().chain([("nothing known".to_owned(), UNKNOWN)]).collect()
}

/// Values from 0 to 1 over columns and disparities.
pub fn u_panel(title: &str, grid: &UDisparityGrid, value: impl Fn(usize, usize) -> f64) -> Panel {
    let shape = [grid.columns() / STEP, grid.disparities()];
    let patches = Patches { shape, origin_m: [0.0, 0.5], edge_m: 1.0 };
    let series = patches.shaded(|i, j| Some(value(i * STEP, j + 1)), |v| blend(WHITE, BLACK, v));
    Panel {
        title: title.into(),
        x: Axis::new(&format!("column of the image / {STEP}"), 0.0, shape[0] as f64),
        y: Axis::new("disparity (px)", 0.5, shape[1] as f64 + 0.5),
        series,
        legend: None,
    }
}

/// A plan in the map; NaN: nothing known.
pub fn plan_panel(title: &str, spec: &PlanSpec, probabilities: &[f32]) -> Panel {
    let (patches, ny) = (patches(spec), spec.shape()[1]);
    let value = |i: usize, j: usize| probabilities[i * ny + j];
    let known = |i, j| Some(f64::from(value(i, j))).filter(|p| !p.is_nan());
    let mut series = vec![Series::new("", UNKNOWN, Marks::Areas(patches.areas(|i, j| value(i, j).is_nan())))];
    series.extend(patches.shaded(known, |p| blend(WHITE, BLACK, p)));
    over_plan(title, spec, series)
}

/// What the laser says of a plan.
pub fn laser_panel(title: &str, plan: &LaserPlan) -> Panel {
    let (spec, ny) = (plan.spec(), plan.spec().shape()[1]);
    let patches = patches(spec);
    let occupied = patches.areas(|i, j| plan.occupied()[i * ny + j]);
    let unknown = patches.areas(|i, j| !plan.occupied()[i * ny + j] && !plan.free()[i * ny + j]);
    let series =
        vec![Series::new("", UNKNOWN, Marks::Areas(unknown)), Series::new("", BLACK, Marks::Areas(occupied))];
    over_plan(title, spec, series)
}

fn patches(spec: &PlanSpec) -> Patches {
    Patches { shape: spec.shape(), origin_m: spec.origin_m(), edge_m: spec.cell_size_m() }
}

fn over_plan(title: &str, spec: &PlanSpec, series: Vec<Series>) -> Panel {
    let ([x, y], [nx, ny], c) = (spec.origin_m(), spec.shape(), spec.cell_size_m());
    Panel {
        title: title.into(),
        x: Axis::new("metres ahead of the start", x, x + nx as f64 * c),
        y: Axis::new("metres to its left", y, y + ny as f64 * c),
        series,
        legend: None,
    }
}

/// The left image.
pub fn image_panel(title: &str, seen: &Seen<'_>) -> Panel {
    let left = seen.frame.left();
    grey_panel(title, [left.width(), left.height()], |x, y| left.row(y)[x])
}

/// The left image with what the grid says: blue where the road is free, red columns of the largest height where
/// something stands (Fig. 6). For a level camera.
pub fn labelled_panel(title: &str, seen: &Seen<'_>, view: &LevelView, grid: &UDisparityGrid) -> Panel {
    let mut panel = image_panel(title, seen);
    let (width, height) = (seen.frame.left().width(), seen.frame.left().height());
    let shape = [width / SHRINK, height / SHRINK];
    let patches = Patches { shape, origin_m: [0.0; 2], edge_m: SHRINK as f64 };
    let rows = Rows::new(view, TOP_M, grid.disparities());
    let p = |u: usize, d: usize| f64::from(grid.total()[(d - 1) * grid.columns() + u]);
    let at = |i: usize, j: usize| (i * SHRINK + SHRINK / 2, (shape[1] - 1 - j) * SHRINK + SHRINK / 2);
    let is_red = |i: usize, j: usize| {
        let (u, v) = at(i, j);
        (1..=grid.disparities()).any(|d| p(u, d) > OCCUPIED && rows.of(d).contains(&v))
    };
    let is_blue = |i: usize, j: usize| {
        let (u, v) = at(i, j);
        let ground = (v as f64 - view.rig.centre_y_px) * view.rig.baseline_m / view.height_m;
        let d = ground.round();
        d >= 1.0 && d <= grid.disparities() as f64 && p(u, d as usize) < FREE && !is_red(i, j)
    };
    // Every second cell, so that the image shines through.
    let is_even = |i: usize, j: usize| (i + j).is_multiple_of(2);
    panel.series.push(Series::new(
        "",
        BLUE,
        Marks::Areas(patches.areas(|i, j| is_even(i, j) && is_blue(i, j))),
    ));
    panel.series.push(Series::new(
        "",
        RED,
        Marks::Areas(patches.areas(|i, j| is_even(i, j) && is_red(i, j))),
    ));
    panel
}
