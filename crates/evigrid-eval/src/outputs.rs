use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use tempfile::NamedTempFile;

/// Ending of a file that is being written.
const PARTIAL: &str = ".partial";

/// The folder a run writes to. Every file is written under a temporary name beside its own and renamed when it is
/// whole, so that a run killed at any moment leaves either the old file or the new one.
#[derive(Debug)]
pub struct ResultsFolder {
    dir: PathBuf,
}

impl ResultsFolder {
    /// Opens the folder, creating it if need be. What a run that did not finish left there is removed; its names are
    /// returned, so that it can be said.
    ///
    /// # Errors
    /// If the folder cannot be created or written.
    pub fn open(dir: &Path) -> Result<(Self, Vec<String>)> {
        let failed = || format!("cannot write the results to {}", dir.display());
        fs::create_dir_all(dir).with_context(failed)?;
        let mut left_over = Vec::new();
        for entry in fs::read_dir(dir).with_context(failed)? {
            let entry = entry.with_context(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(PARTIAL) {
                fs::remove_file(entry.path()).with_context(failed)?;
                left_over.push(name);
            }
        }
        left_over.sort();
        Ok((Self { dir: dir.to_owned() }, left_over))
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

/// A file that gets its name when it is whole. Dropped before [`Self::commit`], it leaves nothing behind.
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

    /// Gives the file its name.
    ///
    /// # Errors
    /// If what was written does not reach the disk.
    pub fn commit(self) -> Result<()> {
        let path = self.path;
        let failed = || format!("cannot write {}", path.display());
        let file = self.writer.into_inner().map_err(io::IntoInnerError::into_error).with_context(failed)?;
        file.as_file().sync_all().with_context(failed)?;
        file.persist(&path).map_err(|e| e.error).with_context(failed)?;
        Ok(())
    }

    /// What a failed write to this file is to be called.
    pub fn failed(&self) -> String {
        format!("cannot write {}", self.path.display())
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
        file.commit().unwrap();
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
        folder.create("frames.csv").unwrap().commit().unwrap();
        assert_eq!(names(folder.dir()), ["frames.csv"]);
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
