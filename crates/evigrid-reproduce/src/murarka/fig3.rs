//! Fig. 3: the segments of Algorithm 1, the planes that are fitted to them, and a cross-section.

use anyhow::{Context, Result};
use evigrid_grid::{PlanSpec, SafetyLabel};
use evigrid_safety_map::{Segment, Segments};
use plotters::prelude::RGBColor;

use super::drive::{FRAME, Heights, Sight, WORLD, drive, height_colour};
use super::plan_view::{panel, patches, robot_series};
use crate::cells::blend;
use crate::chart::{
    Axis, BLUE, COLOURS, DARK, GREY, Key, Marks, ORANGE, Panel, Point, Series, Sheet, rectangle,
};
use crate::job::Job;
use crate::table::rounded;

/// Heights of planes that are told apart, metres.
const HEIGHTS: Heights = Heights([-0.4, 0.4]);
/// Segments that are numbered in the picture.
const NAMED: usize = 16;
/// Slopes at which Algorithm 2 draws its lines, degrees.
const SLOPES_DEG: [f64; 2] = [3.0, 10.0];

/// A segment with what its cells became.
struct Row {
    segment: Segment,
    /// Height of its layer of voxels over the robot's floor, metres.
    layer_m: f64,
    /// Mean height of its plane over its cells, over the robot's floor, metres; NaN without a plane.
    height_m: f64,
    slope_deg: f64,
    label: SafetyLabel,
}

/// The segments at one frame.
struct Picture {
    spec: PlanSpec,
    segments: Segments,
    rows: Vec<Row>,
    robot: Vec<Series>,
    floor_m: f64,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut picture = None;
    drive(job, &[FRAME], &mut |sight| {
        picture = Some(Picture::of(sight)?);
        Ok(())
    })?;
    let picture = picture.context("a drive without frames")?;
    let header = ["segment", "cells", "interior", "boundary", "layer_m", "height_m", "slope_deg", "label"];
    job.write_table(&header, picture.rows.iter().enumerate().map(|(n, row)| row.cells(n)))?;
    let sheet = Sheet {
        title: format!(
            "Segments of ground and their planes, {WORLD}, frame {FRAME} (Murarka and Kuipers 2009, Fig. 3)"
        ),
        notes: vec![format!(
            "all heights over the robot's floor; of {} segments the {NAMED} largest are numbered, from the robot's \
             (0) on as they were found; white: no segment",
            picture.rows.len()
        )],
        columns: 3,
        panel: (560, 500),
        panels: vec![picture.segments_panel(), picture.planes_panel(), picture.slopes_panel()],
    };
    let key: Vec<Key> =
        HEIGHTS.key().into_iter().map(|(text, colour)| (format!("plane {text}"), colour)).collect();
    job.write_keyed_picture(&sheet, &key)
}

impl Row {
    /// Its line in the table of all segments.
    fn cells(&self, number: usize) -> [String; 8] {
        let Segment { cells, interior, .. } = &self.segment;
        [
            number.to_string(),
            cells.len().to_string(),
            interior.to_string(),
            (cells.len() - interior).to_string(),
            rounded(self.layer_m, 2),
            rounded(self.height_m, 3),
            rounded(self.slope_deg, 2),
            self.label.name().to_owned(),
        ]
    }

    /// Its line in the table beside the picture.
    fn text(&self, number: usize) -> String {
        let (cells, label) = (self.segment.cells.len(), self.label.name().replace('_', "-"));
        if self.slope_deg.is_nan() {
            return format!("{number}: {cells} cells, no plane, {label}");
        }
        format!("{number}: {cells} cells, {:+.2} m, {:.1} deg, {label}", cm(self.height_m), self.slope_deg)
    }
}

impl Picture {
    fn of(sight: &Sight<'_>) -> Result<Self> {
        let (model, map) = (sight.model()?, sight.mapper.map());
        let segments = sight.mapper.segments().context("no frame has been mapped")?;
        let floor_m = sight.floor_m;
        let row = |segment: &Segment| {
            let first = segment.cells.first().map_or(0, |&cell| cell as usize);
            let layer = sight.mapper.columns().height(first).map_or(f64::NAN, f64::from);
            let c = model.spec().cell_size_m();
            let layer_m = model.spec().origin_m()[2] + (layer + 0.5) * c - floor_m;
            Row {
                layer_m,
                height_m: mean_height_m(segment, map.spec()) - floor_m,
                slope_deg: segment.plane.map_or(f64::NAN, |plane| plane.slope_deg()),
                label: map.labels()[first],
                segment: segment.clone(),
            }
        };
        let rows = segments.list.iter().map(row).collect();
        Ok(Self { spec: *map.spec(), segments, rows, robot: robot_series(&sight.robot), floor_m })
    }

