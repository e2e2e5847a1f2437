use std::path::PathBuf;

/// Why a recording could not be read. The message says what failed first, what was expected and found, and the
/// path last.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A file or folder that cannot be read at all.
    #[error("cannot read {what}: {source}: {}", path.display())]
    Io {
        /// What was being read.
        what: &'static str,
        /// Where.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file that cannot be written.
    #[error("cannot write {what}: {source}: {}", path.display())]
    Write {
        /// What was being written.
        what: &'static str,
        /// Where.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file whose content is not what it should be.
    #[error("{what}: expected {expected}, found {found}: {}{place}", path.display())]
    Content {
        /// What was being read.
        what: String,
        /// What should be there.
        expected: String,
        /// What is there.
        found: String,
        /// The file.
        path: PathBuf,
        /// Line or byte within it, as `:7` or ` at byte 16`; empty for the whole file.
        place: String,
    },
    /// A frame number outside the recording.
    #[error("frame {index} does not exist: expected 0..{frame_count}: {}", path.display())]
    NoSuchFrame {
        /// The frame asked for.
        index: usize,
        /// How many there are.
        frame_count: usize,
        /// The recording.
        path: PathBuf,
    },
    /// A frame whose parts do not fit together.
    #[error("frame {index}: {source}: {}", path.display())]
    Frame {
        /// The frame.
        index: usize,
        /// What does not fit.
        source: evigrid_core::CoreError,
        /// The recording or the file at fault.
        path: PathBuf,
    },
}
