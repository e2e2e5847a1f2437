//! Fig. 2: Elfes' formulation against the paper's, on cost curves with one and with two minima.

use anyhow::Result;
use evigrid_cost_curve::{CostExponent, CostUnit};

use super::ray::Ray;
use crate::chart::{Axis, BLUE, Corner, GREY, Marks, ORANGE, Panel, Series, Sheet};
use crate::job::Job;
use crate::table::rounded;

/// Cells of the ray. The paper gives no numbers; minima of cost 0 at cells 20 and 40 are our choice.
const CELLS: usize = 60;
/// The costs are bounded valleys: `steepness` times the squared distance to the
/// nearest minimum, at most this.
const HIGHEST: f64 = 100.0;
const VARIANCE: f64 = 2.0;

/// Name, where the minima are, and how steep the valleys: 16 leaves a minimum by
/// itself, 0.4 is as wide as Fig. 1.
const CURVES: [(&str, &[f64], f64); 3] = [
    ("one minimum", &[20.0], 16.0),
    ("two equal minima", &[20.0, 40.0], 16.0),
    ("one wide minimum", &[20.0], 0.4),
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let rays: Vec<(&str, Ray)> = CURVES.iter().map(|(name, at, steep)| (*name, ray(at, *steep))).collect();
    let header = ["curve", "cell", "cost", "likelihood", "visibility", "elfes", "whole_curve"];
    let rows = rays.iter().flat_map(|(name, ray)| (0..CELLS).map(move |i| row(name, ray, i)));
    job.write_table(&header, rows)?;
    let mut panels: Vec<Panel> = rays.iter().map(|(name, ray)| input_panel(name, ray)).collect();
    panels.extend(rays.iter().map(|(_, ray)| profile_panel(ray)));
    job.write_picture(&Sheet {
        title: "Fig. 2: occupancy from a cost curve, Elfes' formulation and the whole curve".into(),
        notes: vec![
            "above: the evidence p(E | cell i occupied and visible), eq. 7; below: P(occupied), 0.5 = \
             unknown"
                .into(),
            "two equal minima: Elfes believes the first and forgets the second, the whole curve keeps both \
             at 0.5"
                .into(),
        ],
        columns: CURVES.len(),
        panel: (400, 300),
        panels,
    })
}

fn ray(minima: &[f64], steepness: f64) -> Ray {
    let distance = |cell: f64| minima.iter().map(|m| (cell - m).abs()).fold(f64::INFINITY, f64::min);
    let costs = (1..=CELLS).map(|cell| (steepness * distance(cell as f64).powi(2)).min(HIGHEST)).collect();
    Ray::new(costs, CostExponent::new(CostUnit::GreyLevels, VARIANCE, 1.0), None)
}

fn row(name: &str, ray: &Ray, i: usize) -> [String; 7] {
    let of = |values: &[f64]| rounded(values[i], 9);
    let [cost, likelihood, visibility] = [&ray.costs, &ray.likelihood, &ray.visibility].map(|v| of(v));
    let cell = (i + 1).to_string();
    [name.to_owned(), cell, cost, likelihood, visibility, of(&ray.elfes), of(&ray.whole)]
}

fn input_panel(name: &str, ray: &Ray) -> Panel {
    Panel {
        title: name.to_owned(),
        x: Axis::new("cell", 0.0, CELLS as f64),
        y: Axis::new("p (eq. 7)", 0.0, 1.05),
        series: vec![Series::new("evidence", GREY, Marks::Areas(vec![under(&ray.likelihood)]))],
        legend: None,
    }
}

fn profile_panel(ray: &Ray) -> Panel {
    Panel {
        x: Axis::new("cell", 0.0, CELLS as f64),
        y: Axis::new("P(occupied)", 0.0, 1.05),
        series: vec![
            Series::new("Elfes", ORANGE, Marks::Line(points(&ray.elfes))),
            Series::new("whole curve", BLUE, Marks::Line(points(&ray.whole))),
        ],
        legend: Some(Corner::UpperRight),
        ..Panel::default()
    }
}

fn points(values: &[f64]) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(i, &v)| ((i + 1) as f64, v)).collect()
}

/// The area below a curve.
fn under(values: &[f64]) -> Vec<(f64, f64)> {
    let ends = [(values.len() as f64, 0.0), (1.0, 0.0)];
    points(values).into_iter().chain(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the minima, only these numbers depend on the choice of costs: exp(-16 / 4) beside a minimum.
    #[test]
    fn two_equal_minima_by_hand() {
        let ray = ray(&[20.0, 40.0], 16.0);
        let beside = (-4.0_f64).exp();
        let far = (-HIGHEST / (2.0 * VARIANCE)).exp();
        let sum = 2.0 * (1.0 + 2.0 * beside + 2.0 * (-16.0_f64).exp()) + 50.0 * far;
        assert!((ray.likelihood[19] - 1.0 / sum).abs() < 1e-9, "{} {sum}", ray.likelihood[19]);
        assert_eq!(ray.likelihood[19], ray.likelihood[39]);
        // Both within a tenth of one half; about a quarter between; Elfes believes the first one alone.
        assert!((ray.whole[19] - 0.5).abs() < 0.05 && (ray.whole[39] - 0.5).abs() < 0.05);
        assert!((ray.whole[29] - 0.25).abs() < 0.02, "{}", ray.whole[29]);
        assert!(ray.elfes[19] > 0.9 && (ray.elfes[39] - 0.5).abs() < 1e-5);
    }

    #[test]
    fn one_minimum_is_the_same_for_both_only_if_it_is_narrow() {
        let widest = |ray: &Ray| {
            let off = ray.elfes.iter().zip(&ray.whole).map(|(a, b)| (a - b).abs());
            off.fold(0.0, f64::max)
        };
        assert!(widest(&ray(&[20.0], 16.0)) < 0.05);
        assert!(widest(&ray(&[20.0], 0.4)) > 0.1);
    }
}