    /// The largest segments, by number.
    fn named(&self) -> Vec<usize> {
        let mut numbers: Vec<usize> = (0..self.rows.len()).collect();
        numbers.sort_by_key(|&n| std::cmp::Reverse(self.rows[n].segment.cells.len()));
        numbers.truncate(NAMED);
        numbers.sort_unstable();
        numbers
    }

    fn segments_panel(&self) -> Panel {
        let (patches, ny) = (patches(&self.spec), self.spec.shape()[1]);
        let colours = segment_colours(&self.segments, &self.spec);
        let mut series: Vec<Series> = (0..COLOURS.len())
            .map(|own| {
                let is_own = |flat: usize| self.segments.of(flat).is_some_and(|n| colours[n] == own);
                Series::new("", pale(own), Marks::Areas(patches.areas(|i, j| is_own(i * ny + j))))
            })
            .collect();
        series.extend(self.robot.clone());
        let word = |n: usize| (middle(&self.rows[n].segment, &self.spec), n.to_string());
        series.push(Series::new("", DARK, Marks::Words(self.named().into_iter().map(word).collect())));
        panel("segments: neighbours in different colours".into(), &self.spec, series)
    }

    fn planes_panel(&self) -> Panel {
        let ny = self.spec.shape()[1];
        let height = |i: usize, j: usize| {
            let plane = self.rows[self.segments.of(i * ny + j)?].segment.plane?;
            Some(HEIGHTS.share(plane.height_m(self.spec.centre_m(i * ny + j)) - self.floor_m))
        };
        let mut series = patches(&self.spec).shaded(height, height_colour);
        series.extend(self.robot.clone());
        panel("the planes fitted to them: height over the floor".into(), &self.spec, series)
    }

    /// A bar per numbered segment: the slope of its plane.
    fn slopes_panel(&self) -> Panel {
        let (named, colours) = (self.named(), segment_colours(&self.segments, &self.spec));
        let count = named.len() as f64;
        let end = named.iter().map(|&n| self.rows[n].slope_deg).filter(|v| !v.is_nan()).fold(12.0, f64::max);
        let bar = |(place, &n): (usize, &usize)| {
            let y = count - 1.0 - place as f64;
            let slope_deg = self.rows[n].slope_deg;
            let area =
                rectangle([0.0, if slope_deg.is_nan() { 0.0 } else { slope_deg }], [y - 0.35, y + 0.35]);
            Series::new("", pale(colours[n]), Marks::Areas(vec![area]))
        };
        let mut series: Vec<Series> = named.iter().enumerate().map(bar).collect();
        let limits = [("level below 3 deg", BLUE), ("non-ground over 10 deg", ORANGE)];
        for (slope_deg, (_, colour)) in SLOPES_DEG.into_iter().zip(limits) {
            let line: Vec<Point> = vec![(slope_deg, -0.6), (slope_deg, count - 0.4)];
            series.push(Series::new("", colour, Marks::Line(line)));
        }
        let names = named.iter().rev().map(|&n| self.rows[n].text(n)).collect();
        Panel {
            title: format!("slopes; lines: {}, {}", limits[0].0, limits[1].0),
            x: Axis::new("slope of the plane (degrees)", 0.0, 1.05 * end),
            y: Axis { names, ..Axis::new("", -0.6, count - 0.4) },
            series,
            legend: None,
        }
    }
}

/// A height to the centimetre, without the sign of what rounds to nothing.
fn cm(height_m: f64) -> f64 {
    (100.0 * height_m).round() / 100.0 + 0.0
}

/// Mean height of a segment's plane over its cells, metres; NaN without a plane.
fn mean_height_m(segment: &Segment, spec: &PlanSpec) -> f64 {
    let Some(plane) = segment.plane else { return f64::NAN };
    let heights = segment.cells.iter().map(|&cell| plane.height_m(spec.centre_m(cell as usize)));
    heights.sum::<f64>() / segment.cells.len() as f64
}

