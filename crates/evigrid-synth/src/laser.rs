//! Simulated laser scanners.

use evigrid_core::Pose;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use rayon::prelude::*;
use serde::Deserialize;

use crate::number::{Count, Finite, NonNegative, Positive, Share, vector};
use crate::random::{Sensor, normal, stream};
use crate::ray::Ray;
use crate::scene::{Hint, Scene};
use crate::{SynthError, angle};

/// A laser scanner as a world describes it: a planar one has one beam, others several at even elevations; it
/// turns all around or over an opening angle about straight ahead, from right to left.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaserSpec {
    /// Number of beams.
    beams: Count,
    /// Elevation of the highest beam.
    #[serde(default)]
    top_deg: Finite,
    /// Elevation of the lowest beam.
    #[serde(default)]
    bottom_deg: Finite,
    /// The angle that is swept.
    #[serde(default = "full_turn")]
    opening_deg: Positive,
    /// Angle between two shots of a beam.
    step_deg: Positive,
    /// Surfaces beyond this range give no point, metres.
    range_m: Positive,
    /// Standard deviation of the measured range, metres.
    #[serde(default)]
    range_noise_m: NonNegative,
    /// Share of the shots that give no point although there is a surface.
    #[serde(default)]
    drop_out: Share,
    /// Turns per second, and scans per second where frames come faster; as many as frames if it is not given.
    rate_hz: Option<Positive>,
    /// The scanner in the body frame, metres.
    mount_m: [Finite; 3],
    /// How far the scanner is turned to the left.
    #[serde(default)]
    yaw_deg: Finite,
    /// How far the scanner looks down.
    #[serde(default)]
    tilt_deg: Finite,
    /// How far the scanner's left side is up; at 90 a planar scanner sweeps upright.
    #[serde(default)]
    roll_deg: Finite,
}

fn full_turn() -> Positive {
    Positive(360.0)
}

/// No more shots per sweep than this, to bound the memory.
const MAX_SHOTS: f64 = 1e7;

/// A laser scanner with the directions of all its shots.
#[derive(Debug, Clone)]
pub struct Laser {
    /// Sine and cosine of the elevation of each beam.
    elevations: Vec<(f64, f64)>,
    /// The azimuths in the order in which they are shot.
    azimuths: Vec<Azimuth>,
    range_m: f64,
    range_noise_m: f64,
    drop_out: f64,
    rate_hz: f64,
    body_from_laser: Pose,
}

/// One angle of the turn, anticlockwise from straight ahead.
#[derive(Debug, Clone, Copy)]
struct Azimuth {
    sin: f64,
    cos: f64,
    /// When it is shot, seconds after the scanner looks straight ahead.
    delay_s: f64,
}

/// The points that a sweep measured, in the frame that the scanner has when it looks straight
/// ahead: x forward, y left, z up, metres.
#[derive(Debug, Clone, Default)]
pub struct Sweep {
    /// Where the shots met a surface.
    pub points: Vec<[f32; 3]>,
    /// Where the scanner was when it shot them.
    pub origins: Vec<[f32; 3]>,
}

impl Sweep {
    /// Adds another sweep, whose frame has this pose in the frame of this one.
    pub fn extend(&mut self, other: Self, self_from_other: &Pose) {
        if *self_from_other == Pose::identity() {
            self.points.extend(other.points);
            self.origins.extend(other.origins);
            return;
        }
        let moved = |p: [f32; 3]| {
            let p = self_from_other * Point3::from(p.map(f64::from));
            [p.x as f32, p.y as f32, p.z as f32]
        };
        self.points.extend(other.points.into_iter().map(moved));
        self.origins.extend(other.origins.into_iter().map(moved));
    }
}

/// Where a sweep happens.
pub struct Place<'a> {
    /// The world, standing still as it is at the frame's time.
    pub scene: &'a Scene,
    /// Pose of the body so many seconds after the frame's time.
    pub world_from_body: &'a (dyn Fn(f64) -> Pose + Sync),
    /// The world's seed, the frame and the number of the scanner.
    pub seed: u64,
    pub frame: usize,
    pub scanner: usize,
}

