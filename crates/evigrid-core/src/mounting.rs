use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::error::require;
use crate::{CoreError, Pose};

/// Turn of a level camera that looks along x: camera axes (x right, y down, z forward) in a frame whose x is
/// forward, y left, z up.
pub fn level_camera() -> UnitQuaternion<f64> {
    let columns = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns))
}

/// How the left camera stands over level ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting {
    /// Height of the camera's centre over the ground, metres.
    pub height_m: f64,
    /// Angle by which the optical axis points below the horizontal, radians.
    pub pitch_rad: f64,
    /// How far the camera stands ahead of the middle of the robot, metres.
    pub ahead_m: f64,
    /// How far it stands to the left of the middle, metres.
    pub left_m: f64,
}

impl Mounting {
    /// The mounting of a camera over the middle of its robot: height in metres and pitch in radians.
    pub const fn over_middle(height_m: f64, pitch_rad: f64) -> Self {
        Self { height_m, pitch_rad, ahead_m: 0.0, left_m: 0.0 }
    }

    /// The mounting of a camera on a body whose origin is on the ground below its middle, whose x axis points
    /// ahead and whose z axis points up.
    pub fn of(body_from_left: &Pose) -> Self {
        let forward = body_from_left.rotation * Vector3::z();
        let [ahead_m, left_m, height_m] = body_from_left.translation.vector.into();
        Self { height_m, pitch_rad: (-forward.z).clamp(-1.0, 1.0).asin(), ahead_m, left_m }
    }

    /// The place of the robot's middle in the map frame, metres, given the pose of the camera, which looks
    /// ahead.
    pub fn robot_m(&self, map_from_left: &Pose) -> [f64; 2] {
        let ahead = map_from_left.rotation * Vector3::z();
        let [x, y, _] = map_from_left.translation.vector.into();
        let level = (ahead.x * ahead.x + ahead.y * ahead.y).sqrt();
        // A camera that looks straight down does not tell where ahead is.
        let [c, s] = if level > 0.0 { [ahead.x / level, ahead.y / level] } else { [1.0, 0.0] };
        [x - c * self.ahead_m + s * self.left_m, y - s * self.ahead_m - c * self.left_m]
    }

    /// Checks the numbers and gives the mounting back.
    ///
    /// # Errors
    /// If the height is not a positive finite number, the pitch is not within a quarter turn, or the place is
    /// not finite.
    pub fn checked(self) -> Result<Self, CoreError> {
        let (height, pitch) = (self.height_m, self.pitch_rad);
        let positive = height.is_finite() && height > 0.0;
        require(positive, "height of the camera", "a positive number of metres", height)?;
        let right_angle = std::f64::consts::FRAC_PI_2;
        require(
            pitch.abs() < right_angle,
            "pitch of the camera",
            "less than 90 degrees",
            pitch.to_degrees(),
        )?;
        for place in [self.ahead_m, self.left_m] {
            require(
                place.is_finite(),
                "place of the camera on the robot",
                "a finite number of metres",
                place,
            )?;
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Translation3;

    #[test]
    fn a_camera_that_looks_down_has_a_positive_pitch() {
        // A turn about the body's y axis (left) moves x towards -z.
        let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.1);
        let pose = Pose::from_parts(Translation3::new(0.3, 0.1, 1.2), down * level_camera());
        let mounting = Mounting::of(&pose);
        assert!((mounting.pitch_rad - 0.1).abs() < 1e-12 && mounting.height_m == 1.2, "{mounting:?}");
        assert_eq!((mounting.ahead_m, mounting.left_m), (0.3, 0.1));
        assert!(mounting.checked().is_ok());
        assert!(Mounting { left_m: f64::NAN, ..mounting }.checked().is_err());
        assert!(Mounting { height_m: 0.0, ..mounting }.checked().is_err());
        assert!(Mounting { pitch_rad: f64::NAN, ..mounting }.checked().is_err());
    }

    /// The body's own origin, wherever the body stands and however it is turned.
    #[test]
    fn the_robot_is_found_below_its_camera() {
        let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.4);
        let body_from_left = Pose::from_parts(Translation3::new(0.3, -0.2, 1.2), down * level_camera());
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.0);
        let map_from_body = Pose::from_parts(Translation3::new(5.0, 7.0, 0.0), yaw);
        let [x, y] = Mounting::of(&body_from_left).robot_m(&(map_from_body * body_from_left));
        assert!((x - 5.0).abs() < 1e-12 && (y - 7.0).abs() < 1e-12, "{x} {y}");
    }
}
