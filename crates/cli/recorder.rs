use std::path::PathBuf;

use anyhow::Result;
use evigrid_eval::Observer;

/// Opens what records a run into a file; `None`, with a warning, if the program was built without recordings.
///
/// # Errors
/// If the file cannot be created.
#[cfg(feature = "rerun")]
pub fn open_recorder(path: PathBuf) -> Result<Option<Box<dyn Observer>>> {
    Ok(Some(Box::new(evigrid_record::Recorder::create(path)?)))
}

/// Opens what records a run into a file; `None`, with a warning, if the program was built without recordings.
///
/// # Errors
/// Never: nothing is opened.
#[cfg(not(feature = "rerun"))]
pub fn open_recorder(path: PathBuf) -> Result<Option<Box<dyn Observer>>> {
    log::warn!("built without the feature `rerun`: no recording is written to {}", path.display());
    Ok(None)
}
