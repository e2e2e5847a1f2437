//! Fig. 6 (b) and section VII-B: frames until half and 90 % of the width of a board are in the occupancy grid.
//!
//! The worlds hold five drives each, one to a board that is 2, 3, 4, 5 or 6 m away when it is first seen. A board
//! has appeared in the first frame whose left image shows it; frames of a standing robot, which the method drops,
//! do not count. `board.rs` says what part of a board is in the grid.

use anyhow::Result;
use evigrid_synth::tracks;
use plotters::style::RGBColor;

use super::board::{Visit, visits};
use super::latency::{Approach, Claim, Detection, SHARES, claims};
use super::mapping::{Drive, Mapping};
use super::published::{LATENCY_FRAMES, LATENCY_WITHIN_M};
use super::worlds::MATCHERS;
use crate::chart::{Axis, BLUE, Corner, GREY, Marks, ORANGE, PINK, Panel, Point, SKY, Series, Sheet};
use crate::job::Job;
use crate::table::rounded;

/// Name of the board, and the world that it stands in.
const BOARDS: [(&str, &str); 2] = [("textured", "board-textured"), ("untextured", "board-plain")];

/// All approaches to the boards of one world by the map of one matcher.
struct Line {
    texture: &'static str,
    matcher: &'static str,
    approaches: Vec<Approach>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut lines = Vec::new();
    for (texture, world) in BOARDS {
        lines.extend(approaches(job, texture, world)?);
    }
    let header = [
        "texture",
        "matcher",
        "start_distance_m",
        "frames_to_50_percent",
        "distance_at_50_percent_m",
        "frames_to_90_percent",
        "distance_at_90_percent_m",
        "frames",
        "percent_in_grid_at_end",
    ];
    job.write_table(&header, lines.iter().flat_map(Line::rows))?;
    let header = ["matcher", "claim_of_the_paper", "ours", "met"];
    job.write_more("claims", &header, claim_rows(&lines))?;
    job.write_picture(&sheet(&lines))
}

/// Drives through a world once, with a map for each matcher.
fn approaches(job: &mut Job<'_, '_>, texture: &'static str, world: &str) -> Result<Vec<Line>> {
    let drive = Drive::new(world)?;
    job.say(&format!("synth:{world}, {} frames", drive.frames().len()));
    let visits = visits(&drive.world, &tracks(&drive.world, &drive.map_from_world, 0));
    let mut maps: Vec<Mapping> =
        MATCHERS.iter().map(|(matcher, _)| drive.mapping(matcher)).collect::<Result<_>>()?;
    let line = |map: &Mapping| Line {
        texture,
        matcher: map.matcher,
        approaches: vec![Approach::default(); visits.len()],
    };
    let mut lines: Vec<Line> = maps.iter().map(line).collect();
    for index in drive.frames() {
        let frame = drive.frame(index)?;
        for (map, line) in maps.iter_mut().zip(&mut lines) {
            if drive.add(&frame, map, &mut |_| {})? {
                let camera_m = frame.map_from_left().translation.x;
                let seen = visits.iter().zip(&mut line.approaches);
                for (visit, approach) in seen.filter(|(visit, _)| (visit.first..=visit.last).contains(&index))
                {
                    approach.add(visit.face.x_m - camera_m, share(visit, map)?);
                }
            }
        }
    }
    lines.iter_mut().for_each(|line| line.approaches.sort_by(|a, b| a.start_m.total_cmp(&b.start_m)));
    Ok(lines)
}

fn share(visit: &Visit, map: &Mapping) -> Result<f64> {
    let model = map.model()?;
    Ok(visit.face.share_found(model.spec(), |voxel| model.is_occupied(voxel)))
}

impl Line {
    fn rows(&self) -> impl Iterator<Item = Vec<String>> + '_ {
        let detection = |found: Option<Detection>| match found {
            Some(Detection { frames, distance_m }) => [frames.to_string(), rounded(distance_m, 2)],
            None => Default::default(),
        };
        self.approaches.iter().map(move |approach| {
            let [half, most] = approach.detected.map(detection);
            let mut row = vec![self.texture.into(), self.matcher.into(), rounded(approach.start_m, 2)];
            row.extend(half.into_iter().chain(most));
            row.extend([approach.frames.to_string(), rounded(100.0 * approach.share, 1)]);
            row
        })
    }

    /// Frames to one of the shares over the first distance: those of detections, and for boards that were never
    /// detected all frames of the approach, as the paper plots them.
    fn points(&self, share: usize) -> [Vec<Point>; 2] {
        let of = |is_found: bool| {
            let chosen = self.approaches.iter().filter(move |a| a.detected[share].is_some() == is_found);
            chosen.map(|a| (a.start_m, a.frames_to(share).unwrap_or(a.frames) as f64)).collect()
        };
        [of(true), of(false)]
    }
}

