use evigrid_core::{Pose, StereoRig};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use crate::number::{Count, Finite, NonNegative, Positive, Share, vector};
use crate::random::{Sensor, normal, stream};
use crate::ray::Ray;
use crate::{SynthError, angle};

/// A stereo rig and its place on the body as a world describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StereoSpec {
    /// Image width, pixels.
    width: Count,
    /// Image height, pixels.
    height: Count,
    /// Focal length, pixels.
    focal_px: Positive,
    /// Principal point (column, row), pixels.
    centre_px: [Finite; 2],
    /// Distance of the two cameras, metres.
    baseline_m: Positive,
    /// The left camera in the body frame, metres.
    mount_m: [Finite; 3],
    /// How far the cameras are turned to the left.
    #[serde(default)]
    yaw_deg: Finite,
    /// How far the cameras look down.
    #[serde(default)]
    tilt_deg: Finite,
    /// How far the cameras' left side is up.
    #[serde(default)]
    roll_deg: Finite,
    /// Errors that the cameras add to the light; none if it is not given.
    #[serde(default)]
    pub noise: CameraNoiseSpec,
}

/// Errors of the cameras as a world describes them.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraNoiseSpec {
    /// Standard deviation of a pixel in the dark, grey levels.
    #[serde(default)]
    read_grey: NonNegative,
    /// Shot noise: variance that every grey level of light adds, grey levels.
    #[serde(default)]
    shot_grey: NonNegative,
    /// Share of the light that is lost in the corners; it grows with the square
    /// of the distance from the centre.
    #[serde(default)]
    vignetting: Share,
    /// Standard deviation of the change of exposure from one frame to the next, a share; the exposure is
    /// pulled back by a twentieth of its deviation per frame. Both cameras share it.
    #[serde(default)]
    exposure_drift: Share,
}

impl CameraNoiseSpec {
    /// The exposure of every frame, relative to that of the first.
    pub fn exposures(&self, frame_count: usize, seed: u64) -> Vec<f64> {
        let mut rng = stream(seed, 0, Sensor::Exposure, 0);
        let next = |&deviation: &f64| Some(0.95 * deviation + self.exposure_drift.0 * normal(&mut rng));
        let deviations = std::iter::successors(Some(0.0), next);
        // Never dark, however long the drift.
        deviations.take(frame_count).map(|d| (1.0 + d).clamp(0.5, 2.0)).collect()
    }

    /// The share of the light that reaches the pixel (x, y).
    pub fn transmission(&self, rig: &StereoRig, x: usize, y: usize) -> f64 {
        let (dx, dy) = (x as f64 - rig.centre_x_px, y as f64 - rig.centre_y_px);
        let (width, height) = (0.5 * rig.width as f64, 0.5 * rig.height as f64);
        let share = (dx * dx + dy * dy) / (width * width + height * height);
        (1.0 - self.vignetting.0 * share).max(0.0)
    }

    /// The measured grey of a pixel that light of this grey level reaches, not bounded.
    pub fn measure(&self, light: f64, rng: &mut ChaCha8Rng) -> f64 {
        // The well is full at 255.
        let light = light.clamp(0.0, 255.0);
        let variance = self.read_grey.0 * self.read_grey.0 + self.shot_grey.0 * light;
        light + variance.sqrt() * normal(rng)
    }
}

/// No larger images than this, to bound the memory (about 20 bytes per pixel while a frame is rendered).
const MAX_PIXELS: usize = 32_000_000;

impl StereoSpec {
    /// The rig.
    ///
    /// # Errors
    /// If the images are too large.
    pub fn rig(&self) -> Result<StereoRig, SynthError> {
        let (width, height) = (self.width.get(), self.height.get());
        if width * height > MAX_PIXELS {
            let found = format!("{width} x {height}");
            return Err(SynthError::value(
                "stereo.width and stereo.height",
                "at most 32 million pixels",
                found,
            ));
        }
        Ok(StereoRig {
            width,
            height,
            focal_px: self.focal_px.0,
            centre_x_px: self.centre_px[0].0,
            centre_y_px: self.centre_px[1].0,
            baseline_m: self.baseline_m.0,
        })
    }

    /// Pose of the left camera on the body.
    pub fn body_from_left(&self) -> Pose {
        let rotation = angle::attitude(self.yaw_deg.0, -self.tilt_deg.0, self.roll_deg.0)
            * angle::body_from_camera_axes();
        Isometry3::from_parts(Translation3::from(vector(self.mount_m)), rotation)
    }
}

/// A pinhole camera at its place in the world.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    rig: StereoRig,
    world_from_camera: Pose,
}

impl Camera {
    /// The left camera of `rig` at this pose.
    pub fn left(rig: StereoRig, world_from_left: &Pose) -> Self {
        Self { rig, world_from_camera: *world_from_left }
    }

    /// The right camera that belongs to the left one at this pose.
    pub fn right(rig: StereoRig, world_from_left: &Pose) -> Self {
        let left_from_right = Translation3::new(rig.baseline_m, 0.0, 0.0);
        Self { rig, world_from_camera: world_from_left * left_from_right }
    }

    /// Image width and height, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.rig.width, self.rig.height)
    }

    /// Where the camera is, metres.
    pub fn position(&self) -> Point3<f64> {
        self.world_from_camera.translation.vector.into()
    }

    /// Pose of the camera.
    pub fn world_from_camera(&self) -> &Pose {
        &self.world_from_camera
    }

    /// The ray of the image point (p, p) in camera axes, depth 1.
    pub fn rig_ray(&self, p: f64) -> Vector3<f64> {
        self.rig.ray(p, p)
    }

    /// The ray of the image point (x, y) in pixels, and the width of a pixel's footprint per metre of range.
    pub fn ray(&self, x: f64, y: f64) -> (Ray, f64) {
        let in_camera = self.rig.ray(x, y);
        let length = in_camera.norm();
        let direction = self.world_from_camera.rotation * (in_camera / length);
        (Ray { origin: self.position(), direction }, 1.0 / (self.rig.focal_px * length))
    }
}
