use evigrid_core::Pose;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use rayon::prelude::*;
use serde::Deserialize;

use crate::number::{Count, Finite, NonNegative, Positive, plain};
use crate::random::{Sensor, normal, stream};
use crate::scene::{Ray, Scene};
use crate::{SynthError, angle};

/// A laser scanner as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LaserSpec {
    /// Beams stacked at even elevations that turn all around.
    Rotating(RotatingSpec),
}

/// A rotating scanner, e.g. like a Velodyne HDL-64.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotatingSpec {
    /// Number of beams.
    beams: Count,
    /// Elevation of the highest beam.
    top_deg: Finite,
    /// Elevation of the lowest beam.
    bottom_deg: Finite,
    /// Angle between two shots of a beam.
    azimuth_step_deg: Positive,
    /// Surfaces beyond this range give no point, metres.
    range_m: Positive,
    /// Standard deviation of the measured range, metres.
    range_noise_m: NonNegative,
    /// The scanner in the body frame, metres.
    mount_m: [Finite; 3],
    /// How far the scanner looks down.
    #[serde(default = "level")]
    tilt_deg: Finite,
}

fn level() -> Finite {
    Finite(0.0)
}

/// No more shots per sweep than this, to bound the memory.
const MAX_SHOTS: usize = 10_000_000;

/// A laser scanner with the directions of all its shots.
#[derive(Debug, Clone)]
pub struct Laser {
    /// Sine and cosine of the elevation of each beam.
    elevations: Vec<(f64, f64)>,
    /// Sine and cosine of each azimuth, anticlockwise from straight ahead.
    azimuths: Vec<(f64, f64)>,
    range_m: f64,
    range_noise_m: f64,
    body_from_laser: Pose,
}

impl Laser {
    /// The scanner that `spec` describes.
    ///
    /// # Errors
    /// If its elevations are not in order within -90..90 degrees, or a sweep has too many shots.
    pub fn new(LaserSpec::Rotating(spec): &LaserSpec) -> Result<Self, SynthError> {
        let (top, bottom) = (spec.top_deg.0, spec.bottom_deg.0);
        if !(-90.0 <= bottom && bottom <= top && top <= 90.0) {
            let found = format!("{bottom} and {top}");
            let expected = "-90 <= bottom <= top <= 90";
            return Err(SynthError::value("laser.rotating.bottom_deg and top_deg", expected, found));
        }
        let shots = 360.0 / spec.azimuth_step_deg.0;
        if shots < 1.0 || shots * f64::from(spec.beams.0) > MAX_SHOTS as f64 {
            let found = format!("{shots} per beam");
            let expected = "1 shot per turn to 10 million in all";
            return Err(SynthError::value("laser.rotating.azimuth_step_deg and beams", expected, found));
        }
        let beams = spec.beams.get();
        let spacing = if beams > 1 { (top - bottom) / (beams - 1) as f64 } else { 0.0 };
        // Rounded, so that 360 / 0.4 gives 900 shots although 0.4 is no binary fraction.
        let shots = (shots + 1e-6) as usize;
        let mount = Translation3::from(Vector3::from(plain(spec.mount_m)));
        Ok(Self {
            elevations: (0..beams).map(|i| angle::sin_cos_deg(top - spacing * i as f64)).collect(),
            azimuths: (0..shots).map(|i| angle::sin_cos_deg(spec.azimuth_step_deg.0 * i as f64)).collect(),
            range_m: spec.range_m.0,
            range_noise_m: spec.range_noise_m.0,
            body_from_laser: Isometry3::from_parts(mount, angle::tilt_down(spec.tilt_deg.0)),
        })
    }

    /// Pose of the scanner on the body.
    pub fn body_from_laser(&self) -> &Pose {
        &self.body_from_laser
    }

    /// One sweep from a standing scanner: the points that gave an echo in the scanner's frame (x forward, y left,
    /// z up, metres), beam by beam from the highest, each from straight ahead to the left and around.
    pub fn sweep(&self, scene: &Scene, world_from_laser: &Pose, seed: u64, frame: usize) -> Vec<[f32; 3]> {
        let beams: Vec<Vec<[f32; 3]>> = (0..self.elevations.len())
            .into_par_iter()
            .map(|beam| self.beam(scene, world_from_laser, beam, (seed, frame)))
            .collect();
        beams.concat()
    }

    fn beam(&self, scene: &Scene, pose: &Pose, beam: usize, (seed, frame): (u64, usize)) -> Vec<[f32; 3]> {
        let mut rng = stream(seed, frame, Sensor::Laser, beam);
        let (sin_e, cos_e) = self.elevations[beam];
        let origin: Point3<f64> = pose.translation.vector.into();
        let shoot = |&(sin_a, cos_a): &(f64, f64)| {
            // Drawn for every shot, so that an echo more or less does not change the noise of the others.
            let error_m = self.range_noise_m * normal(&mut rng);
            let direction = Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
            let ray = Ray { origin, direction: pose.rotation * direction };
            let measured_m = scene.cast(&ray, self.range_m)?.range_m + error_m;
            (measured_m > 0.0).then(|| {
                let point = direction * measured_m;
                [point.x as f32, point.y as f32, point.z as f32]
            })
        };
        self.azimuths.iter().filter_map(shoot).collect()
    }
}