fn claim_rows(lines: &[Line]) -> Vec<Vec<String>> {
    let of = |matcher: &str, texture: &str| {
        let line = lines.iter().find(|line| (line.matcher, line.texture) == (matcher, texture));
        line.map_or(&[][..], |line| &line.approaches)
    };
    let mut rows = Vec::new();
    for (matcher, _) in MATCHERS {
        for Claim { text, ours, is_met } in claims(of(matcher, BOARDS[0].0), of(matcher, BOARDS[1].0)) {
            let ours = ours.map_or("never".into(), |number| number.to_string());
            rows.push(vec![matcher.into(), text, ours, if is_met { "yes" } else { "no" }.into()]);
        }
    }
    rows
}

fn sheet(lines: &[Line]) -> Sheet {
    let most = lines.iter().flat_map(|line| &line.approaches).map(|a| a.frames).max().unwrap_or(0);
    Sheet {
        title: "Frames until a board is detected (Murarka and Kuipers 2009, Fig. 6 b)".into(),
        notes: vec![
            "lower is better; the robot drives 5 cm between two frames".into(),
            "open rings: never before the drive ends 0.7 m before the board; drawn at its length, as in the paper"
                .into(),
            format!(
                "grey: the paper's {LATENCY_FRAMES} frames for 50 % of either board, up to {LATENCY_WITHIN_M} m"
            ),
        ],
        columns: MATCHERS.len(),
        panel: (430, 420),
        panels: MATCHERS
            .iter()
            .map(|(matcher, _)| panel(matcher, lines, 1.15 * most as f64))
            .collect(),
    }
}

fn panel(matcher: &str, lines: &[Line], top: f64) -> Panel {
    let limit = vec![(1.5, LATENCY_FRAMES as f64), (LATENCY_WITHIN_M, LATENCY_FRAMES as f64)];
    let mut series = vec![Series::new("", GREY, Marks::Line(limit))];
    for (line, colours) in
        lines.iter().filter(|line| line.matcher == matcher).zip([[SKY, BLUE], [PINK, ORANGE]])
    {
        for (share, colour) in colours.into_iter().enumerate() {
            series.extend(curve(line, share, colour));
        }
    }
    Panel {
        title: format!("{matcher} disparities"),
        x: Axis::new("distance of the board when it appears (m)", 1.5, 6.5),
        y: Axis::new("frames until detection", 0.0, top),
        series,
        legend: Some(Corner::UpperLeft),
    }
}

fn curve(line: &Line, share: usize, colour: RGBColor) -> [Series; 3] {
    let [found, never] = line.points(share);
    let mut all = [found.clone(), never.clone()].concat();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let name = format!("{}, {:.0} %", line.texture, 100.0 * SHARES[share]);
    [
        Series::new(name, colour, Marks::Line(all)),
        Series::new("", colour, Marks::Dots(found, 4)),
        Series::new("", colour, Marks::Rings(never, 6)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the worlds' descriptions put the boards and the first frames that show them.
    #[test]
    fn boards_appear_where_the_worlds_say() {
        for (_, world) in BOARDS {
            let drive = Drive::new(world).unwrap();
            let visits = visits(&drive.world, &tracks(&drive.world, &drive.map_from_world, 0));
            assert_eq!(visits.iter().map(|v| v.first).collect::<Vec<_>>(), [0, 27, 74, 141, 228]);
            for (n, visit) in visits.iter().enumerate() {
                let camera = drive.map_from_world * drive.world.true_world_from_left(visit.first);
                let distance_m = visit.face.x_m - camera.translation.x;
                assert!((distance_m - (2.0 + n as f64)).abs() < 1e-6, "{visit:?}");
                assert!((visit.face.y_m[1] - visit.face.y_m[0] - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn boards_that_were_never_detected_are_drawn_at_the_length_of_the_approach() {
        let mut approach = Approach::default();
        [0.2, 0.6, 0.7].into_iter().for_each(|share| approach.add(2.0, share));
        let line = Line { texture: "untextured", matcher: "block", approaches: vec![approach] };
        assert_eq!(line.points(0), [vec![(2.0, 2.0)], vec![]]);
        assert_eq!(line.points(1), [vec![], vec![(2.0, 3.0)]]);
        let row: Vec<Vec<String>> = line.rows().collect();
        assert_eq!(row[0][2..], ["2.00", "2", "2.00", "", "", "3", "70.0"]);
    }
}
