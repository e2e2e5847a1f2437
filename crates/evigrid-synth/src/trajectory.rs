//! Smooth drives and flights through way-points.

use evigrid_core::Pose;
use nalgebra::{Isometry3, Translation3, Vector3};
use serde::Deserialize;

use crate::number::{Finite, NonNegative, Positive};
use crate::{SynthError, angle};

/// A drive or flight as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectorySpec {
    /// Where the body passes, in order.
    pub waypoints: Vec<WaypointSpec>,
    /// A point (x, y) that the body's front always turns to, metres; without it the body looks where it goes.
    pub look_at_m: Option<[Finite; 2]>,
}

/// A point that is passed.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaypointSpec {
    /// On the ground (x, y) or in the air (x, y, z), metres.
    at_m: Place,
    /// Speed from here on, metres per second; as before if it is not given.
    speed_mps: Option<Positive>,
    /// How long the body stands here, seconds.
    #[serde(default)]
    pause_s: NonNegative,
    /// How far the left side is up here; in between the angle changes smoothly.
    #[serde(default)]
    roll_deg: Finite,
    /// How far the front is up here; in between the angle changes smoothly.
    #[serde(default)]
    pitch_deg: Finite,
}

/// Two or three coordinates.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct Place {
    position: Vector3<f64>,
    is_in_the_air: bool,
}

impl TryFrom<Vec<f64>> for Place {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        for &value in &values {
            Finite::try_from(value)?;
        }
        match values[..] {
            [x, y] => Ok(Self { position: Vector3::new(x, y, 0.0), is_in_the_air: false }),
            [x, y, z] => Ok(Self { position: Vector3::new(x, y, z), is_in_the_air: true }),
            _ => Err(format!("expected two or three coordinates, found {}", values.len())),
        }
    }
}

/// Pieces that a curve between two way-points is cut into to measure its length.
const PIECES: usize = 64;

/// No more way-points than this, to bound the memory.
const MAX_WAYPOINTS: usize = 10_000;

/// A smooth curve through way-points: cubic Hermite pieces with the tangents of a Catmull-Rom spline,
/// measured by arc length, and when each place of it is passed. Speeds change at way-points at once.
#[derive(Debug, Clone)]
pub struct Path {
    points: Vec<Vector3<f64>>,
    /// Unit-speed tangent at each way-point.
    tangents: Vec<Vector3<f64>>,
    /// Roll and pitch at each way-point, degrees.
    attitudes: Vec<[f64; 2]>,
    /// Arc length at the ends of all pieces, metres; starts with 0.
    lengths: Vec<f64>,
    /// Stretches of one speed, in order of time.
    stretches: Vec<Stretch>,
    duration_s: f64,
    look_at: Option<[f64; 2]>,
    is_in_the_air: bool,
}

#[derive(Debug, Clone, Copy)]
struct Stretch {
    start_s: f64,
    start_m: f64,
    end_m: f64,
    speed_mps: f64,
}

impl Path {
    /// The curve that `spec` describes; `key` names it in messages.
    ///
    /// # Errors
    /// If there are none or far too many way-points, two lie closer than 1 mm, the path turns by 90 degrees
    /// or more at one of them (it could not be smooth), or the speed is not known from the first one on.
    pub fn new(spec: &TrajectorySpec, key: &str) -> Result<Self, SynthError> {
        let waypoints = &spec.waypoints;
        let error = |expected, found| SynthError::value(key, expected, found);
        if !(1..=MAX_WAYPOINTS).contains(&waypoints.len()) {
            return Err(error("1 to 10000 way-points", waypoints.len().to_string()));
        }
        let points: Vec<Vector3<f64>> = waypoints.iter().map(|w| w.at_m.position).collect();
        let steps: Vec<Vector3<f64>> = points.windows(2).map(|w| w[1] - w[0]).collect();
        // The heading comes from the level part.
        if let Some(i) = steps.iter().position(|s| s.xy().norm() < 1e-3) {
            let found = format!("way-points {i} and {} in one place seen from above", i + 1);
            return Err(error("way-points at least 1 mm apart", found));
        }
        if let Some(i) = steps.windows(2).position(|w| w[0].xy().dot(&w[1].xy()) <= 0.0) {
            return Err(error(
                "turns of less than 90 degrees",
                format!("a sharper one at way-point {}", i + 1),
            ));
        }
        if !steps.is_empty() && waypoints[0].speed_mps.is_none() {
            return Err(error("a speed_mps at the first way-point", "none".to_owned()));
        }
        let mut path = Self {
            tangents: tangents(&steps),
            attitudes: waypoints.iter().map(|w| [w.roll_deg.0, w.pitch_deg.0]).collect(),
            lengths: Vec::new(),
            stretches: Vec::new(),
            duration_s: 0.0,
            look_at: spec.look_at_m.map(|p| p.map(|v| v.0)),
            is_in_the_air: waypoints.iter().any(|w| w.at_m.is_in_the_air),
            points,
        };
        path.lengths = path.measure();
        path.schedule(waypoints);
        Ok(path)
    }

    /// How long the whole way takes, seconds.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Whether any way-point has a height of its own.
    pub fn is_in_the_air(&self) -> bool {
        self.is_in_the_air
    }

