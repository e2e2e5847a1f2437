//! Fig. 7: two flights: an image, its disparities, the map of it, and the map of the whole flight.

use anyhow::Result;
use evigrid_core::{Disparity, MatchFilter};
use evigrid_grid::LogOddsGrid;
use evigrid_metrics::Counts;
use plotters::prelude::RGBColor;

use super::flight::{CELL_M, FINAL, FRAMES, Flight, SHOWN, SINGLE, STRIDE};
use super::timed::BELIEVED;
use crate::cells::{Patches, blend};
use crate::chart::{Axis, Panel, Sheet};
use crate::image_view::{PANEL, disparity_panel, grey_panel};
use crate::job::Job;
use crate::table::rounded;

/// The worlds, and what the paper says of the time for an image, milliseconds.
const FLIGHTS: [(&str, &str); 2] =
    [("andert-flight-posts", "10 to 15"), ("andert-flight-houses", "20 to 25")];
const REPETITIONS: usize = 9;
/// Heights above the ground, metres: cells below the first are not shown, cells at the second are red.
const FOOT_M: f64 = 0.6;
const HIGH_M: f64 = 8.0;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut flights = Vec::new();
    for (world, paper) in FLIGHTS {
        flights.push((Flight::new(job, world, REPETITIONS)?, paper));
    }
    let header = [
        "world",
        "map",
        "log_odds_threshold",
        "valid_pixels",
        "occupied_cells",
        "hits",
        "mistakes",
        "missed",
        "precision",
        "f1",
        "line_pyramid_median_ms",
        "line_pyramid_fastest_ms",
        "paper_ms_pentium_4_mobile",
    ];
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    for (flight, paper) in &flights {
        rows.extend(flight.rows(paper)?);
        panels.extend(flight.panels()?);
    }
    job.write_table(&header, rows)?;
    job.write_picture(&Sheet {
        title: format!("Fig. 7: two flights mapped by pyramidal lines, cells of {CELL_M} m"),
        notes: vec![
            format!(
                "maps from above, coloured by height: blue near the ground, red from {HIGH_M} m on; the \
                 lowest {FOOT_M} m are left out"
            ),
            format!("frame {SHOWN}, and frames {FRAMES}, every {STRIDE}nd, with exact poses"),
        ],
        columns: 4,
        panel: PANEL,
        panels,
    })
}

impl Flight {
    fn rows(&self, paper: &str) -> Result<[[String; 13]; 2]> {
        let valid = self.believed()?.valid_count();
        let name = ["one image".to_owned(), format!("frames {FRAMES}, every {STRIDE}nd")];
        let row = |n: usize, threshold: f32, map: &LogOddsGrid| {
            let counts: &Counts = &self.counts[n];
            [
                self.world.to_owned(),
                name[n].clone(),
                threshold.to_string(),
                valid.to_string(),
                map.touched().filter(|(_, l)| *l > threshold).count().to_string(),
                counts.hits.to_string(),
                counts.mistakes.to_string(),
                counts.missed().to_string(),
                rounded(counts.precision(), 4),
                rounded(counts.f1(), 4),
                rounded(self.ms[0], 3),
                rounded(self.ms[1], 3),
                paper.to_owned(),
            ]
        };
        Ok([row(0, SINGLE, &self.single), row(1, FINAL, &self.fused)])
    }

    /// The disparities that the method believes; NaN for the others.
    fn believed(&self) -> Result<Disparity> {
        Ok(MatchFilter::new(&self.matching.matches, &BELIEVED).disparity()?)
    }

    fn panels(&self) -> Result<[Panel; 4]> {
        let rig = self.frame.rig();
        let size = [rig.width, rig.height];
        let left = self.frame.left();
        let believed = self.believed()?;
        let most_px = rig.disparity_px(6.0);
        Ok([
            grey_panel(&format!("{}: left image", self.world), size, |x, y| left.row(y)[x]),
            disparity_panel("matched: near is bright, none is white", size, most_px, believed.values()),
            self.map_panel("map of this image, L > 0.1", &self.single, SINGLE),
            self.map_panel("map of the flight, L > 1.0", &self.fused, FINAL),
        ])
    }

    /// The highest occupied cell of every column, by its height above the ground.
    fn map_panel(&self, title: &str, map: &LogOddsGrid, threshold: f32) -> Panel {
        let spec = map.spec();
        let [nx, ny, nz] = spec.shape();
        let [x0, y0, z0] = spec.origin_m();
        let height = |k: usize| z0 + (k as f64 + 0.5) * CELL_M + self.camera_m;
        let value = |i: usize, j: usize| {
            let column = &map.values()[(i * ny + j) * nz..][..nz];
            let top = column.iter().rposition(|l| *l > threshold).map(height)?;
            (top > FOOT_M).then_some(top / HIGH_M)
        };
        let patches = Patches { shape: [nx, ny], origin_m: [x0, y0], edge_m: CELL_M };
        Panel {
            title: title.to_owned(),
            x: Axis::new("metres ahead of the first frame", x0, x0 + nx as f64 * CELL_M),
            y: Axis::new("metres to the left", y0, y0 + ny as f64 * CELL_M),
            series: patches.shaded(value, rainbow),
            legend: None,
        }
    }
}

/// Blue, green, yellow, red.
fn rainbow(v: f64) -> RGBColor {
    let stops = [RGBColor(40, 70, 190), RGBColor(30, 160, 90), RGBColor(235, 190, 40), RGBColor(200, 40, 30)];
    let place = v.clamp(0.0, 1.0) * 3.0;
    let at = (place as usize).min(2);
    blend(stops[at], stops[at + 1], place - at as f64)
}
