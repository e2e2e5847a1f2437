//! Fig. 8: cross sections of the map over long low steps of 15 cm, which no robot on wheels can pass however level
//! they are.
//!
//! Each cut goes through the middle of the first edge of a flight of steps. It shows the map of the last frame at
//! which the robot is within 2 m of that edge: it has seen the steps then, and they are not yet beyond its planning
//! radius.

use anyhow::Result;
use evigrid_core::Frame;
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_grid::{SafetyLabel, SafetyMap};
use evigrid_results::label_rgb;
use evigrid_synth::{Hazard, HazardKind, SafetyTruth, hazards};
use plotters::style::RGBColor;

use super::cut::{Cut, CutCell, Found};
use super::mapping::{Drive, Mapping};
use super::worlds::MATCHERS;
use crate::chart::{Axis, Corner, DARK, Marks, Panel, Point, Series, Sheet, rectangle};
use crate::job::Job;
use crate::table::rounded;

/// The paper's data set with long low steps, each 15 cm high.
const WORLD: &str = "safety-4";
/// The steps down begin at x = 3, those up at y = 2; their first edges reach from y = -3.2 to 2 and from x = -4.5
/// to 0.6 (datasets/synth/safety-4.toml).
const CUTS: [Cut; 2] = [
    Cut { name: "down", axis: 0, along_m: [1.5, 6.9], across_m: -0.6, edge_m: 3.0 },
    Cut { name: "up", axis: 1, along_m: [0.0, 4.9], across_m: -1.95, edge_m: 2.0 },
];
const REACH_M: f64 = 2.0;

/// A cut through the map of one matcher, and how the edges of its flight of steps are labelled over their length.
struct Section {
    matcher: &'static str,
    cut: usize,
    cells: Vec<CutCell>,
    edges: Vec<(String, Found)>,
}

/// What is true in the world.
struct True {
    map: SafetyMap,
    steps: Vec<Hazard>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let drive = Drive::new(WORLD)?;
    let truth = True::new(&drive)?;
    let moments = [CUTS[0].last_frame_near(&drive, REACH_M)?, CUTS[1].last_frame_near(&drive, REACH_M)?];
    let last = moments[0].max(moments[1]);
    job.say(&format!("synth:{WORLD}, {} frames", last + 1));
    let mut maps: Vec<Mapping> =
        MATCHERS.iter().map(|(matcher, _)| drive.mapping(matcher)).collect::<Result<_>>()?;
    let mut sections = Vec::new();
    for index in 0..=last {
        let frame: Frame = drive.frame(index)?;
        for map in &mut maps {
            drive.add(&frame, map, &mut |_| {})?;
            for cut in (0..CUTS.len()).filter(|&cut| moments[cut] == index) {
                sections.push(Section::new(&drive, &truth, index, map, cut)?);
            }
        }
    }
    let header = ["matcher", "cut", "along_m", "column_m", "plane_m", "label", "true_label"];
    job.write_table(&header, sections.iter().flat_map(Section::rows))?;
    let header =
        ["matcher", "cut", "frame", "where", "unsafe_cells", "non_ground", "safe", "unknown", "found"];
    job.write_more("steps", &header, sections.iter().flat_map(|section| section.counts(moments)))?;
    let surfaces = [CUTS[0].surface(&drive)?, CUTS[1].surface(&drive)?];
    let header = ["cut", "along_m", "true_height_m"];
    job.write_more("surface", &header, surface_rows(&surfaces))?;
    job.write_picture(&sheet(&sections, &surfaces))
}

impl True {
    fn new(drive: &Drive) -> Result<Self> {
        let (world, spec, rules) = (&drive.world, drive.world.truth_grid(), SafetyRules::default());
        let map = SafetyTruth::new(world, spec, &drive.map_from_world, 0, &rules)?.map();
        let mut steps = hazards(world, &drive.map_from_world, &map)?;
        steps.retain(|hazard| hazard.kind == HazardKind::Step);
        Ok(Self { map, steps })
    }
}

