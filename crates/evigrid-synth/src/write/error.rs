use std::io;
use std::path::PathBuf;

use evigrid_core::CoreError;
use evigrid_replay::ReplayError;

use crate::SynthError;

/// Why a data set could not be written. The message is one line and ends with the path.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A file or folder that cannot be written.
    #[error("cannot write {what}: {source}: {}", path.display())]
    Io {
        /// The thing that was being written.
        what: &'static str,
        /// Its path.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// A folder that must not be replaced.
    #[error("output folder: expected {expected}, found {found}: {}", path.display())]
    Folder {
        /// A folder that would do.
        expected: &'static str,
        /// The thing that is there.
        found: String,
        /// The folder.
        path: PathBuf,
    },
    /// Frames that the world does not have.
    #[error("frames: expected at least one within 0..{frame_count}, found {from}..{to}")]
    Frames {
        /// The first frame asked for.
        from: usize,
        /// The first frame not asked for.
        to: usize,
        /// How many there are.
        frame_count: usize,
    },
    /// A frame that cannot be rendered, or a disparity image that cannot be written.
    #[error(transparent)]
    Frame(#[from] ReplayError),
    /// A robot that stands on nothing.
    #[error(transparent)]
    World(#[from] SynthError),
    /// A truth that is impossible.
    #[error("exact truth of frame {frame}: {source}")]
    Truth {
        /// The frame.
        frame: usize,
        /// The fault.
        source: CoreError,
    },
}
