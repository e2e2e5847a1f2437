use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use evigrid_core::{Pose, name_hint};
use evigrid_replay::{ReplayError, Sequence, find_dataset, map_from_world};
use evigrid_synth::{SyntheticSequence, World};

/// A recording, and the world behind it if it is synthetic: then its exact truth is known.
pub struct Recording {
    sequence: Box<dyn Sequence>,
    world: Option<World>,
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recording").field("info", self.sequence.info()).finish_non_exhaustive()
    }
}

impl From<Box<dyn Sequence>> for Recording {
    fn from(sequence: Box<dyn Sequence>) -> Self {
        Self { sequence, world: None }
    }
}

impl From<World> for Recording {
    fn from(world: World) -> Self {
        Self { sequence: Box::new(SyntheticSequence::new(world.clone())), world: Some(world) }
    }
}

impl Recording {
    /// Opens a data set: `synth:NAME`, a folder, or the name of a known data set below [`data_root`].
    ///
    /// # Errors
    /// If there is no such world, folder or data set, or it cannot be read.
    pub fn open(name: &str) -> Result<Self> {
        if let Some(world) = name.strip_prefix("synth:") {
            return Ok(World::open(world)?.into());
        }
        let path = Path::new(name);
        if path.exists() {
            return Ok(evigrid_replay::open(path)?.into());
        }
        let Some(known) = find_dataset(name)? else {
            let known = evigrid_replay::datasets()?.into_iter().map(|d| d.id);
            let worlds = World::builtin_names().map(|w| format!("synth:{w}"));
            let hint = name_hint(name, worlds.chain(known));
            bail!("no such data set: expected a folder or a known name, found `{name}`{hint}");
        };
        let opened = evigrid_replay::open(&known.dir_below(&data_root()));
        let opened = opened.with_context(|| {
            format!("data set {name} is not here (scripts/download_datasets.sh {name} fetches it)")
        });
        Ok(opened?.into())
    }

    /// The frames.
    pub fn sequence(&self) -> &dyn Sequence {
        self.sequence.as_ref()
    }

    /// The world, if the recording is synthetic.
    pub fn world(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// From the recording's world to the map frame of a run over these frames, at least one.
    pub(crate) fn map_frame(&self, frames: &[usize]) -> Result<Pose, ReplayError> {
        Ok(map_from_world(&self.sequence.world_from_left(frames[0])?))
    }
}

/// Where data sets are looked for by name: the folder in the environment variable EVIGRID_DATA, else `data`.
pub fn data_root() -> PathBuf {
    std::env::var_os("EVIGRID_DATA").map_or_else(|| PathBuf::from("data"), PathBuf::from)
}
