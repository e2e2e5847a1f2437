//! The inverse sensor model along a ray, with the camera of Andert's Fig. 1.

use anyhow::{Result, bail};
use evigrid_inverse_model::{ANDERT_RIG, Measurement, NearPixels, Obstacle, SensorModel};

use crate::chart::{Axis, BLUE, Corner, GREEN, GREY, Marks, ORANGE, Panel, Series};

pub const MEASURED_M: [f64; 3] = [10.0, 20.0, 40.0];
/// Samples of l, and how many lie in a metre.
const SAMPLES: u32 = 1200;
const PER_METRE: f64 = 20.0;

/// A measurement on the optical axis.
#[derive(Debug, Clone, Copy)]
pub struct Profile {
    pub motion_error_m: f64,
    pub measured_m: f64,
    pub obstacle: Obstacle,
}

/// The numbers that a profile is known by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmarks {
    /// P at the measured range, and far in front of it.
    pub peak_p: f64,
    pub free_p: f64,
    /// Where P = 0.5 before the measurement, metres.
    pub crossing_m: f64,
}

impl Profile {
    /// The profiles of the three measured ranges under an error of motion.
    pub fn all(motion_error_m: f64) -> Result<Vec<Self>> {
        let model = SensorModel {
            k: 0.1,
            min_probability: 0.35,
            disparity_error_px: 0.5,
            motion_error_m,
            near: NearPixels::Reject,
            max_peak: 0.5,
            max_depth_m: 60.0,
        };
        let profile = |measured_m: f64| {
            let axis = (ANDERT_RIG.centre_x_px, ANDERT_RIG.centre_y_px);
            match model.measure(&ANDERT_RIG, axis, ANDERT_RIG.disparity_px(measured_m)) {
                Some(Measurement::Obstacle(obstacle)) => Ok(Self { motion_error_m, measured_m, obstacle }),
                other => bail!("{measured_m} m measure as {other:?}"),
            }
        };
        MEASURED_M.into_iter().map(profile).collect()
    }

    /// Ranges with P and log-odds.
    pub fn samples(&self) -> impl Iterator<Item = [f64; 3]> + use<> {
        let obstacle = self.obstacle;
        let ranges = (1..=SAMPLES).map(|n| f64::from(n) / PER_METRE);
        ranges.map(move |l| [l, obstacle.probability(l), obstacle.log_odds(l)])
    }

    pub fn landmarks(&self) -> Landmarks {
        let obstacle = &self.obstacle;
        // P rises up to the measurement: halving finds where it passes 0.5.
        let mut between = [0.0, obstacle.range_m];
        for _ in 0..80 {
            let middle = 0.5 * (between[0] + between[1]);
            between[usize::from(obstacle.probability(middle) >= 0.5)] = middle;
        }
        Landmarks {
            peak_p: obstacle.probability(obstacle.range_m),
            free_p: obstacle.probability(1e-3),
            crossing_m: between[1],
        }
    }
}

/// P over l of three measured ranges.
pub fn panel(title: &str, profiles: &[Profile]) -> Panel {
    let end = f64::from(SAMPLES) / PER_METRE;
    let mut series = vec![Series::new("", GREY, Marks::Line(vec![(0.0, 0.5), (end, 0.5)]))];
    for (profile, colour) in profiles.iter().zip([BLUE, GREEN, ORANGE]) {
        let points = profile.samples().map(|[l, p, _]| (l, p)).collect();
        series.push(Series::new(format!("{} m measured", profile.measured_m), colour, Marks::Line(points)));
    }
    Panel {
        title: title.to_owned(),
        x: Axis::new("distance l along the ray (m)", 0.0, end),
        y: Axis::new("P(occupied)", 0.3, 0.7),
        series,
        legend: Some(Corner::UpperRight),
    }
}
