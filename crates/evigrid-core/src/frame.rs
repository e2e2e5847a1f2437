use std::sync::Arc;

use crate::error::require;
use crate::{CoreError, GrayImage, Pose, StereoRig};

/// One sweep of a laser scanner, or of several at once.
#[derive(Debug, Clone)]
pub struct LaserScan {
    points: Vec<[f32; 3]>,
    origins: Option<Vec<[f32; 3]>>,
    map_from_laser: Pose,
}

impl LaserScan {
    /// A scan from its points in the laser's own frame (x forward, y left, z up, metres) and the laser's
    /// pose.
    ///
    /// # Errors
    /// If a coordinate is not finite.
    pub fn new(points: Vec<[f32; 3]>, map_from_laser: Pose) -> Result<Self, CoreError> {
        require_finite("laser point", &points)?;
        Ok(Self { points, origins: None, map_from_laser })
    }

    /// The scan of a scanner that moved, or of several: where each point's ray started, in the laser's own
    /// frame, metres, one origin per point.
    ///
    /// # Errors
    /// If there are more or fewer origins than points, or a coordinate is not finite.
    pub fn with_origins(mut self, origins: Vec<[f32; 3]>) -> Result<Self, CoreError> {
        let (found, expected) = (origins.len(), self.points.len());
        require(found == expected, "number of laser origins", "one per point", found as f64)?;
        require_finite("laser origin", &origins)?;
        self.origins = Some(origins);
        Ok(self)
    }

    /// Points in the laser's frame, metres.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// Where the ray of each point started in the laser's frame, metres, if not all started at its origin.
    pub fn origins(&self) -> Option<&[[f32; 3]]> {
        self.origins.as_deref()
    }

    /// Pose of the laser; its origin is where all rays start that have no origin of their own.
    pub fn map_from_laser(&self) -> &Pose {
        &self.map_from_laser
    }
}

fn require_finite(what: &'static str, points: &[[f32; 3]]) -> Result<(), CoreError> {
    for &v in points.iter().flatten() {
        require(v.is_finite(), what, "finite coordinates", f64::from(v))?;
    }
    Ok(())
}

/// One instant of a recording: a rectified stereo pair, where it was taken, and what the laser saw. Checked
/// when built, never changed.
#[derive(Debug, Clone)]
pub struct Frame {
    index: usize,
    stamp_ns: i64,
    rig: StereoRig,
    left: GrayImage,
    right: GrayImage,
    left_png: Option<Arc<[u8]>>,
    map_from_left: Pose,
    laser: Option<LaserScan>,
}

impl Frame {
    /// A frame from its parts. `index` is the number the data set gives it, `stamp_ns` the time of the left
    /// image in nanoseconds.
    ///
    /// # Errors
    /// If an image has another size than the rig says, or the pose is not finite.
    pub fn new(
        index: usize,
        stamp_ns: i64,
        rig: StereoRig,
        left: GrayImage,
        right: GrayImage,
        map_from_left: Pose,
        laser: Option<LaserScan>,
    ) -> Result<Self, CoreError> {
        let rig = rig.checked()?;
        for value in map_from_left.to_homogeneous().iter() {
            require(value.is_finite(), "pose", "finite numbers", *value)?;
        }
        for (what, image) in [("left image", &left), ("right image", &right)] {
            if (image.width(), image.height()) != (rig.width, rig.height) {
                return Err(CoreError::Size {
                    what,
                    expected_width: rig.width,
                    expected_height: rig.height,
                    width: image.width(),
                    height: image.height(),
                });
            }
        }
        Ok(Self { index, stamp_ns, rig, left, right, left_png: None, map_from_left, laser })
    }

    /// Keeps the left image as the PNG file it was read from, so that a recording need not encode it again.
    #[must_use]
    pub fn with_left_png(mut self, png: Arc<[u8]>) -> Self {
        self.left_png = Some(png);
        self
    }

    /// The number the data set gives this frame.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Time of the left image, nanoseconds.
    pub fn stamp_ns(&self) -> i64 {
        self.stamp_ns
    }

    /// The rig that took the pair.
    pub fn rig(&self) -> &StereoRig {
        &self.rig
    }

    /// Left image.
    pub fn left(&self) -> &GrayImage {
        &self.left
    }

    /// Right image.
    pub fn right(&self) -> &GrayImage {
        &self.right
    }

    /// The left image as the PNG file it came from, where it came from one.
    pub fn left_png(&self) -> Option<&Arc<[u8]>> {
        self.left_png.as_ref()
    }

    /// Pose of the left camera.
    pub fn map_from_left(&self) -> &Pose {
        &self.map_from_left
    }

    /// The laser scan, if the data set has one for this frame.
    pub fn laser(&self) -> Option<&LaserScan> {
        self.laser.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize) -> GrayImage {
        GrayImage::new(width, height, vec![0; width * height]).unwrap()
    }

    #[test]
    fn images_of_another_size_are_refused() {
        let rig = StereoRig {
            width: 4,
            height: 3,
            focal_px: 5.0,
            centre_x_px: 2.0,
            centre_y_px: 1.0,
            baseline_m: 0.1,
        };
        let build = |left, right| Frame::new(0, 0, rig, left, right, Pose::identity(), None);
        assert!(build(image(4, 3), image(4, 3)).is_ok());
        let error = build(image(4, 3), image(3, 4)).unwrap_err();
        assert_eq!(error.to_string(), "image sizes differ: expected 4x3, found 3x4 (right image)");
        assert!(build(image(5, 3), image(4, 3)).is_err());
    }

    #[test]
    fn laser_points_must_be_finite() {
        assert!(LaserScan::new(vec![[1.0, 2.0, 3.0]], Pose::identity()).is_ok());
        assert!(LaserScan::new(vec![[1.0, f32::NAN, 3.0]], Pose::identity()).is_err());
        let scan = LaserScan::new(vec![[1.0, 2.0, 3.0]], Pose::identity()).unwrap();
        assert!(scan.clone().with_origins(vec![[0.0; 3]]).is_ok());
        assert!(scan.clone().with_origins(vec![]).is_err());
        assert!(scan.with_origins(vec![[0.0, f32::INFINITY, 0.0]]).is_err());
    }
}
