use nalgebra::{Isometry3, Translation3};
use serde::Deserialize;

use crate::number::{Finite, NonNegative};
use crate::{SynthError, angle};
use evigrid_core::Pose;

/// A drive over the ground as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectorySpec {
    /// Constant speed, metres per second.
    pub speed_mps: NonNegative,
    /// Points (x, y) on the ground that the body passes, metres.
    waypoints_m: Vec<[Finite; 2]>,
}

/// Pieces that a curve between two way-points is cut into to measure its length.
const PIECES: usize = 64;

/// No more way-points than this, to bound the memory.
const MAX_WAYPOINTS: usize = 10_000;

/// A smooth curve through way-points: cubic Hermite pieces with the tangents of a Catmull-Rom spline, measured by
/// arc length.
#[derive(Debug, Clone)]
pub struct Path {
    points: Vec<[f64; 2]>,
    /// Unit-speed tangent at each way-point.
    tangents: Vec<[f64; 2]>,
    /// Arc length at the ends of all pieces, metres; starts with 0.
    lengths: Vec<f64>,
}

impl Path {
    /// The curve through the way-points of `spec`.
    ///
    /// # Errors
    /// If there are fewer than two or far too many, two lie closer than 1 mm, or the path turns by 90 degrees or
    /// more at one of them (it could not be smooth).
    pub fn new(spec: &TrajectorySpec) -> Result<Self, SynthError> {
        let points: Vec<[f64; 2]> = spec.waypoints_m.iter().map(|p| p.map(|v| v.0)).collect();
        let error = |expected, found| SynthError::value("trajectory.waypoints_m", expected, found);
        if !(2..=MAX_WAYPOINTS).contains(&points.len()) {
            return Err(error("2 to 10000 way-points", points.len().to_string()));
        }
        let steps: Vec<[f64; 2]> = points.windows(2).map(|w| difference(w[1], w[0])).collect();
        if let Some(i) = steps.iter().position(|&s| norm(s) < 1e-3) {
            return Err(error(
                "way-points at least 1 mm apart",
                format!("way-points {i} and {} in one place", i + 1),
            ));
        }
        if let Some(i) = steps.windows(2).position(|w| dot(w[0], w[1]) <= 0.0) {
            return Err(error(
                "turns of less than 90 degrees",
                format!("a sharper one at way-point {}", i + 1),
            ));
        }
        let tangents = tangents(&steps);
        let mut path = Self { points, tangents, lengths: Vec::new() };
        path.lengths = path.measure();
        Ok(path)
    }

    /// Length of the whole curve, metres.
    pub fn length_m(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Pose of the body after it has driven `distance_m` along the curve; beyond the ends, at the ends.
    pub fn world_from_body(&self, distance_m: f64) -> Pose {
        let after = self.lengths.partition_point(|&l| l <= distance_m).clamp(1, self.lengths.len() - 1);
        let (from, to) = (self.lengths[after - 1], self.lengths[after]);
        let piece = (after - 1) as f64 + ((distance_m - from) / (to - from)).clamp(0.0, 1.0);
        let segment = (after - 1) / PIECES;
        let ([x, y], [dx, dy]) = self.evaluate(segment, piece / PIECES as f64 - segment as f64);
        let speed = norm([dx, dy]);
        Isometry3::from_parts(Translation3::new(x, y, 0.0), angle::heading([dx / speed, dy / speed]))
    }

    /// Arc lengths by summing chords of short pieces.
    fn measure(&self) -> Vec<f64> {
        let mut lengths = vec![0.0];
        let mut length = 0.0;
        let mut last = self.points[0];
        for segment in 0..self.points.len() - 1 {
            for piece in 1..=PIECES {
                let (next, _) = self.evaluate(segment, piece as f64 / PIECES as f64);
                length += norm(difference(next, last));
                lengths.push(length);
                last = next;
            }
        }
        lengths
    }

    /// Position and derivative at `t` in 0..=1 of a segment.
    fn evaluate(&self, segment: usize, t: f64) -> ([f64; 2], [f64; 2]) {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        let (start, end) = (self.tangents[segment], self.tangents[segment + 1]);
        let chord = norm(difference(b, a));
        let rise = t * t * (3.0 - 2.0 * t);
        let [slope_start, slope_end] = [t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0)];
        let position = [0, 1]
            .map(|i| a[i] + rise * (b[i] - a[i]) + chord * (slope_start * start[i] + slope_end * end[i]));
        let derivative = [0, 1].map(|i| {
            6.0 * t * (1.0 - t) * (b[i] - a[i])
                + chord * ((1.0 - t) * (1.0 - 3.0 * t) * start[i] + t * (3.0 * t - 2.0) * end[i])
        });
        (position, derivative)
    }
}