impl Section {
    fn new(drive: &Drive, truth: &True, frame: usize, map: &Mapping, cut: usize) -> Result<Self> {
        let labels = map.mapper.map().labels();
        let edge = |hazard: &Hazard| {
            let pairs = hazard.cells.iter().map(|&cell| (labels[cell], truth.map.labels()[cell]));
            (hazard.name.clone(), Found::count(pairs))
        };
        let of_cut = |hazard: &&Hazard| (hazard.name.contains("-up-")) == (CUTS[cut].name == "up");
        let edges = truth.steps.iter().filter(of_cut).map(edge).collect();
        Ok(Self { matcher: map.matcher, cut, cells: CUTS[cut].look(drive, frame, map, &truth.map)?, edges })
    }

    /// Of the truly unsafe cells on the cut.
    fn found(&self) -> Found {
        Found::count(self.cells.iter().map(|cell| (cell.label, cell.true_label)))
    }

    fn rows(&self) -> impl Iterator<Item = Vec<String>> + '_ {
        let height = |m: Option<f64>| rounded(m.unwrap_or(f64::NAN), 3);
        self.cells.iter().map(move |cell| {
            vec![
                self.matcher.into(),
                CUTS[self.cut].name.into(),
                rounded(cell.along_m, 3),
                height(cell.column_m),
                height(cell.plane_m),
                cell.label.name().into(),
                cell.true_label.name().into(),
            ]
        })
    }

    /// The cut, then each edge over its whole length, as far as it is within the planning radius. Found: most of
    /// these cells are unsafe in the map.
    fn counts(&self, moments: [usize; 2]) -> Vec<Vec<String>> {
        let all = std::iter::once(("cut".to_owned(), self.found())).chain(self.edges.iter().cloned());
        let row = |(place, found): (String, Found)| {
            let verdict = match found.all() {
                0 => "",
                all if 2 * found.non_ground > all => "yes",
                _ => "no",
            };
            let mut row = vec![self.matcher.into(), CUTS[self.cut].name.into()];
            row.extend([moments[self.cut].to_string(), place, found.all().to_string()]);
            row.extend([found.non_ground, found.safe, found.unknown].map(|count| count.to_string()));
            row.push(verdict.to_owned());
            row
        };
        all.map(row).collect()
    }
}

fn surface_rows(surfaces: &[Vec<Point>]) -> Vec<Vec<String>> {
    let rows = CUTS.iter().zip(surfaces).flat_map(|(cut, surface)| {
        surface.iter().map(|(along, height)| vec![cut.name.into(), rounded(*along, 3), rounded(*height, 4)])
    });
    rows.collect()
}

/// Half the width of a cell, and half the height of what is drawn for one, metres.
const HALF_CELL_M: f64 = 0.05;
const HALF_MARK_M: f64 = 0.02;
/// Heights that are drawn, and the places of the two strips of labels, metres.
const SHOWN_M: [f64; 2] = [-1.0, 0.9];
const STRIPS_M: [[f64; 2]; 2] = [[-0.83, -0.76], [-0.93, -0.86]];

fn sheet(sections: &[Section], surfaces: &[Vec<Point>]) -> Sheet {
    let mut panels = Vec::new();
    for (matcher, _) in MATCHERS {
        let own = |cut: usize| sections.iter().find(|s| (s.matcher, s.cut) == (matcher, cut));
        panels.extend((0..CUTS.len()).filter_map(own).map(|s| panel(s, &surfaces[s.cut])));
    }
    Sheet {
        title: format!("Steps of 15 cm, cut across: synth:{WORLD} (Murarka and Kuipers 2009, Fig. 8)"),
        notes: vec![
            "each cell at the height of its plane, or of its column if it has none, in the colour of its label; \
             dark line: the true surface"
                .into(),
            "strips at the bottom: above the labels of the map, below the true ones; orange beyond the first edge \
             is right, blue is wrong"
                .into(),
        ],
        columns: CUTS.len(),
        panel: (620, 300),
        panels,
    }
}