/// The centre of the cell of a segment that is nearest to the mean of its cells.
fn middle(segment: &Segment, spec: &PlanSpec) -> Point {
    let centres: Vec<[f64; 2]> = segment.cells.iter().map(|&cell| spec.centre_m(cell as usize)).collect();
    let mean = [0, 1].map(|a| centres.iter().map(|at| at[a]).sum::<f64>() / centres.len() as f64);
    let distance = |at: &&[f64; 2]| (at[0] - mean[0]).hypot(at[1] - mean[1]);
    let nearest = centres.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or((mean[0], mean[1]), |&[x, y]| (x, y))
}

fn pale(colour: usize) -> RGBColor {
    // Numbers in dark must be readable on all of them.
    let colour = if COLOURS[colour] == DARK { GREY } else { COLOURS[colour] };
    blend(colour, RGBColor(255, 255, 255), 0.35)
}

/// A colour for each segment, by its place among [`COLOURS`]: from its own number on the first that none of its
/// neighbours of lower number has. Should they have all, it is that of the fewest.
fn segment_colours(segments: &Segments, spec: &PlanSpec) -> Vec<usize> {
    let mut colours: Vec<usize> = Vec::new();
    for (number, segment) in segments.list.iter().enumerate() {
        let mut taken = [0_usize; COLOURS.len()];
        let neighbours = segment.cells.iter().flat_map(|&cell| spec.neighbours(cell as usize));
        for other in neighbours.filter_map(|cell| segments.of(cell)).filter(|&other| other < number) {
            taken[colours[other]] += 1;
        }
        let from_own = (number..number + COLOURS.len()).map(|colour| colour % COLOURS.len());
        colours.push(from_own.min_by_key(|&colour| taken[colour]).unwrap_or(0));
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::Plane;

    /// Two cells along x, four along y: segment 0 holds the first row but for its end, 1 the rest of that row and
    /// of the next its end, 2 what is left of it.
    fn segments() -> (Segments, PlanSpec) {
        let spec = PlanSpec::of_area([0.0, 2.0], [0.0, 4.0], 1.0).unwrap();
        let segment = |cells: &[u32]| Segment { cells: cells.to_vec(), interior: 0, plane: None };
        let list = vec![segment(&[0, 1, 2]), segment(&[3, 7]), segment(&[4, 5, 6])];
        let of_cell = [0, 0, 0, 1, 2, 2, 2, 1].map(Some).to_vec();
        (Segments { list, of_cell }, spec)
    }

    /// Eight cells around a ninth, each a segment: the last one touches the first two and the two before it.
    #[test]
    fn neighbours_differ_in_colour() {
        let spec = PlanSpec::of_area([0.0, 3.0], [0.0, 3.0], 1.0).unwrap();
        let ring = [0, 1, 2, 5, 8, 7, 6, 3];
        let segment = |&cell: &u32| Segment { cells: vec![cell], interior: 0, plane: None };
        let mut of_cell = vec![None; 9];
        ring.iter().zip(0..).for_each(|(&cell, number)| of_cell[cell as usize] = Some(number));
        let segments = Segments { list: ring.iter().map(segment).collect(), of_cell };
        assert_eq!(segment_colours(&segments, &spec), [0, 1, 2, 3, 4, 5, 6, 2]);
    }

    #[test]
    fn heights_and_rows_by_hand() {
        let (mut segments, spec) = segments();
        let plane = Plane { p1: 0.0, p2: 0.1, p3: -1.0 };
        segments.list[2].plane = Some(plane);
        // Centres at y = 0.5, 1.5, 2.5.
        assert!((mean_height_m(&segments.list[2], &spec) + 0.85).abs() < 1e-12);
        assert!(mean_height_m(&segments.list[0], &spec).is_nan());
        assert_eq!(middle(&segments.list[2], &spec), (1.5, 1.5));
        let row = Row {
            segment: segments.list[2].clone(),
            layer_m: 0.2,
            height_m: 0.15,
            slope_deg: plane.slope_deg(),
            label: SafetyLabel::Inclined,
        };
        assert_eq!(row.cells(2), ["2", "3", "0", "3", "0.20", "0.150", "5.71", "inclined"]);
        assert_eq!(row.text(2), "2: 3 cells, +0.15 m, 5.7 deg, inclined");
    }
}
