use evigrid_core::{Pose, StereoRig};

use crate::SynthError;
use crate::camera::Camera;
use crate::description::WorldSpec;
use crate::laser::Laser;
use crate::light::Light;
use crate::material::Material;
use crate::scene::Scene;
use crate::trajectory::Path;

/// The built-in worlds by name.
const BUILTIN: [(&str, &str); 1] = [("street", include_str!("../../../datasets/synth/street.toml"))];

/// A synthetic world: a scene, and a vehicle with a stereo rig and perhaps a laser scanner that drives through it.
/// Checked when built, never changed.
#[derive(Clone)]
pub struct World {
    pub(crate) name: String,
    pub(crate) seed: u64,
    pub(crate) frame_count: usize,
    rate_hz: f64,
    speed_mps: f64,
    path: Path,
    pub(crate) rig: StereoRig,
    pub(crate) noise_grey: f64,
    body_from_left: Pose,
    pub(crate) laser: Option<Laser>,
    pub(crate) light: Light,
    pub(crate) scene: Scene,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World").field("name", &self.name).field("frame_count", &self.frame_count).finish()
    }
}

impl World {
    /// The world that a TOML text describes; `datasets/synth/street.toml` shows and explains every key.
    ///
    /// # Errors
    /// If the text is no TOML; if a key is unknown, missing or has an impossible value; if a material is unknown;
    /// if the way-points are too close, turn too sharply or do not suffice for all frames; if a camera ever is
    /// inside a shape; if the world is too large to be rendered in bounded memory. The message is one line that
    /// names the key or the line.
    pub fn from_toml(text: &str) -> Result<Self, SynthError> {
        let spec = WorldSpec::parse(text)?;
        let objects = spec.objects(text)?;
        let world = Self {
            seed: u64::from(spec.seed),
            frame_count: spec.frames.get(),
            rate_hz: spec.rate_hz.0,
            speed_mps: spec.trajectory.speed_mps.0,
            path: Path::new(&spec.trajectory)?,
            rig: spec.stereo.rig()?,
            noise_grey: spec.stereo.noise_grey.0,
            body_from_left: spec.stereo.body_from_left(),
            laser: spec.laser.as_ref().map(Laser::new).transpose()?,
            light: Light::new(&spec.light),
            scene: Scene::new(objects, spec.material.into_values().map(Material::new).collect()),
            name: spec.name.0,
        };
        world.check_length()?;
        world.check_cameras()?;
        Ok(world)
    }

    /// The built-in world of this name (one of [`Self::builtin_names`]).
    ///
    /// # Errors
    /// If there is none.
    pub fn builtin(name: &str) -> Result<Self, SynthError> {
        match BUILTIN.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Self::from_toml(text),
            None => Err(SynthError::UnknownWorld {
                name: name.to_owned(),
                known: Self::builtin_names().collect::<Vec<_>>().join(", "),
            }),
        }
    }

    /// The names of the built-in worlds.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        BUILTIN.into_iter().map(|(name, _)| name)
    }

    /// The world's name, e.g. `street`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Time of a frame, nanoseconds; frame 0 is at 0.
    pub(crate) fn stamp_ns(&self, frame: usize) -> i64 {
        (frame as f64 * 1e9 / self.rate_hz).round() as i64
    }

    /// Pose of the vehicle at a frame.
    pub(crate) fn world_from_body(&self, frame: usize) -> Pose {
        self.path.world_from_body(self.distance_m(frame))
    }

    /// Pose of the left camera at a frame.
    pub(crate) fn world_from_left(&self, frame: usize) -> Pose {
        self.world_from_body(frame) * self.body_from_left
    }

    fn distance_m(&self, frame: usize) -> f64 {
        frame as f64 * self.speed_mps / self.rate_hz
    }

    fn check_length(&self) -> Result<(), SynthError> {
        let (driven, length) = (self.distance_m(self.frame_count - 1), self.path.length_m());
        if driven <= length + 1e-6 {
            return Ok(());
        }
        let expected = format!("a path of at least {driven:.3} m for {} frames", self.frame_count);
        Err(SynthError::value("trajectory.waypoints_m", expected, format!("{length:.3} m")))
    }

    fn check_cameras(&self) -> Result<(), SynthError> {
        for frame in 0..self.frame_count {
            let pose = self.world_from_left(frame);
            for (side, camera) in
                [("left", Camera::left(self.rig, &pose)), ("right", Camera::right(self.rig, &pose))]
            {
                if let Some(object) = self.scene.object_around(&camera.position()) {
                    let found = format!("the {side} camera of frame {frame} inside object {object} (from 0)");
                    return Err(SynthError::value("stereo.mount_m", "cameras outside of all shapes", found));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "world_tests.rs"]
mod tests;