fn panel(section: &Section, surface: &[Point]) -> Panel {
    let (found, cut) = (section.found(), CUTS[section.cut]);
    let mut series: Vec<Series> = SafetyLabel::ALL
        .into_iter()
        .filter(|label| *label != SafetyLabel::Unexamined)
        .map(|label| label_series(section, label))
        .collect();
    series.push(Series::new("true surface", DARK, Marks::Line(surface.to_vec())));
    let axis = ["x", "y"][cut.axis];
    Panel {
        title: format!(
            "{}, steps {}: of {} unsafe cells {} unsafe, {} safe, {} unknown",
            section.matcher,
            cut.name,
            found.all(),
            found.non_ground,
            found.safe,
            found.unknown
        ),
        x: Axis::new(&format!("world's {axis} (m)"), cut.along_m[0], cut.along_m[1]),
        y: Axis::new("height (m)", SHOWN_M[0], SHOWN_M[1]),
        series,
        legend: Some(if cut.name == "up" { Corner::UpperLeft } else { Corner::UpperRight }),
    }
}

/// The cells of a label, and its parts of both strips.
fn label_series(section: &Section, label: SafetyLabel) -> Series {
    let [from, to] = CUTS[section.cut].along_m;
    let across =
        |cell: &CutCell| [(cell.along_m - HALF_CELL_M).max(from), (cell.along_m + HALF_CELL_M).min(to)];
    let mut areas = Vec::new();
    for cell in &section.cells {
        let height = cell.plane_m.or(cell.column_m).filter(|height| *height < SHOWN_M[1] - HALF_MARK_M);
        if let (true, Some(height)) = (cell.label == label, height) {
            areas.push(rectangle(across(cell), [height - HALF_MARK_M, height + HALF_MARK_M]));
        }
        for (strip, own) in STRIPS_M.into_iter().zip([cell.label, cell.true_label]) {
            if own == label {
                areas.push(rectangle(across(cell), strip));
            }
        }
    }
    let [r, g, b] = label_rgb(label);
    Series::new(label.name().replace('_', "-"), RGBColor(r, g, b), Marks::Areas(areas))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(label: SafetyLabel, true_label: SafetyLabel) -> CutCell {
        CutCell { along_m: 3.0, column_m: Some(-0.15), plane_m: None, label, true_label }
    }

    #[test]
    fn a_step_is_found_if_most_of_its_cells_are_unsafe_in_the_map() {
        use SafetyLabel::{Level, NonGround, Unexamined, Unknown};
        let cells = vec![cell(NonGround, NonGround), cell(Level, NonGround), cell(Level, Level)];
        let edges = vec![
            ("near".to_owned(), Found { non_ground: 3, safe: 1, unknown: 1 }),
            ("far".to_owned(), Found::count([(Unexamined, NonGround)].into_iter())),
            ("lost".to_owned(), Found::count([(Unknown, NonGround)].into_iter())),
        ];
        let section = Section { matcher: "exact", cut: 0, cells, edges };
        let rows = section.counts([7, 9]);
        let expected = ["exact down 7 cut 2 1 1 0 no", "exact down 7 near 5 3 1 1 yes"];
        assert_eq!([0, 1].map(|n| rows[n].join(" ")), expected);
        assert_eq!([rows[2][8].as_str(), rows[3][8].as_str()], ["", "no"]);
    }

    #[test]
    fn every_flight_has_its_edges_and_the_robot_comes_near() {
        let drive = Drive::new(WORLD).unwrap();
        let names: Vec<String> = True::new(&drive).unwrap().steps.into_iter().map(|step| step.name).collect();
        assert_eq!(names.iter().filter(|name| name.contains("-up-")).count(), 3);
        assert_eq!(names.len(), 7);
        // From the waypoints: the robot turns away from the steps down at (2.4, 0.8), passes those up at (-2.2, 0.95)
        // and comes back only to (1.0, -1.8), 2.3 m from the middle of the edge down.
        let [down, up] = [0, 1].map(|n: usize| CUTS[n].last_frame_near(&drive, REACH_M).unwrap());
        assert!((190..=230).contains(&down), "{down}");
        assert!((down + 100..drive.frames().end - 1).contains(&up), "{up}");
    }
}
