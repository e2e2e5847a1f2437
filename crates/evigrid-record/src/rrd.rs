//! A .rrd file that is written by us: every call is encoded on the spot, so that a failed write is an error
//! of the call that made it, no data is left in memory, and equal runs give equal messages.
//!
//! The file ends with an index of its rows, without which `rerun rrd verify` calls it incomplete. The encoder
//! keeps that index until the end (some 160 bytes a row) and writes its parts in random order.

use std::io::Write;
use std::path::PathBuf;

use anyhow::{Context, Result};
use evigrid_results::{PendingFile, SealedFile};
use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{Encoder, EncodingOptions};
use rerun::external::re_log_types::{BlueprintActivationCommand, SetStoreInfo, StoreInfo, StoreSource};
use rerun::external::re_tuid::Tuid;
use rerun::log::{Chunk, ChunkId, LogMsg, RowId};
use rerun::{AsComponents, EntityPath, StoreId, StoreKind, TimePoint};

/// Under which all recordings and layouts of this project are filed in the viewer.
const APPLICATION: &str = "evigrid";

/// Entities of one recording, or of one layout, within a file.
#[derive(Debug)]
pub(crate) struct Store {
    id: StoreId,
    /// Upper half of all identifiers of the store, and how many have been given out.
    stem: u64,
    given_out: u64,
}

impl Store {
    /// A store whose identifiers depend on `seed` alone. Stores of different seeds can be open in one viewer.
    pub fn new(kind: StoreKind, seed: u64) -> Self {
        let id = StoreId::new(kind, APPLICATION, format!("{seed:016x}"));
        // Viewers read the stem as a moment in time: keep it in the range of signed nanoseconds.
        Self { id, stem: (seed >> 2) ^ u64::from(kind == StoreKind::Blueprint), given_out: 0 }
    }

    /// The part of the identifiers that all of this store share and those of other stores do not.
    pub fn stem(&self) -> u64 {
        self.stem
    }

    fn next_id(&mut self) -> Tuid {
        self.given_out += 1;
        Tuid::from_nanos_and_inc(self.stem, self.given_out)
    }
}

/// A .rrd stream into `W`. It is whole only after [`Self::finish`].
pub(crate) struct Rrd<W: Write> {
    /// Taken when the stream ends or is given up.
    encoder: Option<Encoder<W>>,
    /// The message of a failure.
    failed: String,
}

impl<W: Write> std::fmt::Debug for Rrd<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rrd").finish_non_exhaustive()
    }
}

impl Rrd<PendingFile> {
    /// Opens a file under its temporary name.
    pub fn create(path: PathBuf) -> Result<Self> {
        let file = PendingFile::create(path)?;
        let failed = file.failed();
        Self::new(file, failed)
    }

    /// Ends the stream and gives the file its name.
    pub fn seal(self) -> Result<SealedFile> {
        self.finish()?.seal()
    }
}

impl<W: Write> Rrd<W> {
    pub fn new(write: W, failed: String) -> Result<Self> {
        let encoder = Encoder::new_eager(CrateVersion::LOCAL, EncodingOptions::PROTOBUF_COMPRESSED, write);
        Ok(Self { encoder: Some(encoder.with_context(|| failed.clone())?), failed })
    }

    /// Must come before anything of the store.
    pub fn open(&mut self, store: &mut Store) -> Result<()> {
        let source = StoreSource::Other(APPLICATION.into());
        let info = StoreInfo::new_unversioned(store.id.clone(), source);
        self.append(&LogMsg::SetStoreInfo(SetStoreInfo { row_id: store.next_id(), info }))
    }

    /// One row: the components of `what` at `path`, valid from `at` on. An empty `at` means always.
    pub fn log(
        &mut self,
        store: &mut Store,
        path: impl Into<EntityPath>,
        at: &TimePoint,
        what: &dyn AsComponents,
    ) -> Result<()> {
        let row = RowId::from_tuid(store.next_id());
        let chunk = Chunk::builder_with_id(ChunkId::from_tuid(store.next_id()), path)
            .with_archetype(row, at.clone(), what)
            .build()
            .and_then(|chunk| chunk.to_arrow_msg())
            .with_context(|| self.failed.clone())?;
        self.append(&LogMsg::ArrowMsg(store.id.clone(), chunk))
    }

