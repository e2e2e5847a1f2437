//! F1 over the error of motion.

use super::motion_error::Recording;
use super::motion_sweep::Setting;
use super::robot::{CELL_M, FRAMES, STRIDE};
use crate::chart::{Axis, BLUE, Corner, GREEN, Marks, ORANGE, PINK, Panel, Series, Sheet};

/// Two panels per drive: a constant error, and one that grows with the way.
pub fn picture(recordings: &[Recording]) -> Sheet {
    let mut names: Vec<&str> = recordings.iter().map(|r| r.name.as_str()).collect();
    names.dedup();
    let mut panels = Vec::new();
    for name in names {
        let here: Vec<&Recording> = recordings.iter().filter(|r| r.name == name).collect();
        panels.push(panel(&here, "eps of every frame (m)", |s| s.eps_m, |s| s.eps_per_m));
        panels.push(panel(&here, "eps per metre driven (m)", |s| s.eps_per_m, |s| s.eps_m));
    }
    Sheet {
        title: "Does an error of motion in the model (eps) make better maps?".into(),
        notes: vec![
            "up is better; the left end, eps = 0, is Andert's model; the claim would be orange and pink \
             lines that rise"
                .into(),
            format!(
                "corridor, yard: frames {FRAMES}, every {STRIDE}th, cells of {CELL_M} m, all against the \
                 laser with exact poses"
            ),
        ],
        columns: 2,
        panel: (560, 340),
        panels,
    }
}

fn panel(here: &[&Recording], label: &str, eps: fn(&Setting) -> f64, other: fn(&Setting) -> f64) -> Panel {
    let mut series = Vec::new();
    let mut most = 0.0_f64;
    for recording in here {
        let line = recording.line(eps, other);
        most = line.iter().map(|p| p.1).fold(most, f64::max);
        // A line has two ends.
        if line.len() < 2 {
            continue;
        }
        let colour = match recording.poses.as_str() {
            "exact" => BLUE,
            "odometry" => ORANGE,
            "GPS and inertial" => GREEN,
            _ => PINK,
        };
        let name = format!("poses: {}", recording.poses.trim_end_matches("(1)").trim_end());
        // Of the drives that are made many times the first alone is in the legend.
        let name = if name.ends_with(')') { String::new() } else { name };
        series.push(Series::new(name, colour, Marks::Line(line.clone())));
        series.push(Series::new("", colour, Marks::Dots(line, 4)));
    }
    let values = ticks(here.first(), eps, other);
    let end = values.len() as f64 - 0.8;
    Panel {
        title: here.first().map(|r| r.name.clone()).unwrap_or_default(),
        x: Axis { label: label.to_owned(), range: [-0.2, end], names: values },
        y: Axis::new("F1", 0.0, (1.5 * most).min(1.0)),
        series,
        legend: Some(Corner::UpperRight),
    }
}

/// The values of eps, as names of the places.
fn ticks(
    recording: Option<&&Recording>,
    eps: fn(&Setting) -> f64,
    other: fn(&Setting) -> f64,
) -> Vec<String> {
    let maps = recording.map_or(&[][..], |r| &r.maps[..]);
    let shown = maps.iter().filter(|m| m.setting.prior == 0.5 && other(&m.setting) == 0.0);
    let mut values: Vec<f64> = shown.map(|m| eps(&m.setting)).collect();
    values.sort_by(f64::total_cmp);
    values.iter().map(f64::to_string).collect()
}

impl Recording {
    /// F1 over a kind of error, from 0 on, each value one place to the right.
    fn line(&self, eps: fn(&Setting) -> f64, other: fn(&Setting) -> f64) -> Vec<(f64, f64)> {
        let shown = self.maps.iter().filter(|m| m.setting.prior == 0.5 && other(&m.setting) == 0.0);
        let mut points: Vec<(f64, f64)> = shown.map(|m| (eps(&m.setting), m.counts.f1())).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        (0..).zip(points).map(|(n, (_, f1))| (f64::from(n), f1)).collect()
    }
}
