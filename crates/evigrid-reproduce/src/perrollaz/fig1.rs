//! Fig. 1: the probabilities as functions of what is counted.

use anyhow::Result;

use super::exact::PAPER;
use crate::chart::{
    Axis, BLUE, Corner, DARK, GREEN, GREY, Marks, ORANGE, PINK, Panel, Point, SKY, Series, Sheet,
};
use crate::job::Job;
use crate::table::rounded;

/// Steps of both axes in the table.
const STEPS: usize = 50;
/// Values of the second variable that get a curve of their own.
const CURVES: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0];

/// Fig. 1 (a): P(O) over P(V) and r_O.
pub fn make_a(job: &mut Job<'_, '_>) -> Result<()> {
    let of =
        |visible: f64, obstacle_share: f64| PAPER.p_obstacle(visible, PAPER.p_confidence(obstacle_share));
    job.write_table(&["p_visible", "r_o", "p_occupied"], rows(of))?;
    job.write_picture(&sheet("P(occupied) by obstacle pixels (Fig. 1 a)", ["P(visible)", "P(occupied)"], of))
}

/// Fig. 1 (b): P(R) over r_R and r_O.
pub fn make_b(job: &mut Job<'_, '_>) -> Result<()> {
    let of = |road_share: f64, obstacle_share: f64| PAPER.p_road(road_share, obstacle_share);
    job.write_table(&["r_r", "r_o", "p_road"], rows(of))?;
    job.write_picture(&sheet("P(road) (Fig. 1 b)", ["r_R", "P(road)"], of))
}

fn rows(of: impl Fn(f64, f64) -> f64) -> Vec<Vec<String>> {
    let share = |n: usize| n as f64 / STEPS as f64;
    let places = (0..=STEPS).flat_map(|a| (0..=STEPS).map(move |b| [share(a), share(b)]));
    places.map(|[a, b]| vec![rounded(a, 2), rounded(b, 2), rounded(of(a, b), 6)]).collect()
}

fn sheet(title: &str, [x, y]: [&str; 2], of: impl Fn(f64, f64) -> f64) -> Sheet {
    let colours = [GREY, SKY, BLUE, GREEN, ORANGE, PINK];
    let curve = |(r_o, colour)| {
        let points: Vec<Point> = (0..=200).map(|n| f64::from(n) / 200.0).map(|a| (a, of(a, r_o))).collect();
        Series::new(format!("r_O = {r_o}"), colour, Marks::Line(points))
    };
    let mut series: Vec<Series> = CURVES.into_iter().zip(colours).map(curve).collect();
    series.push(Series::new("", DARK, Marks::Line(vec![(0.0, 0.5), (1.0, 0.5)])));
    Sheet {
        title: title.into(),
        notes: vec![
            "Perrollaz et al. 2012, eqs 8, 13 and 15, with tau_O = tau_R = 0.1, P_FP = P_FN = 0.02".into(),
        ],
        columns: 1,
        panel: (760, 460),
        panels: vec![Panel {
            title: String::new(),
            x: Axis::new(x, 0.0, 1.0),
            y: Axis::new(y, 0.0, 1.0),
            series,
            legend: Some(Corner::UpperLeft),
        }],
    }
}
