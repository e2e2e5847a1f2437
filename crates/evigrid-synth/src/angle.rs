//! Rotations from angles, with sines and cosines that do not depend on the machine's mathematics library.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Sine and cosine of an angle in degrees.
pub fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    let radians = degrees.to_radians();
    (libm::sin(radians), libm::cos(radians))
}

/// The turn by `degrees` about a unit axis, right-handed.
fn turn(axis: Vector3<f64>, degrees: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = sin_cos_deg(0.5 * degrees);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, axis * sin))
}

/// The turn about the z axis, anticlockwise seen from above.
pub fn yaw(degrees: f64) -> UnitQuaternion<f64> {
    turn(Vector3::z(), degrees)
}

/// The turn about the body's y axis that lowers what is in front.
pub fn tilt_down(degrees: f64) -> UnitQuaternion<f64> {
    turn(Vector3::y(), degrees)
}

/// The attitude of an object or a sensor: rolled about its x axis (right-handed: its left side rises), then
/// pitched (its front rises), then turned about the vertical.
pub fn attitude(yaw_deg: f64, pitch_deg: f64, roll_deg: f64) -> UnitQuaternion<f64> {
    yaw(yaw_deg) * tilt_down(-pitch_deg) * turn(Vector3::x(), roll_deg)
}

/// The turn about the y axis that raises x to (cos, 0, sin).
pub fn pitch_up([cos, sin]: [f64; 2]) -> UnitQuaternion<f64> {
    let q = heading([cos, sin]);
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, 0.0, -q.k, 0.0))
}

/// The turn about the z axis that takes x to the unit vector (cos, sin).
pub fn heading([cos, sin]: [f64; 2]) -> UnitQuaternion<f64> {
    let (w, z) = if cos > 0.0 {
        let w = (0.5 * (1.0 + cos)).sqrt();
        (w, 0.5 * sin / w)
    } else {
        let z = (0.5 * (1.0 - cos)).sqrt().copysign(sin);
        (0.5 * sin / z, z)
    };
    UnitQuaternion::new_unchecked(Quaternion::new(w, 0.0, 0.0, z))
}

/// Camera axes (x right, y down, z forward) in a body frame (x forward, y left, z up).
pub fn body_from_camera_axes() -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.5, -0.5))
}

/// The direction at `azimuth_deg` (anticlockwise from x) and `elevation_deg` (above the horizon).
pub fn direction(azimuth_deg: f64, elevation_deg: f64) -> Vector3<f64> {
    let (sin_a, cos_a) = sin_cos_deg(azimuth_deg);
    let (sin_e, cos_e) = sin_cos_deg(elevation_deg);
    Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_looks_along_x_with_its_columns_to_the_right() {
        let q = body_from_camera_axes();
        assert_eq!(q * Vector3::z(), Vector3::x());
        assert_eq!(q * Vector3::x(), -Vector3::y());
        assert_eq!(q * Vector3::y(), -Vector3::z());
    }

    #[test]
    fn headings_of_all_quadrants() {
        for degrees in [0.0, 1e-7, 40.0, 90.0, 135.0, 180.0, 200.0, 270.0, 359.0] {
            let (sin, cos) = sin_cos_deg(degrees);
            let x = heading([cos, sin]) * Vector3::x();
            assert!((x - Vector3::new(cos, sin, 0.0)).norm() < 1e-12, "{degrees}");
            assert!((yaw(degrees) * Vector3::x() - x).norm() < 1e-12, "{degrees}");
        }
    }

    #[test]
    fn pitching_raises_the_front_and_rolling_the_left_side() {
        let q = attitude(30.0, 20.0, 0.0);
        assert!((q * Vector3::x() - direction(30.0, 20.0)).norm() < 1e-12);
        let (sin, cos) = sin_cos_deg(20.0);
        assert!((pitch_up([cos, sin]) * Vector3::x() - direction(0.0, 20.0)).norm() < 1e-12);
        let left = attitude(0.0, 0.0, 10.0) * Vector3::y();
        assert!((left - direction(90.0, 10.0)).norm() < 1e-12);
    }

    #[test]
    fn tilting_lowers_what_is_in_front() {
        let x = tilt_down(30.0) * Vector3::x();
        assert!((x - direction(0.0, -30.0)).norm() < 1e-12, "{x}");
    }
}