/// Tangents from the steps between way-points: the directions of the adjacent steps, each weighted by the length of
/// the other. With turns below 90 degrees they never vanish, nor does the derivative anywhere on the curve.
fn tangents(steps: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let unit = |s: [f64; 2]| s.map(|v| v / norm(s));
    let between = steps.windows(2).map(|w| {
        let (before, after) = (norm(w[0]), norm(w[1]));
        [0, 1].map(|i| (after * unit(w[0])[i] + before * unit(w[1])[i]) / (before + after))
    });
    let ends = |s: Option<&[f64; 2]>| s.map(|&s| unit(s)).into_iter();
    ends(steps.first()).chain(between).chain(ends(steps.last())).collect()
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn norm(v: [f64; 2]) -> f64 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn path(points: &[[f64; 2]]) -> Result<Path, SynthError> {
        let waypoints_m = points.iter().map(|p| p.map(Finite)).collect();
        Path::new(&TrajectorySpec { speed_mps: NonNegative(1.0), waypoints_m })
    }

    #[test]
    fn a_straight_path_is_driven_at_its_distance() {
        let path = path(&[[1.0, 2.0], [4.0, 6.0], [7.0, 10.0]]).unwrap();
        assert!((path.length_m() - 10.0).abs() < 1e-9);
        for distance in [0.0, 0.7, 5.0, 9.9, 10.0] {
            let pose = path.world_from_body(distance);
            let expected = Vector3::new(1.0 + 0.6 * distance, 2.0 + 0.8 * distance, 0.0);
            assert!((pose.translation.vector - expected).norm() < 1e-6, "{distance}");
            assert!((pose.rotation * Vector3::x() - Vector3::new(0.6, 0.8, 0.0)).norm() < 1e-9, "{distance}");
        }
    }

    #[test]
    fn a_bend_passes_its_way_points_with_even_speed_and_smooth_heading() {
        let path = path(&[[0.0, 0.0], [10.0, 0.0], [18.0, 6.0], [20.0, 15.0]]).unwrap();
        let step = 0.05;
        let poses: Vec<Pose> =
            (0..(path.length_m() / step) as usize).map(|i| path.world_from_body(i as f64 * step)).collect();
        for pair in poses.windows(2) {
            let moved = (pair[1].translation.vector - pair[0].translation.vector).norm();
            assert!((moved - step).abs() < 5e-3 * step, "{moved}");
            assert!(pair[0].rotation.angle_to(&pair[1].rotation) < 0.02);
        }
        let passes =
            |x, y| poses.iter().any(|p| (p.translation.vector - Vector3::new(x, y, 0.0)).norm() < step);
        assert!(passes(10.0, 0.0) && passes(18.0, 6.0));
    }

    #[test]
    fn impossible_paths_are_refused() {
        for (points, named) in [
            (vec![[0.0, 0.0]], "2 to 10000 way-points"),
            (vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], "way-points 1 and 2"),
            (vec![[0.0, 0.0], [5.0, 0.0], [0.0, 1.0]], "at way-point 1"),
        ] {
            let error = path(&points).unwrap_err().to_string();
            assert!(error.starts_with("trajectory.waypoints_m: ") && error.contains(named), "{error}");
        }
    }
}