    /// Arc length from the start at this time, metres.
    pub fn distance_m(&self, time_s: f64) -> f64 {
        let stretch = self.stretch(time_s);
        (stretch.start_m + stretch.speed_mps * (time_s - stretch.start_s).max(0.0)).min(stretch.end_m)
    }

    /// Pose of the body at this time; before the start and after the end, there.
    pub fn world_from_body(&self, time_s: f64) -> Pose {
        let (segment, t) = self.locate(self.distance_m(time_s));
        let (position, derivative) = self.evaluate(segment, t);
        let heading = match self.look_at {
            Some([x, y]) => Vector3::new(x - position.x, y - position.y, 0.0),
            None => derivative,
        };
        let level = heading.xy().norm();
        let heading = if level < 1e-9 { [1.0, 0.0] } else { [heading.x / level, heading.y / level] };
        let next = (segment + 1).min(self.attitudes.len() - 1);
        let blend = t * t * (3.0 - 2.0 * t);
        let [roll, pitch] = [0, 1].map(|i| {
            let (a, b) = (self.attitudes[segment][i], self.attitudes[next][i]);
            a + blend * (b - a)
        });
        let rotation = angle::heading(heading) * angle::attitude(0.0, pitch, roll);
        Isometry3::from_parts(Translation3::from(position), rotation)
    }

    /// Velocity of the body at this time, metres per second.
    pub fn velocity_mps(&self, time_s: f64) -> Vector3<f64> {
        if !(0.0..self.duration_s).contains(&time_s) {
            return Vector3::zeros();
        }
        let (segment, t) = self.locate(self.distance_m(time_s));
        let (_, derivative) = self.evaluate(segment, t);
        derivative.normalize() * self.stretch(time_s).speed_mps
    }

    fn stretch(&self, time_s: f64) -> &Stretch {
        let after = self.stretches.partition_point(|s| s.start_s <= time_s);
        &self.stretches[after.max(1) - 1]
    }

    /// The segment and the place in it, 0..=1, at this arc length.
    fn locate(&self, distance_m: f64) -> (usize, f64) {
        if self.points.len() == 1 {
            return (0, 0.0);
        }
        let after = self.lengths.partition_point(|&l| l <= distance_m).clamp(1, self.lengths.len() - 1);
        let (from, to) = (self.lengths[after - 1], self.lengths[after]);
        let piece = (after - 1) as f64 + ((distance_m - from) / (to - from)).clamp(0.0, 1.0);
        let segment = (after - 1) / PIECES;
        (segment, piece / PIECES as f64 - segment as f64)
    }

    /// Arc lengths by summing chords of short pieces.
    fn measure(&self) -> Vec<f64> {
        let mut lengths = vec![0.0];
        let mut length = 0.0;
        let mut last = self.points[0];
        for segment in 0..self.points.len() - 1 {
            for piece in 1..=PIECES {
                let (next, _) = self.evaluate(segment, piece as f64 / PIECES as f64);
                length += (next - last).norm();
                lengths.push(length);
                last = next;
            }
        }
        lengths
    }

    fn schedule(&mut self, waypoints: &[WaypointSpec]) {
        let (mut time_s, mut speed_mps) = (0.0, 0.0);
        for (i, waypoint) in waypoints.iter().enumerate() {
            let start_m = self.lengths[i * PIECES];
            let pause_s = waypoint.pause_s.0;
            if pause_s > 0.0 || waypoints.len() == 1 {
                self.stretches.push(Stretch { start_s: time_s, start_m, end_m: start_m, speed_mps: 0.0 });
                time_s += pause_s;
            }
            speed_mps = waypoint.speed_mps.map_or(speed_mps, |s| s.0);
            if let Some(&end_m) = self.lengths.get((i + 1) * PIECES) {
                self.stretches.push(Stretch { start_s: time_s, start_m, end_m, speed_mps });
                time_s += (end_m - start_m) / speed_mps;
            }
        }
        self.duration_s = time_s;
    }

    /// Position and derivative at `t` in 0..=1 of a segment.
    fn evaluate(&self, segment: usize, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        let a = self.points[segment];
        let Some(b) = self.points.get(segment + 1) else { return (a, Vector3::x()) };
        let (start, end) = (self.tangents[segment], self.tangents[segment + 1]);
        let step = b - a;
        let chord = step.norm();
        let rise = t * t * (3.0 - 2.0 * t);
        let [slope_start, slope_end] = [t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0)];
        let position = a + step * rise + (start * slope_start + end * slope_end) * chord;
        let derivative = step * (6.0 * t * (1.0 - t))
            + (start * ((1.0 - t) * (1.0 - 3.0 * t)) + end * (t * (3.0 * t - 2.0))) * chord;
        (position, derivative)
    }
}

/// Tangents from the steps between way-points: the directions of the adjacent steps, each weighted
/// by the length of the other. With turns below 90 degrees they never vanish, nor does the
/// derivative anywhere on the curve.
fn tangents(steps: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let between = steps.windows(2).map(|w| {
        let (before, after) = (w[0].norm(), w[1].norm());
        (w[0] * (after / before) + w[1] * (before / after)) / (before + after)
    });
    let ends = |s: Option<&Vector3<f64>>| s.map(|s| s / s.norm()).into_iter();
    ends(steps.first()).chain(between).chain(ends(steps.last())).collect()
}

#[cfg(test)]
#[path = "trajectory_tests.rs"]
mod tests;
