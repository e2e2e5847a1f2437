use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use tempfile::NamedTempFile;

use crate::files;

/// Ending of a file that is being written.
const PARTIAL: &str = ".partial";

/// The folder a run writes to. Every file is written under a temporary name beside its own, and all are
/// renamed at once when the last one is whole: a run that fails or is killed leaves the files of the run
/// before.
#[derive(Debug)]
pub struct ResultsFolder {
    dir: PathBuf,
    /// Whether a file of a name is one of those that are written here.
    is_ours: fn(&str) -> bool,
    /// The folder itself, locked against a second run; `None` where the system cannot lock folders.
    _lock: Option<fs::File>,
}

impl ResultsFolder {
    /// Opens the folder of a run, creating it if need be. Files that an unfinished run left there are
    /// removed; their names are returned, so that it can be said.
    ///
    /// # Errors
    /// If the folder cannot be created or written, or another run is writing to it.
    pub fn open(dir: &Path) -> Result<(Self, Vec<String>)> {
        Self::open_for(dir, files::is_of_run)
    }

    /// Opens the folder of a sweep, for its tables and curves, as [`Self::open`] does that of a run.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_sweep(dir: &Path) -> Result<(Self, Vec<String>)> {
        Self::open_for(dir, files::is_of_sweep)
    }

    fn open_for(dir: &Path, is_ours: fn(&str) -> bool) -> Result<(Self, Vec<String>)> {
        let failed = || format!("cannot write the results to {}", dir.display());
        fs::create_dir_all(dir).with_context(failed)?;
        let lock = fs::File::open(dir).ok();
        if let Some(Err(fs::TryLockError::WouldBlock)) = lock.as_ref().map(fs::File::try_lock) {
            bail!("expected a folder that no other run is writing to, found one at work: {}", dir.display());
        }
        let mut left_over = Vec::new();
        for entry in fs::read_dir(dir).with_context(failed)? {
            let entry = entry.with_context(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.strip_suffix(PARTIAL).is_some_and(is_ours) {
                let failed = || format!("cannot remove {}", entry.path().display());
                fs::remove_file(entry.path()).with_context(failed)?;
                left_over.push(name);
            }
        }
        left_over.sort();
        Ok((Self { dir: dir.to_owned(), is_ours, _lock: lock }, left_over))
    }

    /// Gives all files of a run their names, and removes those of an earlier run that this one does not
    /// write. Nothing is left to do but renaming, so there is no disk to fill up and next to no time to be
    /// killed in.
    ///
    /// # Errors
    /// If a file cannot be renamed or removed.
    pub fn publish(&self, files: Vec<SealedFile>) -> Result<()> {
        let names: Vec<_> = files.iter().filter_map(|f| f.path.file_name()).map(ToOwned::to_owned).collect();
        for file in files {
            file.publish()?;
        }
        let failed = || format!("cannot write the results to {}", self.dir.display());
        for entry in fs::read_dir(&self.dir).with_context(failed)? {
            let entry = entry.with_context(failed)?;
            let ours = (self.is_ours)(&entry.file_name().to_string_lossy());
            let stale = ours && !names.contains(&entry.file_name());
            if stale && entry.path().is_file() {
                fs::remove_file(entry.path()).with_context(failed)?;
            }
        }
        Ok(())
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Opens a file of the folder for writing, under its temporary name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(&self, name: &str) -> Result<PendingFile> {
        PendingFile::create(self.dir.join(name))
    }
}

/// A file that is being written. Dropped before [`Self::seal`], it leaves nothing behind.
#[derive(Debug)]
pub struct PendingFile {
    writer: BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl PendingFile {
    /// Opens `path` for writing, under its temporary name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(path: PathBuf) -> Result<Self> {
        let failed = || format!("cannot write {}", path.display());
        let dir = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = path.file_name().with_context(failed)?.to_string_lossy().into_owned();
        let mut builder = tempfile::Builder::new();
        builder.prefix(&name).suffix(PARTIAL).rand_bytes(0);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let file = builder.tempfile_in(dir).map_err(|e| anyhow!(e)).with_context(failed)?;
        Ok(Self { writer: BufWriter::new(file), path })
    }

    /// The name the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Ends writing: all of the file is on the disk, still under its temporary name.
    ///
    /// # Errors
    /// If what was written does not reach the disk.
    pub fn seal(self) -> Result<SealedFile> {
        let path = self.path;
        let failed = || format!("cannot write {}", path.display());
        let file = self.writer.into_inner().map_err(io::IntoInnerError::into_error).with_context(failed)?;
        file.as_file().sync_all().with_context(failed)?;
        Ok(SealedFile { file, path })
    }

    /// Message of a failed write to this file.
    pub fn failed(&self) -> String {
        format!("cannot write {}", self.path.display())
    }
}

/// A whole file that waits for its name. Dropped before [`Self::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct SealedFile {
    file: NamedTempFile,
    path: PathBuf,
}

