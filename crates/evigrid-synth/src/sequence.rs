use std::path::PathBuf;

use evigrid_core::{CoreError, Frame, GrayImage, LaserScan, Pose};
use evigrid_replay::{ReplayError, Sequence, SequenceInfo};
use rayon::prelude::*;

use crate::World;
use crate::camera::Camera;
use crate::laser::{Laser, Place, Sweep};
use crate::random::{Sensor, stream};
use crate::render::Renderer;
use crate::scene::Scene;

/// A synthetic world as a recording: every frame is rendered when it is asked for, with all its rows in
/// parallel on the current rayon pool.
#[derive(Debug, Clone)]
pub struct SyntheticSequence {
    world: World,
    info: SequenceInfo,
}

impl SyntheticSequence {
    /// The recording of a world.
    pub fn new(world: World) -> Self {
        let info = SequenceInfo {
            id: world.name.clone(),
            layout: "synthetic",
            rig: world.rig,
            frame_count: world.frame_count(),
            mounting: world.mounting(),
        };
        Self { world, info }
    }

    /// Where the recording is, for messages.
    fn place(&self) -> PathBuf {
        PathBuf::from(format!("synth:{}", self.info.id))
    }

    fn misfit(&self, index: usize, source: CoreError) -> ReplayError {
        ReplayError::Frame { index, source, path: self.place() }
    }

    fn require(&self, index: usize) -> Result<(), ReplayError> {
        let frame_count = self.info.frame_count;
        if index < frame_count {
            return Ok(());
        }
        Err(ReplayError::NoSuchFrame { index, frame_count, path: self.place() })
    }

    fn render(&self, index: usize, map_from_world: &Pose) -> Result<Frame, CoreError> {
        let (world, rig) = (&self.world, self.world.rig);
        let scene = world.scene(index);
        let renderer = Renderer::new(&scene, &world.materials, &world.light);
        let world_from_left = world.true_world_from_left(index);
        Frame::new(
            index,
            world.stamp_ns(index),
            rig,
            self.photograph(&renderer, &Camera::left(rig, &world_from_left), index, Sensor::Left)?,
            self.photograph(&renderer, &Camera::right(rig, &world_from_left), index, Sensor::Right)?,
            map_from_world * world.reported_world_from_left(index),
            self.scan(&scene, index, map_from_world)?,
        )
    }

    fn photograph(
        &self,
        renderer: &Renderer<'_>,
        camera: &Camera,
        frame: usize,
        sensor: Sensor,
    ) -> Result<GrayImage, CoreError> {
        let world = &self.world;
        let light = renderer.image(camera);
        let (width, height) = camera.size();
        let exposure = world.exposures[frame];
        let mut pixels = vec![0; light.len()];
        pixels.par_chunks_mut(width).zip(light.par_chunks(width)).enumerate().for_each(
            |(y, (pixels, light))| {
                let mut rng = stream(world.seed, frame, sensor, y);
                for (x, (pixel, &grey)) in pixels.iter_mut().zip(light).enumerate() {
                    let light = f64::from(grey) * exposure * world.noise.transmission(&world.rig, x, y);
                    // A cast from float to integer stops at the ends of the range.
                    *pixel = (world.noise.measure(light, &mut rng) + 0.5) as u8;
                }
            },
        );
        GrayImage::new(width, height, pixels)
    }

    /// The scans of all scanners that are due, in the frame of the first scanner of the world.
    fn scan(
        &self,
        scene: &Scene,
        frame: usize,
        map_from_world: &Pose,
    ) -> Result<Option<LaserScan>, CoreError> {
        let world = &self.world;
        let time_s = world.time_s(frame);
        let before_s = frame.checked_sub(1).map(|before| world.time_s(before));
        let world_from_body = |delay_s: f64| world.world_from_body(time_s + delay_s);
        let mut due = world.lasers.iter().enumerate().filter(|(_, l)| l.is_due(time_s, before_s)).peekable();
        let (Some(first), true) = (world.lasers.first(), due.peek().is_some()) else { return Ok(None) };
        let mut all = Sweep::default();
        for (scanner, laser) in due {
            let seed = world.seed;
            let sweep =
                laser.sweep(&Place { scene, world_from_body: &world_from_body, seed, frame, scanner });
            all.extend(sweep, &first_from(first, laser, scanner));
        }
        let map_from_first = map_from_world * world.reported_world_from_laser(frame, first);
        let scan = LaserScan::new(all.points, map_from_first)?;
        if all.origins.iter().all(|origin| *origin == [0.0; 3]) {
            return Ok(Some(scan));
        }
        scan.with_origins(all.origins).map(Some)
    }
}

/// Pose of a scanner in the frame of the first one, free of rounding where it is that one.
fn first_from(first: &Laser, laser: &Laser, scanner: usize) -> Pose {
    if scanner == 0 {
        return Pose::identity();
    }
    first.body_from_laser().inverse() * laser.body_from_laser()
}

impl Sequence for SyntheticSequence {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        self.require(index)?;
        Ok(self.world.reported_world_from_left(index))
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        self.require(index)?;
        self.render(index, map_from_world).map_err(|source| self.misfit(index, source))
    }

    fn laser(&self, index: usize, map_from_world: &Pose) -> Result<Option<LaserScan>, ReplayError> {
        self.require(index)?;
        let scan = self.scan(&self.world.scene(index), index, map_from_world);
        scan.map_err(|source| self.misfit(index, source))
    }
}
