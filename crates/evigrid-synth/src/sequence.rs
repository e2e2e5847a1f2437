use std::path::PathBuf;

use evigrid_core::{CoreError, Frame, GrayImage, LaserScan, Pose};
use evigrid_replay::{ReplayError, Sequence, SequenceInfo};
use rayon::prelude::*;

use crate::World;
use crate::camera::Camera;
use crate::random::{Sensor, normal, stream};
use crate::render::View;

/// A synthetic world as a recording: every frame is rendered when it is asked for, with all its rows in parallel
/// on the current rayon pool.
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
            frame_count: world.frame_count,
        };
        Self { world, info }
    }

    /// Where the recording is, for messages.
    fn place(&self) -> PathBuf {
        PathBuf::from(format!("synth:{}", self.info.id))
    }

    fn require(&self, index: usize) -> Result<(), ReplayError> {
        let frame_count = self.info.frame_count;
        if index < frame_count {
            return Ok(());
        }
        Err(ReplayError::NoSuchFrame { index, frame_count, path: self.place() })
    }

    fn render(&self, index: usize, map_from_world: &Pose) -> Result<Frame, CoreError> {
        let world_from_left = self.world.world_from_left(index);
        let rig = self.world.rig;
        Frame::new(
            index,
            self.world.stamp_ns(index),
            rig,
            self.photograph(&Camera::left(rig, &world_from_left), index, Sensor::Left)?,
            self.photograph(&Camera::right(rig, &world_from_left), index, Sensor::Right)?,
            map_from_world * world_from_left,
            self.scan(index, map_from_world)?,
        )
    }

    fn photograph(&self, camera: &Camera, frame: usize, sensor: Sensor) -> Result<GrayImage, CoreError> {
        let world = &self.world;
        let exposed = View { scene: &world.scene, light: &world.light }.image(camera);
        let (width, height) = camera.size();
        let mut pixels = vec![0; exposed.len()];
        pixels.par_chunks_mut(width).zip(exposed.par_chunks(width)).enumerate().for_each(
            |(row, (pixels, exposed))| {
                let mut rng = stream(world.seed, frame, sensor, row);
                for (pixel, grey) in pixels.iter_mut().zip(exposed) {
                    let noisy = f64::from(*grey) + world.noise_grey * normal(&mut rng);
                    // A cast from float to integer stops at the ends of the range.
                    *pixel = (noisy + 0.5) as u8;
                }
            },
        );
        GrayImage::new(width, height, pixels)
    }

    fn scan(&self, frame: usize, map_from_world: &Pose) -> Result<Option<LaserScan>, CoreError> {
        let world = &self.world;
        let sweep = |laser: &crate::laser::Laser| {
            let world_from_laser = world.world_from_body(frame) * laser.body_from_laser();
            let points = laser.sweep(&world.scene, &world_from_laser, world.seed, frame);
            LaserScan::new(points, map_from_world * world_from_laser)
        };
        world.laser.as_ref().map(sweep).transpose()
    }
}

impl Sequence for SyntheticSequence {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        self.require(index)?;
        Ok(self.world.world_from_left(index))
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        self.require(index)?;
        self.render(index, map_from_world).map_err(|source| ReplayError::Frame {
            index,
            source,
            path: self.place(),
        })
    }
}
