//! Fig. 1: the occupancy profile of Elfes' inverse sensor model.

use anyhow::Result;
use evigrid_cost_curve::occupancy;

use crate::chart::{Axis, BLUE, GREY, Marks, Panel, Series, Sheet};
use crate::job::Job;

/// The measurement, its variance, and the cells of the ray.
const MEASURED: f64 = 20.0;
const VARIANCE: f64 = 5.0;
const CELLS: u32 = 40;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let profile = profile();
    job.write_table(&["cell", "p"], profile.iter().map(|(cell, p)| [cell.to_string(), format!("{p:.9}")]))?;
    let line: Vec<(f64, f64)> = profile.iter().map(|&(cell, p)| (f64::from(cell), p)).collect();
    let half = vec![(0.0, 0.5), (f64::from(CELLS), 0.5)];
    let panel = Panel {
        x: Axis::new("cell along the ray, from the sensor", 0.0, f64::from(CELLS)),
        y: Axis::new("P(occupied | measurement)", 0.0, 0.6),
        series: vec![
            Series::new("", GREY, Marks::Line(half)),
            Series::new("", BLUE, Marks::Line(line.clone())),
            Series::new("", BLUE, Marks::Dots(line, 3)),
        ],
        ..Panel::default()
    };
    job.write_picture(&Sheet {
        title: "Fig. 1: Elfes' occupancy profile, measured cell 20, variance 5 cells\u{b2}".into(),
        notes: vec!["free in front of the measurement, unknown (0.5, grey) behind it".into()],
        columns: 1,
        panel: (760, 420),
        panels: vec![panel],
    })
}

/// Cells from 1 on with P (eqs 1 to 3).
fn profile() -> Vec<(u32, f64)> {
    let likelihood: Vec<f64> =
        (1..=CELLS).map(|j| (-(f64::from(j) - MEASURED).powi(2) / (2.0 * VARIANCE)).exp()).collect();
    (1..).zip(occupancy(&likelihood)).collect()
}
