//! Fig. 4: occupancy along one ray of a real image: Elfes, the whole curve with a model of free
//! space (eq. 6), and without (eq. 9).

use anyhow::{Context, Result};
use evigrid_core::{CostVolume, Frame, NO_COST, Pose};
use evigrid_cost_curve::{CostExponent, CostUnit, free_space_costs, pixel_variance};
use evigrid_replay::Sequence;
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};
use evigrid_synth::{SyntheticSequence, World};
use rayon::prelude::*;

use super::ray::Ray;
use crate::chart::{Axis, BLUE, Corner, DARK, GREEN, Marks, ORANGE, Panel, Series, Sheet};
use crate::drive;
use crate::job::Job;
use crate::table::{cell, rounded};

/// The two minima are at least so far apart, pixels, and differ by at most this share of the
/// height of the ridge between them.
const APART_PX: usize = 8;
const DIFFER: f64 = 0.02;

const UNITS: [(&str, CostUnit); 3] = [
    ("grey levels", CostUnit::GreyLevels),
    ("homogeneous", CostUnit::Homogeneous),
    ("intensities in 0..1", CostUnit::UnitIntensities),
];

/// A pixel with its cost curve.
struct Chosen {
    frame: Frame,
    volume: CostVolume,
    at: (usize, usize),
    variance: f64,
    free: Option<evigrid_cost_curve::FreeSpaceCosts>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let (name, sequence) = open(job)?;
    let chosen = Chosen::new(sequence.as_ref())?;
    let (x, y) = chosen.at;
    job.say(&format!("pixel ({x}, {y}) of the first frame of {name}"));
    let rays: Vec<(&str, Ray)> = UNITS.iter().map(|(unit, u)| (*unit, chosen.ray(*u))).collect();
    let header = [
        "unit",
        "hypothesis",
        "disparity_px",
        "depth_m",
        "cost",
        "likelihood",
        "free_space_likelihood",
        "elfes",
        "whole_curve_eq6",
        "whole_curve_eq9",
    ];
    let rows = rays.iter().flat_map(|(unit, ray)| {
        let chosen = &chosen;
        (0..ray.costs.len()).map(move |i| chosen.row(unit, ray, i))
    });
    job.write_table(&header, rows)?;
    job.write_picture(&chosen.picture(&name, &rays))
}

/// Middlebury Cones, else a drive, else the world `bars`.
fn open(job: &Job<'_, '_>) -> Result<(String, Box<dyn Sequence>)> {
    if let Some((known, dir)) = job.dataset("middlebury-cones")? {
        return Ok((known.id, evigrid_replay::open(&dir)?));
    }
    if let Some(drive) = drive::find(job)? {
        let sequence = evigrid_replay::open(&drive.dir)?;
        return Ok((sequence.info().id.clone(), sequence));
    }
    Ok(("synth:bars".into(), Box::new(SyntheticSequence::new(World::builtin("bars")?))))
}

impl Chosen {
    fn new(sequence: &dyn Sequence) -> Result<Self> {
        let frame = sequence.frame(0, &Pose::identity())?;
        // Cones has disparities up to 55 px.
        let disparities = if frame.rig().width < 600 { 64 } else { 128 };
        let settings = BlockMatchingSettings { disparities, ..BlockMatchingSettings::default() };
        let matching = BlockMatcher::new(settings)?.run(frame.left(), frame.right(), true, None)?;
        let volume = matching.volume.context("no costs were kept")?;
        let winners = &matching.matches.disparity;
        let at = ambiguous_pixel(&volume).context("no pixel has two minima that are nearly equal")?;
        let variance = pixel_variance(frame.left(), frame.right(), winners);
        let free = free_space_costs(&volume, winners);
        Ok(Self { frame, volume, at, variance, free })
    }

    /// Hypotheses from the nearest (largest disparity) on.
    fn ray(&self, unit: CostUnit) -> Ray {
        let mut costs: Vec<f64> = self.volume.curve(self.at.0, self.at.1).map(f64::from).collect();
        costs.reverse();
        Ray::new(costs, CostExponent::new(unit, self.variance, 49.0), self.free)
    }

    fn disparity(&self, i: usize) -> usize {
        self.volume.min_disparity() + self.volume.disparities() - 1 - i
    }

    fn row(&self, unit: &str, ray: &Ray, i: usize) -> [String; 10] {
        let d = self.disparity(i);
        let (free, eq6) = ray.free_space.as_ref().map_or((f64::NAN, f64::NAN), |(f, p)| (f[i], p[i]));
        let of = |value: f64| rounded(value, 9);
        [
            unit.to_owned(),
            i.to_string(),
            d.to_string(),
            rounded(self.frame.rig().depth_m(d as f64), 4),
            cell(ray.costs[i]),
            of(ray.likelihood[i]),
            of(free),
            of(ray.elfes[i]),
            of(eq6),
            of(ray.whole[i]),
        ]
    }