impl SealedFile {
    /// Gives the file its name.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn publish(self) -> Result<()> {
        let failed = format!("cannot write {}", self.path.display());
        self.file.persist(&self.path).map_err(|e| e.error).context(failed)?;
        Ok(())
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl io::Seek for PendingFile {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.writer.seek(to)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn names(dir: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_has_its_name_only_when_it_is_whole() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a.csv"), "old").unwrap();
        let (folder, left_over) = ResultsFolder::open(dir.path()).unwrap();
        assert!(left_over.is_empty());
        let mut file = folder.create("a.csv").unwrap();
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a.csv")).unwrap(), "old");
        assert_eq!(names(dir.path()), ["a.csv", "a.csv.partial"]);
        let sealed = file.seal().unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a.csv")).unwrap(), "old");
        sealed.publish().unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a.csv")).unwrap(), "new");
        drop(folder.create("b.csv").unwrap());
        assert_eq!(names(dir.path()), ["a.csv"], "a file that fails leaves nothing behind");
    }

    #[test]
    fn what_a_killed_run_left_is_named_and_removed() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("frames.csv.partial"), "half").unwrap();
        let (folder, left_over) = ResultsFolder::open(dir.path()).unwrap();
        assert_eq!(left_over, ["frames.csv.partial"]);
        folder.publish(vec![folder.create("frames.csv").unwrap().seal().unwrap()]).unwrap();
        assert_eq!(names(folder.dir()), ["frames.csv"]);
    }

    #[test]
    fn only_files_of_runs_are_ever_removed() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["holiday.mp4.partial", "notes.csv", "map.mine.txt", "truth.npz", "map.old-method.npz"] {
            fs::write(dir.path().join(name), "").unwrap();
        }
        let (folder, left_over) = ResultsFolder::open(dir.path()).unwrap();
        assert!(left_over.is_empty());
        folder.publish(vec![folder.create("frames.csv").unwrap().seal().unwrap()]).unwrap();
        let expected = ["frames.csv", "holiday.mp4.partial", "map.mine.txt", "notes.csv"];
        assert_eq!(
            names(dir.path()),
            expected,
            "what this run did not write is gone, what is not ours stays"
        );
    }

    #[test]
    fn a_second_run_into_the_same_folder_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let first = ResultsFolder::open(dir.path()).unwrap();
        assert!(ResultsFolder::open(dir.path()).unwrap_err().to_string().contains("no other run"));
        drop(first);
        assert!(ResultsFolder::open(dir.path()).is_ok());
    }

    #[test]
    fn an_unwritable_folder_is_named() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("file"), "").unwrap();
        let below_a_file = dir.path().join("file/out");
        let message = format!("{:#}", ResultsFolder::open(&below_a_file).unwrap_err());
        assert!(message.contains("file/out"), "{message}");
    }
}
