use nalgebra::{Point3, Vector3};

use crate::CoreError;
use crate::error::require;

/// A rectified stereo rig: two pinhole cameras with one focal length, row-aligned, the right one displaced by
/// `baseline_m` along the camera's x axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoRig {
    /// Image width, pixels.
    pub width: usize,
    /// Image height, pixels.
    pub height: usize,
    /// Focal length, pixels, equal in x and y.
    pub focal_px: f64,
    /// Column of the principal point, pixels.
    pub centre_x_px: f64,
    /// Row of the principal point, pixels.
    pub centre_y_px: f64,
    /// Distance between the two camera centres, metres.
    pub baseline_m: f64,
}

impl StereoRig {
    /// Checks the numbers and gives the rig back.
    ///
    /// # Errors
    /// If a size is zero, or the focal length or the baseline is not a positive finite number, or the
    /// principal point is not finite.
    pub fn checked(self) -> Result<Self, CoreError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        require(self.width > 0, "image width", "at least 1 px", self.width as f64)?;
        require(self.height > 0, "image height", "at least 1 px", self.height as f64)?;
        require(positive(self.focal_px), "focal length", "a positive number of px", self.focal_px)?;
        require(positive(self.baseline_m), "baseline", "a positive number of metres", self.baseline_m)?;
        require(self.centre_x_px.is_finite(), "principal point x", "a finite number", self.centre_x_px)?;
        require(self.centre_y_px.is_finite(), "principal point y", "a finite number", self.centre_y_px)?;
        Ok(self)
    }

    /// Depth z in metres of a disparity in pixels: z = b f / d (Andert 2009, eq. 1). Infinite for d = 0, NaN
    /// for NaN.
    pub fn depth_m(&self, disparity_px: f64) -> f64 {
        self.baseline_m * self.focal_px / disparity_px
    }

    /// Disparity in pixels of a depth in metres, the inverse of [`Self::depth_m`].
    pub fn disparity_px(&self, depth_m: f64) -> f64 {
        self.baseline_m * self.focal_px / depth_m
    }

    /// The viewing ray of pixel (x, y) in the left camera frame, scaled to z = 1.
    pub fn ray(&self, x: f64, y: f64) -> Vector3<f64> {
        Vector3::new((x - self.centre_x_px) / self.focal_px, (y - self.centre_y_px) / self.focal_px, 1.0)
    }

    /// Pixel coordinates (x, y) of a point of the left camera frame; `None` at or behind the camera plane.
    /// The pixel may lie outside the image.
    pub fn project(&self, point: &Point3<f64>) -> Option<(f64, f64)> {
        (point.z > 0.0).then(|| {
            (
                self.centre_x_px + self.focal_px * point.x / point.z,
                self.centre_y_px + self.focal_px * point.y / point.z,
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: StereoRig = StereoRig {
        width: 64,
        height: 48,
        focal_px: 70.0,
        centre_x_px: 32.0,
        centre_y_px: 24.0,
        baseline_m: 3.0,
    };

    #[test]
    fn depth_times_disparity_is_baseline_times_focal_length() {
        // b f = 210: 21 px at 10 m, 10.5 px at 20 m.
        assert_eq!(RIG.depth_m(21.0), 10.0);
        assert_eq!(RIG.disparity_px(20.0), 10.5);
        assert_eq!(RIG.depth_m(0.0), f64::INFINITY);
        assert!(RIG.depth_m(f64::NAN).is_nan());
    }

    #[test]
    fn projection_inverts_the_ray() {
        let point = Point3::from(RIG.ray(17.0, 401.0) * 12.5);
        let (x, y) = RIG.project(&point).unwrap();
        assert!((x - 17.0).abs() < 1e-9 && (y - 401.0).abs() < 1e-9);
        assert_eq!(RIG.project(&Point3::new(1.0, 1.0, 0.0)), None);
    }

    #[test]
    fn impossible_rigs_are_refused() {
        assert!(RIG.checked().is_ok());
        for bad in [
            StereoRig { focal_px: 0.0, ..RIG },
            StereoRig { focal_px: f64::NAN, ..RIG },
            StereoRig { baseline_m: -0.3, ..RIG },
            StereoRig { width: 0, ..RIG },
            StereoRig { centre_y_px: f64::INFINITY, ..RIG },
        ] {
            assert!(bad.checked().is_err(), "{bad:?}");
        }
    }
}
