use std::path::Path as FilePath;
use std::sync::Arc;

use evigrid_core::{Mounting, Pose, StereoRig, name_hint};
use evigrid_grid::GridSpec;

use crate::SynthError;
use crate::camera::{Camera, CameraNoiseSpec};
use crate::contents::Contents;
use crate::description::WorldSpec;
use crate::hazard_spec::{NamedArea, named_areas};
use crate::laser::Laser;
use crate::light::Light;
use crate::material::Material;
use crate::robot::RobotSpec;
use crate::scene::Scene;
use crate::trajectory::Path;

/// Names and texts of world files.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../datasets/synth/", $name, ".toml")))),*]
    };
}

/// The built-in worlds by name.
const BUILTIN: &[(&str, &str)] = &built_in![
    "street",
    "andert-posts",
    "andert-flight-posts",
    "andert-flight-houses",
    "bars",
    "safety-1",
    "safety-2",
    "safety-3",
    "safety-4",
    "safety-5",
    "board-textured",
    "board-plain",
    "crossing",
    "box-and-pedestrian",
    "parked-row",
    "corridor",
    "corridor-odometry",
    "yard",
    "yard-odometry",
];

/// A synthetic world: a scene, and a vehicle with a stereo rig and perhaps laser scanners that drives through
/// it. Checked when built, never changed.
#[derive(Clone)]
pub struct World {
    pub(crate) name: String,
    /// The description it was built from.
    pub(crate) text: String,
    pub(crate) seed: u64,
    pub(crate) rig: StereoRig,
    pub(crate) noise: CameraNoiseSpec,
    pub(crate) lasers: Vec<Laser>,
    pub(crate) light: Light,
    pub(crate) materials: Vec<Material>,
    pub(crate) contents: Contents,
    pub(crate) robot: Option<RobotSpec>,
    /// Hazards and safe areas.
    pub(crate) areas: Vec<NamedArea>,
    /// Exposure of each frame relative to the first.
    pub(crate) exposures: Vec<f64>,
    /// Where the exact truth on disk lies in the map frame.
    pub(crate) truth_grid: GridSpec,
    pub(crate) body_from_left: Pose,
    rate_hz: f64,
    path: Path,
    /// Reported pose of the body at each frame.
    reported: Vec<Pose>,
    has_pose_errors: bool,
    /// The scene, if nothing moves in it.
    still: Option<Arc<Scene>>,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World").field("name", &self.name).field("frames", &self.frame_count()).finish()
    }
}

impl World {
    /// The world that a TOML text describes; docs/synthetic.md explains every key. A text has no folder, so
    /// it cannot name mesh files.
    ///
    /// # Errors
    /// If the text is no TOML; if a key is unknown, missing or has an impossible value; if a material or
    /// model is unknown; if the way-points are too close, turn too sharply or do not suffice for all frames;
    /// if a camera ever is inside a shape; if the world is too large to be rendered in bounded memory. The
    /// message is one line that names the key or the line.
    pub fn from_toml(text: &str) -> Result<Self, SynthError> {
        Self::build(text, None).map_err(|e| e.located(text))
    }

    /// The world of a TOML file, with mesh files beside it.
    ///
    /// # Errors
    /// If the file cannot be read, or as [`Self::from_toml`]; the message ends with the path.
    pub fn from_file(path: &FilePath) -> Result<Self, SynthError> {
        let in_file = |message: String| SynthError::File { message, path: path.to_owned() };
        let text = std::fs::read_to_string(path).map_err(|e| in_file(e.to_string()))?;
        let folder = path.parent().unwrap_or(FilePath::new(""));
        Self::build(&text, Some(folder)).map_err(|e| in_file(e.located(&text).to_string()))
    }

