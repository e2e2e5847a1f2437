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
}

impl Mounting {
    /// The mounting of a camera on a body whose origin is on the ground and whose z axis points up.
    pub fn of(body_from_left: &Pose) -> Self {
        let forward = body_from_left.rotation * Vector3::z();
        Self { height_m: body_from_left.translation.z, pitch_rad: (-forward.z).clamp(-1.0, 1.0).asin() }
    }

    /// Checks the numbers and gives the mounting back.
    ///
    /// # Errors
    /// If the height is not a positive finite number, or the pitch is not within a quarter turn.
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
        let pose = Pose::from_parts(Translation3::new(0.3, 0.0, 1.2), down * level_camera());
        let mounting = Mounting::of(&pose);
        assert!((mounting.pitch_rad - 0.1).abs() < 1e-12 && mounting.height_m == 1.2, "{mounting:?}");
        assert!(mounting.checked().is_ok());
        assert!(Mounting { height_m: 0.0, ..mounting }.checked().is_err());
        assert!(Mounting { pitch_rad: f64::NAN, ..mounting }.checked().is_err());
    }
}
