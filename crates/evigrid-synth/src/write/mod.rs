//! A world on disk: a KITTI odometry sequence with the exact truth beside it.
//! docs/synthetic.md describes every file.

mod calibration;
mod error;
mod files;
mod folder;
mod frame;
mod tables;
mod truth;

use std::ops::Range;
use std::path::Path;

use evigrid_replay::map_from_world;
use rayon::prelude::*;

use crate::{SyntheticSequence, World};
use files::{create_folder, write_file};
use folder::{MARKER, PendingFolder};
use frame::FrameWriter;
use tables::BOARDS_HEADING;

pub use error::WriteError;

/// How far writing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteStep {
    /// A run that did not finish had left something beside the folder, which has been removed.
    LeftOver,
    /// The exact truth is next.
    Truth,
    /// So many frames are written.
    Frames {
        /// Frames that are.
        done: usize,
        /// Frames that will be.
        total: usize,
    },
}

/// Frames that are in memory at a time hold no more pixels than this together, unless it is one frame.
const PIXELS_AT_A_TIME: usize = 4_000_000;

/// Writes these frames of a world to the folder `dir`, numbered from 0: images, calibration, times, the poses
/// that the robot reports, laser scans, and the exact truth in `ground_truth/`. The folder has its name only
/// when all of it is on the disk; an earlier synthetic data set there is then replaced.
///
/// # Errors
/// If there are no such frames, if something else stands at `dir`, if a file cannot be written,
/// or if the robot stands on nothing at the first frame (of a world with a `[robot]`). Whatever
/// stood at `dir` is then still there.
pub fn write_data_set(
    world: &World,
    frames: Range<usize>,
    dir: &Path,
    progress: &mut dyn FnMut(WriteStep),
) -> Result<(), WriteError> {
    let frame_count = world.frame_count();
    if frames.is_empty() || frames.end > frame_count {
        return Err(WriteError::Frames { from: frames.start, to: frames.end, frame_count });
    }
    let (folder, left_over) = PendingFolder::open(dir)?;
    if left_over {
        progress(WriteStep::LeftOver);
    }
    write_texts(world, &frames, folder.path())?;
    progress(WriteStep::Truth);
    let map_from_world = map_from_world(&world.true_world_from_left(frames.start));
    truth::write_truth(world, &frames, &map_from_world, folder.path())?;
    write_frames(world, &frames, folder.path(), progress)?;
    folder.publish()
}

/// The folders and the text files.
fn write_texts(world: &World, frames: &Range<usize>, dir: &Path) -> Result<(), WriteError> {
    for folder in
        ["image_0", "image_1", "ground_truth/disparity", "ground_truth/occlusion", "ground_truth/surface"]
    {
        create_folder(&dir.join(folder))?;
    }
    if !world.lasers.is_empty() {
        create_folder(&dir.join("velodyne"))?;
    }
    let text = |what, name: &str, text: String| write_file(what, &dir.join(name), text.as_bytes());
    text("world", MARKER, world.text.clone())?;
    text("calibration", "calib.txt", calibration::calibration(world))?;
    text("times", "times.txt", calibration::times(frames.clone().map(|frame| world.stamp_ns(frame))))?;
    text("surfaces", "ground_truth/surfaces.csv", tables::surfaces(&world.contents.things))?;
    let poses = frames.clone().map(|frame| world.reported_world_from_left(frame));
    text("poses", "poses.txt", calibration::poses(poses))?;
    if world.has_pose_errors() {
        let poses = frames.clone().map(|frame| world.true_world_from_left(frame));
        text("true poses", "ground_truth/poses.txt", calibration::poses(poses))?;
    }
    Ok(())
}

/// The frames, a few at a time, and the table of what they show of boards.
fn write_frames(
    world: &World,
    frames: &Range<usize>,
    dir: &Path,
    progress: &mut dyn FnMut(WriteStep),
) -> Result<(), WriteError> {
    let sequence = SyntheticSequence::new(world.clone());
    let writer = FrameWriter { sequence: &sequence, world, dir };
    let pixels = world.rig.width * world.rig.height;
    let at_a_time = (PIXELS_AT_A_TIME / pixels).clamp(1, rayon::current_num_threads());
    let numbered: Vec<(usize, usize)> = frames.clone().enumerate().collect();
    let mut boards = String::from(BOARDS_HEADING);
    let (mut done, total) = (0, numbered.len());
    progress(WriteStep::Frames { done, total });
    for part in numbered.chunks(at_a_time) {
        let rows: Result<Vec<String>, WriteError> =
            part.par_iter().map(|&(number, frame)| writer.write(number, frame)).collect();
        boards.extend(rows?);
        done += part.len();
        progress(WriteStep::Frames { done, total });
    }
    write_file("boards", &dir.join("ground_truth/boards.csv"), boards.as_bytes())
}
