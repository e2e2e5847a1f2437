//! Fig. 3: which layer of the pyramid a disparity is drawn from, and how large its pixels are there.

use anyhow::Result;
use evigrid_inverse_model::{ANDERT_RIG as RIG, LayerTable};

use crate::chart::{Axis, BLUE, Corner, GREY, Marks, ORANGE, Panel, Series, Sheet};
use crate::job::Job;

/// The paper's grid, metres.
const CELL_M: f64 = 0.5;
/// Disparities up to this, a hundredth apart, pixels.
const LAST_PX: f64 = 40.0;
const STEPS: u32 = 4000;

/// The quantities of Fig. 3 for one disparity.
struct Sample {
    disparity_px: f64,
    depth_m: f64,
    layer: i32,
    /// Size of an object of one pixel, and of 2^i pixels, metres (eq. 12).
    pixel_m: f64,
    block_m: f64,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let table = LayerTable::new(RIG.baseline_m, CELL_M);
    let samples: Vec<Sample> = (30..=STEPS).map(|n| sample(&table, n)).collect();
    let header = ["disparity_px", "distance_m", "layer", "one_pixel_m", "layer_pixel_m"];
    job.write_table(
        &header,
        samples.iter().map(|s| {
            let [pixel, block] = [s.pixel_m, s.block_m].map(|v| format!("{v:.6}"));
            [s.disparity_px.to_string(), format!("{:.4}", s.depth_m), s.layer.to_string(), pixel, block]
        }),
    )?;
    let edges = (0..7).map(|layer| [layer.to_string(), format!("{:.6}", table.edge_px(layer))]);
    job.write_more("edges", &["layer", "first_disparity_px"], edges)?;
    job.write_picture(&Sheet {
        title: "Fig. 3: near pixels are small, so a smaller image will do".into(),
        notes: vec![
            "b 0.3 m, f 700 px, cells of 0.5 m; layer i is the image halved i times; 8 to 35 px are 26 to 6 \
             m"
            .into(),
        ],
        columns: 1,
        panel: (820, 320),
        panels: vec![sizes(&samples), layers(&samples)],
    })
}

fn sample(table: &LayerTable, n: u32) -> Sample {
    let disparity_px = f64::from(n) * LAST_PX / f64::from(STEPS);
    let (depth_m, layer) = (RIG.depth_m(disparity_px), table.layer(disparity_px));
    let pixel_m = depth_m / RIG.focal_px;
    Sample { disparity_px, depth_m, layer, pixel_m, block_m: pixel_m * f64::from(layer).exp2() }
}

fn sizes(samples: &[Sample]) -> Panel {
    let line = |size: fn(&Sample) -> f64| {
        let shown = samples.iter().filter(|s| size(s) <= 0.7);
        Marks::Line(shown.map(|s| (s.disparity_px, size(s))).collect())
    };
    let cell = |m: f64| Series::new("", GREY, Marks::Line(vec![(0.0, m), (LAST_PX, m)]));
    Panel {
        title: "grey: one cell, and half of one".into(),
        x: Axis::new("disparity (px)", 0.0, LAST_PX),
        y: Axis::new("size of a pixel in space (m)", 0.0, 0.7),
        series: vec![
            cell(CELL_M),
            cell(0.5 * CELL_M),
            Series::new("a pixel of the image itself", ORANGE, line(|s| s.pixel_m)),
            Series::new("a pixel of the layer that is used", BLUE, line(|s| s.block_m)),
        ],
        legend: Some(Corner::UpperRight),
    }
}

fn layers(samples: &[Sample]) -> Panel {
    let points = samples.iter().map(|s| (s.disparity_px, f64::from(s.layer))).collect();
    Panel {
        title: "the layer that is used".into(),
        x: Axis::new("disparity (px)", 0.0, LAST_PX),
        y: Axis::new("layer i", -2.0, 7.0),
        series: vec![Series::new("", BLUE, Marks::Line(points))],
        legend: None,
    }
}