    fn picture(&self, name: &str, rays: &[(&str, Ray)]) -> Sheet {
        let points = |values: &[f64]| -> Vec<(f64, f64)> {
            values.iter().enumerate().map(|(i, &v)| (i as f64, v)).collect()
        };
        let count = self.volume.disparities() as f64;
        let x = || Axis::new("hypothesis, from the nearest (largest disparity) on", 0.0, count);
        let costs = &rays[0].1.costs;
        let highest = costs.iter().copied().fold(0.0, f64::max);
        let mut panels = vec![Panel {
            title: "the costs that go in".into(),
            x: x(),
            y: Axis::new("SAD (grey levels)", 0.0, 1.05 * highest),
            series: vec![Series::new("", DARK, Marks::Line(points(costs)))],
            legend: None,
        }];
        for (unit, ray) in rays {
            let mut series = vec![Series::new("Elfes", ORANGE, Marks::Line(points(&ray.elfes)))];
            if let Some((_, eq6)) = &ray.free_space {
                series.push(Series::new("whole curve, eq. 6", GREEN, Marks::Line(points(eq6))));
            }
            series.push(Series::new("whole curve, eq. 9", BLUE, Marks::Line(points(&ray.whole))));
            panels.push(Panel {
                title: format!("eq. 7 in the unit {unit}"),
                x: x(),
                y: Axis::new("P(occupied)", 0.0, 1.05),
                series,
                legend: Some(Corner::UpperLeft),
            });
        }
        let (column, row) = self.at;
        let apart = rays.iter().map(|(unit, ray)| format!("{unit} {:.2}", apart(ray)));
        Sheet {
            title: format!("Fig. 4: occupancy along the ray of pixel ({column}, {row}) of {name}"),
            notes: vec![
                "the pixel whose two lowest, nearly equal minima stand out most; eq. 6 models the costs of \
                 free space, eq. 9 does not"
                    .into(),
                format!(
                    "the paper: eqs 6 and 9 \"similar\"; largest difference here: {}",
                    apart.collect::<Vec<_>>().join(", ")
                ),
            ],
            columns: 2,
            panel: (560, 300),
            panels,
        }
    }
}

/// How far the profiles of eqs 6 and 9 are apart at most.
fn apart(ray: &Ray) -> f64 {
    let Some((_, eq6)) = &ray.free_space else { return f64::NAN };
    eq6.iter().zip(&ray.whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Of the pixels whose curve is complete and whose two lowest minima are nearly equal and well apart, the one
/// where they lie lowest below the rest; of equals the first, row by row.
fn ambiguous_pixel(volume: &CostVolume) -> Option<(usize, usize)> {
    let best_of_row = |y: usize| {
        let scores = (0..volume.width()).filter_map(|x| {
            let curve: Vec<u16> = volume.curve(x, y).collect();
            Some((salience(&curve)?, x, y))
        });
        scores.reduce(|best, next| if next.0 > best.0 { next } else { best })
    };
    let rows: Vec<_> = (0..volume.height()).into_par_iter().filter_map(best_of_row).collect();
    let best = rows.into_iter().reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map(|(_, x, y)| (x, y))
}

/// How far the second lowest minimum lies below both the median cost and the ridge between it and the lowest;
/// `None` if the two are not nearly equal.
fn salience(curve: &[u16]) -> Option<f64> {
    if curve.contains(&NO_COST) {
        return None;
    }
    let mut sorted = curve.to_vec();
    sorted.sort_unstable();
    let (lowest, median) = (sorted[0], sorted[sorted.len() / 2]);
    let minima = (1..curve.len() - 1).filter(|&i| curve[i] < curve[i - 1] && curve[i] <= curve[i + 1]);
    let minima: Vec<usize> = minima.collect();
    let at = minima.iter().copied().find(|&i| curve[i] == lowest)?;
    let other = minima.into_iter().filter(|&i| i != at).min_by_key(|&i| curve[i])?;
    let ridge = *curve[at.min(other)..at.max(other)].iter().max()?;
    let (second, height) = (curve[other], ridge.min(median));
    let nearly_equal = f64::from(second - lowest) <= DIFFER * f64::from(height);
    let is_ridge = height > second && other.abs_diff(at) >= APART_PX;
    (nearly_equal && is_ridge).then(|| f64::from(height - second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::CostScale;

    const SCALE: CostScale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };

    #[test]
    fn the_chosen_pixel_has_two_low_minima_with_a_ridge_between() {
        let flat = vec![500_u16; 32];
        let with = |minima: &[(usize, u16)]| {
            let mut curve = flat.clone();
            minima.iter().for_each(|&(i, cost)| curve[i] = cost);
            curve
        };
        assert_eq!(salience(&with(&[(5, 100), (20, 105)])), Some(395.0));
        assert_eq!(salience(&with(&[(5, 100), (20, 120)])), None, "not equal");
        assert_eq!(salience(&with(&[(5, 100), (9, 105)])), None, "too near");
        assert_eq!(salience(&with(&[(5, 100), (20, 105), (30, NO_COST)])), None, "not complete");
        let mut plateau = with(&[]);
        plateau[5..=20].fill(106);
        (plateau[5], plateau[20]) = (100, 101);
        assert_eq!(salience(&plateau), Some(5.0), "a low ridge");
        // Three pixels in a row, the second the most salient.
        let curves =
            [with(&[(5, 300), (20, 300)]), with(&[(5, 100), (20, 100)]), with(&[(5, 200), (20, 200)])];
        let costs = (0..32).flat_map(|d| curves.iter().map(move |c| c[d])).collect();
        let volume = CostVolume::new(3, 1, 0, 32, SCALE, costs).unwrap();
        assert_eq!(ambiguous_pixel(&volume), Some((1, 0)));
    }
}
