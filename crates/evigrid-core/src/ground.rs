use nalgebra::{Matrix3, Rotation3, Unit, UnitVector3, Vector3};

use crate::{CoreError, Mounting, StereoRig};

/// Level ground below the left camera, in camera axes (x right, y down, z forward).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundPlane {
    down: UnitVector3<f64>,
    height_m: f64,
}

/// The disparities of a plane, which are linear in the image: `at_centre_px` at the principal point, and so much
/// more per column to the right and per row down, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisparityPlane {
    /// Disparity at the principal point, pixels; 0 if the camera is level.
    pub at_centre_px: f64,
    /// Change from one column to the next on the right; 0 if the camera does not roll.
    pub per_column: f64,
    /// Change from one row to the next below: baseline over height for a level camera.
    pub per_row: f64,
    /// The principal point: column and row, pixels.
    pub centre_px: [f64; 2],
}

impl GroundPlane {
    /// The ground below a camera that does not roll.
    pub fn below(mounting: &Mounting) -> Self {
        let (sin, cos) = mounting.pitch_rad.sin_cos();
        Self { down: Unit::new_unchecked(Vector3::new(0.0, cos, sin)), height_m: mounting.height_m }
    }

    /// The ground that shows these disparities in the left image of a rig.
    ///
    /// # Errors
    /// If they do not grow downwards: no ground below a camera shows such ones.
    pub fn of_disparities(rig: &StereoRig, plane: &DisparityPlane) -> Result<Self, CoreError> {
        // With down = n and b the baseline, d = b / height * (n_x (u - u0) + n_y (v - v0) + n_z f).
        let scaled = Vector3::new(plane.per_column, plane.per_row, plane.at_centre_px / rig.focal_px);
        let length = scaled.norm();
        if !(plane.per_row > 0.0 && length.is_finite()) {
            let found = plane.per_row;
            let (what, expected) = ("disparities of the ground per row", "a finite number above 0");
            return Err(CoreError::Domain { what, expected, found });
        }
        Ok(Self { down: Unit::new_unchecked(scaled / length), height_m: rig.baseline_m / length })
    }

    /// Its disparities in the left image of a rig.
    pub fn disparities(&self, rig: &StereoRig) -> DisparityPlane {
        let scale = rig.baseline_m / self.height_m;
        DisparityPlane {
            at_centre_px: scale * self.down.z * rig.focal_px,
            per_column: scale * self.down.x,
            per_row: scale * self.down.y,
            centre_px: [rig.centre_x_px, rig.centre_y_px],
        }
    }

    /// Height of the camera's centre over it, metres.
    pub fn height_m(&self) -> f64 {
        self.height_m
    }

    /// How high a point of the left camera's frame lies over the ground, metres.
    pub fn height_of_m(&self, point: &Vector3<f64>) -> f64 {
        self.height_m - self.down.dot(point)
    }

    /// Angle by which the optical axis points below the horizontal, radians.
    pub fn pitch_rad(&self) -> f64 {
        self.down.z.clamp(-1.0, 1.0).asin()
    }

    /// Angle by which the camera is turned about its optical axis, radians; positive: the ground's horizon rises
    /// to the right.
    pub fn roll_rad(&self) -> f64 {
        self.down.x.atan2(self.down.y)
    }

    /// Whether the camera is level: neither pitch nor roll.
    pub fn is_level(&self) -> bool {
        self.down.x == 0.0 && self.down.z == 0.0
    }

    /// The turn from camera axes to those of a level camera that looks the same way: y is down, and z the optical
    /// axis without its part downwards.
    pub fn level_from_camera(&self) -> Rotation3<f64> {
        let down = self.down.into_inner();
        let ahead = (Vector3::z() - down * down.z).normalize();
        let right = down.cross(&ahead);
        let rows = [right.transpose(), down.transpose(), ahead.transpose()];
        Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows))
    }
}

impl DisparityPlane {
    /// The disparity at a pixel; negative above the horizon.
    pub fn at(&self, column: f64, row: f64) -> f64 {
        let [u0, v0] = self.centre_px;
        self.at_centre_px + self.per_column * (column - u0) + self.per_row * (row - v0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    const RIG: StereoRig = StereoRig {
        width: 512,
        height: 320,
        focal_px: 410.0,
        centre_x_px: 255.5,
        centre_y_px: 159.5,
        baseline_m: 0.22,
    };

    /// Points on level ground, projected.
    #[test]
    fn points_of_the_ground_have_its_disparities() {
        for (pitch, roll) in [(0.0, 0.0), (0.2, 0.0), (-0.1, 0.0), (0.1, 0.05), (0.0, -0.2)] {
            let mounting = Mounting::over_middle(1.2, pitch);
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), roll);
            let down = turn * GroundPlane::below(&mounting).down;
            let ground = GroundPlane { down, height_m: 1.2 };
            let plane = ground.disparities(&RIG);
            let level = ground.level_from_camera();
            for [x, z] in [[0.0, 5.0], [2.0, 8.0], [-3.0, 20.0]] {
                // 1.2 m below the level camera, x to the right and z ahead.
                let point = level.inverse() * Point3::new(x, 1.2, z);
                let (u, v) = RIG.project(&point).unwrap();
                assert!((plane.at(u, v) - RIG.disparity_px(point.z)).abs() < 1e-9);
                assert!(ground.height_of_m(&point.coords).abs() < 1e-9);
            }
            let again = GroundPlane::of_disparities(&RIG, &plane).unwrap();
            assert!((again.down.into_inner() - down.into_inner()).norm() < 1e-12);
            assert!((again.height_m - 1.2).abs() < 1e-12);
            assert!((again.roll_rad() + roll).abs() < 1e-9 || pitch != 0.0);
        }
    }

    #[test]
    fn a_level_camera_has_its_horizon_at_the_centre() {
        let ground = GroundPlane::below(&Mounting::over_middle(1.2, 0.0));
        let plane = ground.disparities(&RIG);
        assert_eq!(plane.at(17.0, 159.5), 0.0);
        assert!((plane.at(300.0, 169.5) - 10.0 * 0.22 / 1.2).abs() < 1e-12);
        assert!(ground.is_level() && ground.pitch_rad() == 0.0);
        assert_eq!(ground.level_from_camera(), Rotation3::identity());
    }

    #[test]
    fn ground_that_is_none_is_refused() {
        let plane = GroundPlane::below(&Mounting::over_middle(1.2, 0.1)).disparities(&RIG);
        for bad in [
            DisparityPlane { per_row: 0.0, ..plane },
            DisparityPlane { per_row: -0.1, ..plane },
            DisparityPlane { per_row: f64::NAN, ..plane },
            DisparityPlane { at_centre_px: f64::INFINITY, ..plane },
        ] {
            assert!(GroundPlane::of_disparities(&RIG, &bad).is_err(), "{bad:?}");
        }
    }
}