    /// Makes a layout, all of which has been logged, the one that the file opens with.
    pub fn activate(&mut self, blueprint: &Store) -> Result<()> {
        let command = BlueprintActivationCommand {
            blueprint_id: blueprint.id.clone(),
            make_active: true,
            make_default: true,
        };
        self.append(&LogMsg::BlueprintActivationCommand(command))
    }

    /// Ends the stream and gives back what it was written to.
    pub fn finish(mut self) -> Result<W> {
        let mut encoder = self.encoder.take().with_context(|| self.failed.clone())?;
        let ended = encoder.finish();
        let write = encoder.into_inner().with_context(|| self.failed.clone())?;
        ended.with_context(|| self.failed.clone())?;
        Ok(write)
    }

    fn append(&mut self, message: &LogMsg) -> Result<()> {
        let encoder = self.encoder.as_mut().with_context(|| self.failed.clone())?;
        encoder.append(message).with_context(|| self.failed.clone())?;
        Ok(())
    }
}

/// A stream that is given up is not ended: the encoder would write its end, and complain if it cannot.
impl<W: Write> Drop for Rrd<W> {
    fn drop(&mut self) {
        drop(self.encoder.take().map(Encoder::into_inner));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use rerun::external::re_log_encoding::DecoderApp;
    use rerun::{TextDocument, TimeCell};
    use std::io;

    /// Two documents, one of them static.
    fn logged<W: Write>(write: W, seed: u64) -> Result<Rrd<W>> {
        let mut rrd = Rrd::new(write, "cannot write there".into())?;
        let mut store = Store::new(StoreKind::Recording, seed);
        rrd.open(&mut store)?;
        rrd.log(&mut store, "a/b", &TimePoint::default(), &TextDocument::new("always"))?;
        let at = TimePoint::default().with_index("frame", TimeCell::from_sequence(7));
        rrd.log(&mut store, "c", &at, &TextDocument::new("x".repeat(10_000)))?;
        Ok(rrd)
    }

    fn stream<W: Write>(write: W, seed: u64) -> Result<W> {
        logged(write, seed)?.finish()
    }

    #[test]
    fn what_is_logged_can_be_read() {
        let bytes = stream(Vec::new(), 5).unwrap();
        let messages: Vec<_> =
            DecoderApp::decode_eager(bytes.as_slice()).unwrap().map(Result::unwrap).collect();
        assert!(matches!(&messages[0], LogMsg::SetStoreInfo(_)));
        let chunks: Vec<_> = messages[1..]
            .iter()
            .map(|message| match message {
                LogMsg::ArrowMsg(_, chunk) => Chunk::from_arrow_msg(chunk).unwrap(),
                other => panic!("{other:?}"),
            })
            .collect();
        let seen: Vec<_> =
            chunks.iter().map(|c| (c.entity_path().to_string(), c.num_rows(), c.is_static())).collect();
        assert_eq!(seen, [("/a/b".to_owned(), 1, true), ("/c".to_owned(), 1, false)]);
    }

    #[test]
    fn equal_streams_have_equal_messages() {
        let messages = |seed: u64| {
            let mut rrd = logged(Vec::new(), seed).unwrap();
            rrd.encoder.take().unwrap().into_inner().unwrap()
        };
        assert!(messages(5) == messages(5));
        assert!(messages(5) != messages(6));
    }

    /// A disk with room for so many bytes.
    struct Disk(usize);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let room = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            self.0 = room;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_one_error_wherever_it_happens() {
        let needed = stream(Vec::new(), 5).unwrap().len();
        assert!(stream(Disk(needed), 5).is_ok());
        for room in (0..needed).step_by(50) {
            let message = format!("{:#}", stream(Disk(room), 5).map(|_| ()).unwrap_err());
            assert!(message.starts_with("cannot write there: ") && !message.contains('\n'), "{message}");
        }
    }
}