    fn build(text: &str, folder: Option<&FilePath>) -> Result<Self, SynthError> {
        let spec = WorldSpec::parse(text)?;
        let contents = Contents::new(&spec, text, folder)?;
        let path = Path::new(&spec.trajectory, "trajectory.waypoints")?;
        let (seed, frame_count, rate_hz) = (u64::from(spec.seed), spec.frames.get(), spec.rate_hz.0);
        check_length(&path, frame_count, rate_hz)?;
        let poses: Vec<Pose> =
            (0..frame_count).map(|frame| path.world_from_body(frame as f64 / rate_hz)).collect();
        let laser = |(i, laser)| Laser::new(laser, rate_hz, &format!("laser {i}"));
        let mut world = Self {
            text: text.to_owned(),
            truth_grid: spec.truth_grid(text)?,
            areas: named_areas(&spec, text)?,
            seed,
            rate_hz,
            rig: spec.stereo.rig()?,
            noise: spec.stereo.noise,
            exposures: spec.stereo.noise.exposures(frame_count, seed),
            body_from_left: spec.stereo.body_from_left(),
            reported: spec.reported_pose.reported(&poses, path.is_in_the_air(), seed),
            has_pose_errors: !spec.reported_pose.is_none(),
            path,
            lasers: spec.laser.iter().enumerate().map(laser).collect::<Result<_, _>>()?,
            robot: spec.robot,
            light: Light::new(&spec.light),
            materials: spec.material.into_values().map(Material::new).collect(),
            contents,
            name: spec.name.0,
            still: None,
        };
        if !world.contents.things.iter().any(crate::thing::Thing::moves) {
            world.still = Some(Arc::new(world.scene_at(0.0)));
        }
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
                hint: name_hint(name, Self::builtin_names()),
            }),
        }
    }

    /// The built-in world of this name, or the world of a TOML file, which is told by the ending of its name.
    ///
    /// # Errors
    /// If there is none, or it is impossible.
    pub fn open(name_or_path: &str) -> Result<Self, SynthError> {
        let path = FilePath::new(name_or_path);
        if path.extension().is_some_and(|extension| extension == "toml") {
            return Self::from_file(path);
        }
        Self::builtin(name_or_path)
    }

    /// The names of the built-in worlds.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        BUILTIN.iter().map(|&(name, _)| name)
    }

    /// The world's name, e.g. `street`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the exact truth on disk lies, in the map frame.
    pub fn truth_grid(&self) -> GridSpec {
        self.truth_grid
    }

    /// How many frames there are.
    pub fn frame_count(&self) -> usize {
        self.reported.len()
    }

    /// Time of a frame, seconds; frame 0 is at 0.
    pub(crate) fn time_s(&self, frame: usize) -> f64 {
        frame as f64 / self.rate_hz
    }

    /// Time of a frame, nanoseconds; frame 0 is at 0.
    pub(crate) fn stamp_ns(&self, frame: usize) -> i64 {
        (self.time_s(frame) * 1e9).round() as i64
    }

    /// True pose of the vehicle at this time, seconds.
    pub(crate) fn world_from_body(&self, time_s: f64) -> Pose {
        self.path.world_from_body(time_s)
    }

    /// True pose of the left camera at a frame, in the world's frame.
    pub fn true_world_from_left(&self, frame: usize) -> Pose {
        self.world_from_body(self.time_s(frame)) * self.body_from_left
    }

    /// Pose of the left camera at a frame as the robot reports it, in the world's frame.
    pub fn reported_world_from_left(&self, frame: usize) -> Pose {
        self.reported[frame] * self.body_from_left
    }

    /// Pose of a laser scanner at a frame as the robot reports it.
    pub(crate) fn reported_world_from_laser(&self, frame: usize, laser: &Laser) -> Pose {
        self.reported[frame] * laser.body_from_laser()
    }

    /// Whether the reported poses differ from the true ones.
    pub fn has_pose_errors(&self) -> bool {
        self.has_pose_errors
    }

    /// How the left camera stands over the ground below the vehicle; `None` in the air, where its height
    /// changes, and for a camera that is on or below the ground.
    pub(crate) fn mounting(&self) -> Option<Mounting> {
        let mounting = Mounting::of(&self.body_from_left).checked().ok();
        mounting.filter(|_| !self.path.is_in_the_air())
    }

    /// All shapes in their places at a frame.
    pub(crate) fn scene(&self, frame: usize) -> Arc<Scene> {
        match &self.still {
            Some(scene) => Arc::clone(scene),
            None => Arc::new(self.scene_at(self.time_s(frame))),
        }
    }

    fn scene_at(&self, time_s: f64) -> Scene {
        let poses: Vec<Pose> =
            self.contents.things.iter().map(|thing| thing.world_from_thing(time_s)).collect();
        let objects = self.contents.parts.iter().map(|part| part.object(&poses[part.thing]));
        Scene::new(objects.collect())
    }

    fn check_cameras(&self) -> Result<(), SynthError> {
        for frame in 0..self.frame_count() {
            let pose = self.true_world_from_left(frame);
            let scene = self.scene(frame);
            for (side, camera) in
                [("left", Camera::left(self.rig, &pose)), ("right", Camera::right(self.rig, &pose))]
            {
                if let Some(object) = scene.object_around(&camera.position()) {
                    let thing = scene.object(object).thing;
                    let name = self.contents.things[thing].name.as_deref().unwrap_or("without a name");
                    let found =
                        format!("the {side} camera of frame {frame} inside object {thing} ({name}; from 0)");
                    return Err(SynthError::value("stereo.mount_m", "cameras outside of all shapes", found));
                }
            }
        }
        Ok(())
    }
}

fn check_length(path: &Path, frame_count: usize, rate_hz: f64) -> Result<(), SynthError> {
    let (needed, duration) = ((frame_count - 1) as f64 / rate_hz, path.duration_s());
    if needed <= duration + 1e-6 {
        return Ok(());
    }
    let expected = format!("a way of at least {needed:.3} s for {frame_count} frames");
    let found = format!("{duration:.3} s; add way-points, a pause or fewer frames");
    Err(SynthError::value("trajectory.waypoints", expected, found))
}

#[cfg(test)]
#[path = "world_tests.rs"]
mod tests;
