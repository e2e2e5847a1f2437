//! Fig. 5: the grid of one image by ray tracing, as it is, blurred everywhere alike, and
//! blurred more the farther away.

use anyhow::Result;
use evigrid_grid::LogOddsGrid;
use evigrid_inverse_model::{BlurKind, PoseDeviation, blurred};

use super::algorithms::Algorithm;
use super::plan::{PANEL, Plan};
use super::scene::{Scene, grid};
use crate::chart::Sheet;
use crate::job::Job;
use crate::table::rounded;

const CELL_M: f64 = 0.25;
/// Our choice, since the paper gives none: metres and degrees.
const TRANSLATION_M: f64 = 0.2;
const ANGLE_DEG: f64 = 2.0;
/// The level that is shown: above the meadow, metres.
const LEVEL_M: [f64; 2] = [1.5, 1.75];
const KINDS: [(&str, BlurKind); 3] = [
    ("not blurred", BlurKind::None),
    ("constant blur", BlurKind::Constant),
    ("blur that grows with distance (eq. 17)", BlurKind::Distance),
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let scene = Scene::new()?;
    let (drawn, _) = Algorithm::Ray.mapper(grid(CELL_M)?)?.single_image(&scene.view(&scene.exact));
    let maps: Vec<(&str, LogOddsGrid)> =
        KINDS.iter().map(|&(name, kind)| (name, blurred(&drawn, [0.0; 3], &deviation(kind)))).collect();
    let rows = maps.iter().flat_map(|(name, map)| {
        let columns: Vec<[f64; 3]> = Plan::new(map, LEVEL_M).columns().collect();
        columns.into_iter().map(|[x, y, l]| [(*name).to_owned(), x.to_string(), y.to_string(), rounded(l, 4)])
    });
    job.write_table(&["blur", "x_m", "y_m", "log_odds"], rows)?;
    let sums = maps.iter().map(|(name, map)| {
        let over = |limit: f32| map.touched().filter(|(_, l)| *l > limit).count().to_string();
        [(*name).to_owned(), map.touched().count().to_string(), over(0.0), over(0.1)]
    });
    job.write_more("cells", &["blur", "touched_cells", "cells_over_0", "cells_over_0.1"], sums)?;
    job.write_picture(&Sheet {
        title: format!(
            "Fig. 5: one image of posts, boxes and walls by ray tracing, cells of {CELL_M} m, \
             from above"
        ),
        notes: vec![
            format!(
                "black: occupied, white: free, blue: not seen, orange: camera, looking right; cells {} to \
                 {} m above the meadow",
                LEVEL_M[0], LEVEL_M[1]
            ),
            format!("position off by {TRANSLATION_M} m, attitude by {ANGLE_DEG} degrees (our choice)"),
        ],
        columns: maps.len(),
        panel: PANEL,
        panels: maps.iter().map(|(name, map)| Plan::new(map, LEVEL_M).panel((*name).to_owned())).collect(),
    })
}

fn deviation(kind: BlurKind) -> PoseDeviation {
    PoseDeviation { kind, translation_m: TRANSLATION_M, angle: ANGLE_DEG.to_radians() }
}
