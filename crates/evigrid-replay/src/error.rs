use std::path::PathBuf;

/// Why a recording could not be read. The message says what failed first, what was expected and found, and
/// the path last.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A file or folder that cannot be read at all.
    #[error("cannot read {what}: {source}: {}", path.display())]
    Io {
        /// Name of the thing that was being read, e.g. `time stamps`.
        what: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A file that cannot be written.
    #[error("cannot write {what}: {source}: {}", path.display())]
    Write {
        /// Name of the thing that was being written, e.g. `disparity image`.
        what: &'static str,
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A file whose content is not what it should be.
    #[error("{what}: expected {expected}, found {found}: {}{place}", path.display())]
    Content {
        /// Name of the thing that was being read, e.g. `laser scan`.
        what: String,
        /// Content that should be there.
        expected: String,
        /// Content that is there.
        found: String,
        /// Path of the file.
        path: PathBuf,
        /// Line or byte within it, as `:7` or ` at byte 16`; empty for the whole file.
        place: String,
    },
    /// A frame number outside the recording.
    #[error("frame {index} does not exist: expected 0..{frame_count}: {}", path.display())]
    NoSuchFrame {
        /// Number of the frame that was asked for.
        index: usize,
        /// Number of frames in the recording.
        frame_count: usize,
        /// Folder of the recording.
        path: PathBuf,
    },
    /// A frame whose parts do not fit together.
    #[error("frame {index}: {source}: {}", path.display())]
    Frame {
        /// Number of the frame.
        index: usize,
        /// Misfit of the parts.
        source: evigrid_core::CoreError,
        /// Path of the recording or the file at fault.
        path: PathBuf,
    },
}
