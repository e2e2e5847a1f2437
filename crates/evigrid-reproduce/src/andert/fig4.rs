//! Fig. 4: how large the blurring kernels are, by the place of the cell.

use anyhow::Result;
use evigrid_inverse_model::{BlurKind, PoseDeviation};
use plotters::prelude::RGBColor;

use crate::cells::{Patches, blend};
use crate::chart::{Axis, COLOURS, Corner, Marks, ORANGE, Panel, Series, Sheet};
use crate::job::Job;

/// Our choice, since the paper gives none: metres, degrees, and the grid that is shown.
const TRANSLATION_M: f64 = 0.2;
const ANGLE_DEG: f64 = 2.0;
const CELL_M: f64 = 0.25;
const HALF_M: f64 = 25.0;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let deviation = PoseDeviation {
        kind: BlurKind::Distance,
        translation_m: TRANSLATION_M,
        angle: ANGLE_DEG.to_radians(),
    };
    let count = (2.0 * HALF_M / CELL_M) as usize;
    let centre = |i: usize| -HALF_M + (i as f64 + 0.5) * CELL_M;
    let sigma = |i: usize, j: usize| deviation.cells(centre(i).hypot(centre(j)), CELL_M);
    let rows = (0..count * count).map(|n| {
        let (i, j) = (n / count, n % count);
        let (distance_m, cells) = (centre(i).hypot(centre(j)), sigma(i, j));
        let sigma_m = TRANSLATION_M.hypot(distance_m * ANGLE_DEG.to_radians());
        [
            centre(i).to_string(),
            centre(j).to_string(),
            format!("{distance_m:.4}"),
            format!("{sigma_m:.4}"),
            cells.to_string(),
            (6 * cells + 1).to_string(),
        ]
    });
    let header = ["x_m", "y_m", "distance_m", "sigma_m", "sigma_cells", "kernel_cells"];
    job.write_table(&header, rows)?;
    let patches = Patches { shape: [count; 2], origin_m: [-HALF_M; 2], edge_m: CELL_M };
    let most = deviation.cells(HALF_M.hypot(HALF_M), CELL_M);
    let rings = (0..=most).map(|size| (size, patches.areas(|i, j| sigma(i, j) == size)));
    let mut series: Vec<Series> = rings
        .filter(|(_, areas)| !areas.is_empty())
        .map(|(size, areas)| Series::new(name(size), shade(size, most), Marks::Areas(areas)))
        .collect();
    series.push(Series::new("the vehicle", ORANGE, Marks::Dots(vec![(0.0, 0.0)], 6)));
    job.write_picture(&Sheet {
        title: "Fig. 4: cells far from the vehicle are blurred more".into(),
        notes: vec![format!(
            "position off by {TRANSLATION_M} m, attitude by {ANGLE_DEG} degrees (our choice), cells of \
             {CELL_M} m (eq. 17)"
        )],
        columns: 1,
        panel: (640, 600),
        panels: vec![Panel {
            title: "size of the kernel around each cell, cells".into(),
            x: Axis::new("metres", -HALF_M, HALF_M),
            y: Axis::new("metres", -HALF_M, HALF_M),
            series,
            legend: Some(Corner::UpperRight),
        }],
    })
}

fn name(size: u32) -> String {
    let kernel = 6 * size + 1;
    format!("{kernel}")
}

fn shade(size: u32, most: u32) -> RGBColor {
    blend(RGBColor(240, 246, 250), COLOURS[0], f64::from(size) / f64::from(most.max(1)))
}