impl Laser {
    /// The scanner that `spec` describes; `key` names it in messages.
    ///
    /// # Errors
    /// If its elevations are not in order within -90..90 degrees, its opening exceeds a full turn, or a sweep
    /// has too many shots.
    pub fn new(spec: &LaserSpec, frame_rate_hz: f64, key: &str) -> Result<Self, SynthError> {
        let (top, bottom, opening) = (spec.top_deg.0, spec.bottom_deg.0, spec.opening_deg.0);
        if !(-90.0 <= bottom && bottom <= top && top <= 90.0) {
            let key = format!("{key}.bottom_deg and top_deg");
            return Err(SynthError::value(key, "-90 <= bottom <= top <= 90", format!("{bottom} and {top}")));
        }
        if opening > 360.0 {
            return Err(SynthError::value(format!("{key}.opening_deg"), "at most 360", opening));
        }
        // Rounded, so that 360 / 0.4 gives 900 shots although 0.4 is no binary fraction. A full turn ends one
        // step before where it began; an opening has a shot at either end.
        let steps = opening / spec.step_deg.0 + 1e-6;
        let shots = if opening == 360.0 { steps } else { steps + 1.0 };
        if shots < 1.0 || shots * f64::from(spec.beams.0) > MAX_SHOTS {
            let key = format!("{key}.step_deg and beams");
            let expected = "1 shot per beam to 10 million in all";
            return Err(SynthError::value(key, expected, format!("{} per beam", shots.floor())));
        }
        let rate_hz = spec.rate_hz.map_or(frame_rate_hz, |r| r.0);
        let beams = spec.beams.get();
        let spacing = if beams > 1 { (top - bottom) / (beams - 1) as f64 } else { 0.0 };
        let azimuth = |i: usize| {
            let degrees = spec.step_deg.0 * i as f64 - 0.5 * opening;
            let (sin, cos) = angle::sin_cos_deg(degrees);
            Azimuth { sin, cos, delay_s: degrees / 360.0 / rate_hz }
        };
        let rotation = angle::attitude(spec.yaw_deg.0, -spec.tilt_deg.0, spec.roll_deg.0);
        Ok(Self {
            elevations: (0..beams).map(|i| angle::sin_cos_deg(top - spacing * i as f64)).collect(),
            azimuths: (0..shots as usize).map(azimuth).collect(),
            range_m: spec.range_m.0,
            range_noise_m: spec.range_noise_m.0,
            drop_out: spec.drop_out.0,
            rate_hz,
            body_from_laser: Isometry3::from_parts(Translation3::from(vector(spec.mount_m)), rotation),
        })
    }

    /// Pose of the scanner on the body.
    pub fn body_from_laser(&self) -> &Pose {
        &self.body_from_laser
    }

    /// Whether there is a scan at a frame, given its time and that of the frame before.
    pub fn is_due(&self, time_s: f64, time_before_s: Option<f64>) -> bool {
        let turns = |time_s: f64| (time_s * self.rate_hz + 1e-6).floor();
        time_before_s.is_none_or(|before| turns(time_s) > turns(before))
    }

    /// One sweep: the points that gave an echo, beam by beam from the highest, each from right to
    /// left. Every shot starts where the moving scanner is at its time; the scanner looks
    /// straight ahead at the frame's time.
    pub fn sweep(&self, place: &Place<'_>) -> Sweep {
        let body = (place.world_from_body)(0.0);
        let world_from_reference = body * self.body_from_laser;
        let reference_from_world = world_from_reference.inverse();
        let pose = |azimuth: &Azimuth| match (place.world_from_body)(azimuth.delay_s) {
            // Free of rounding where the body stands.
            same if same == body => Pose::identity(),
            moved => reference_from_world * moved * self.body_from_laser,
        };
        let poses: Vec<Pose> = self.azimuths.iter().map(pose).collect();
        let beams: Vec<Sweep> = (0..self.elevations.len())
            .into_par_iter()
            .map(|beam| self.beam(place, &world_from_reference, &poses, beam))
            .collect();
        let mut sweep = Sweep::default();
        for beam in beams {
            sweep.points.extend(beam.points);
            sweep.origins.extend(beam.origins);
        }
        sweep
    }

    fn beam(&self, place: &Place<'_>, world_from_reference: &Pose, poses: &[Pose], beam: usize) -> Sweep {
        let mut rng = stream(place.seed, place.frame, Sensor::Laser(place.scanner), beam);
        let (sin_e, cos_e) = self.elevations[beam];
        let mut sweep = Sweep::default();
        let mut hint = Hint::default();
        for (azimuth, reference_from_laser) in self.azimuths.iter().zip(poses) {
            // Drawn for every shot, so that an echo more or less does not change the noise of the others.
            let error_m = self.range_noise_m * normal(&mut rng);
            let is_lost = unit(&mut rng) < self.drop_out;
            let direction =
                reference_from_laser.rotation * Vector3::new(cos_e * azimuth.cos, cos_e * azimuth.sin, sin_e);
            let origin: Point3<f64> = reference_from_laser.translation.vector.into();
            let ray = Ray {
                origin: world_from_reference * origin,
                direction: world_from_reference.rotation * direction,
            };
            let Some(hit) = place.scene.cast(&ray, self.range_m, &mut hint) else { continue };
            let measured_m = hit.range_m + error_m;
            if measured_m > 0.0 && !is_lost {
                let single = |v: Vector3<f64>| [v.x as f32, v.y as f32, v.z as f32];
                sweep.points.push(single(origin.coords + direction * measured_m));
                sweep.origins.push(single(origin.coords));
            }
        }
        sweep
    }
}

/// A uniform number in 0..1.
fn unit(rng: &mut ChaCha8Rng) -> f64 {
    f64::from(rng.next_u32()) / 4_294_967_296.0
}
