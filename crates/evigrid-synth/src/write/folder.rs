//! The folder of a data set, which has its name only when the last file is whole.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use super::error::WriteError;

/// The file that tells an earlier synthetic data set from anything else.
pub const MARKER: &str = "ground_truth/world.toml";

/// Everything that a data set has at its top.
const NAMES: [&str; 8] = [
    "calib.txt",
    "ground_truth",
    "image_0",
    "image_1",
    "poses.txt",
    "times.txt",
    "velodyne",
    "velodyne_origins",
];

/// A data set that is being written, in a hidden folder beside its place. Dropped before [`Self::publish`],
/// it leaves nothing behind; a killed run leaves the hidden folder, which the next one removes.
#[derive(Debug)]
pub struct PendingFolder {
    /// Where the data set will be.
    dir: PathBuf,
    /// Where it is.
    partial: PathBuf,
    /// Where an earlier one waits for the new one to be in place.
    replaced: PathBuf,
    /// Locked against a second run.
    _lock: File,
}

impl PendingFolder {
    /// Opens the hidden folder beside `dir`, creating it if need be. Gives also whether a run that did not
    /// finish had left something there.
    ///
    /// # Errors
    /// If something that is no synthetic data set stands at `dir`, another run is writing there, or the
    /// hidden folder cannot be created.
    pub fn open(dir: &Path) -> Result<(Self, bool), WriteError> {
        // A link stays where it is; what it leads to is replaced.
        let dir = fs::canonicalize(dir).unwrap_or_else(|_| dir.to_owned());
        let [partial, replaced] = ["partial", "replaced"].map(|ending| hidden(&dir, ending));
        let (partial, replaced) = (partial?, replaced?);
        put_back(&replaced, &dir)?;
        require_replaceable(&dir)?;
        fs::create_dir_all(&partial).map_err(|e| failed(&dir, e))?;
        let lock = File::open(&partial).map_err(|e| failed(&dir, e))?;
        if let Err(TryLockError::WouldBlock) = lock.try_lock() {
            let expected = "a folder that no other run is writing to";
            return Err(WriteError::Folder { expected, found: "one at work".to_owned(), path: dir });
        }
        let left_over = is_empty(&partial).map(|empty| !empty).map_err(|e| failed(&dir, e))?;
        if left_over {
            clear(&partial).map_err(|e| failed(&dir, e))?;
        }
        Ok((Self { dir, partial, replaced, _lock: lock }, left_over))
    }

    /// Where files are to be written.
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Gives the data set its name, in place of an earlier one.
    ///
    /// # Errors
    /// If something else has appeared there, or a folder cannot be renamed or removed.
    pub fn publish(self) -> Result<(), WriteError> {
        require_replaceable(&self.dir)?;
        let was_there = self.dir.exists();
        if was_there {
            fs::rename(&self.dir, &self.replaced).map_err(|e| failed(&self.dir, e))?;
        }
        if let Err(error) = fs::rename(&self.partial, &self.dir) {
            put_back(&self.replaced, &self.dir)?;
            return Err(failed(&self.dir, error));
        }
        if was_there {
            fs::remove_dir_all(&self.replaced).map_err(|e| failed(&self.replaced, e))?;
        }
        Ok(())
    }
}

impl Drop for PendingFolder {
    fn drop(&mut self) {
        // Gone if it has been published; nothing more can be done if it cannot be removed.
        let _ = fs::remove_dir_all(&self.partial);
    }
}

/// The hidden folder of this ending beside `dir`.
fn hidden(dir: &Path, ending: &str) -> Result<PathBuf, WriteError> {
    let Some(name) = dir.file_name() else {
        let expected = "the name of a folder";
        return Err(WriteError::Folder { expected, found: "none".to_owned(), path: dir.to_owned() });
    };
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".evigrid-{ending}"));
    Ok(dir.with_file_name(hidden))
}

/// Undoes the half of [`PendingFolder::publish`] that a killed run may have done.
fn put_back(replaced: &Path, dir: &Path) -> Result<(), WriteError> {
    if !replaced.exists() {
        return Ok(());
    }
    let undone = if dir.exists() { fs::remove_dir_all(replaced) } else { fs::rename(replaced, dir) };
    undone.map_err(|e| failed(replaced, e))
}

/// `Ok` if there is nothing at `dir`, an empty folder, or an earlier data set and nothing else.
fn require_replaceable(dir: &Path) -> Result<(), WriteError> {
    let refused = |found: String| {
        let expected = "a new or empty folder, or one that `evigrid synth` wrote";
        WriteError::Folder { expected, found, path: dir.to_owned() }
    };
    if !dir.exists() {
        return Ok(());
    }
    if !dir.is_dir() {
        return Err(refused("a file".to_owned()));
    }
    let is_ours = dir.join(MARKER).is_file();
    for entry in fs::read_dir(dir).map_err(|e| failed(dir, e))? {
        let name = entry.map_err(|e| failed(dir, e))?.file_name();
        if !is_ours || !NAMES.iter().any(|known| name == *known) {
            return Err(refused(format!("{:?} in it", name.to_string_lossy())));
        }
    }
    Ok(())
}

fn is_empty(dir: &Path) -> std::io::Result<bool> {
    Ok(fs::read_dir(dir)?.next().is_none())
}

fn clear(dir: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(dir)? {
        let path = entry?.path();
        if path.is_dir() { fs::remove_dir_all(path)? } else { fs::remove_file(path)? }
    }
    Ok(())
}

fn failed(path: &Path, source: std::io::Error) -> WriteError {
    WriteError::Io { what: "output folder", path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(dir: &Path) -> Vec<String> {
        let entries = fs::read_dir(dir).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn data_set(dir: &Path, text: &str) {
        fs::create_dir_all(dir.join("ground_truth")).unwrap();
        fs::write(dir.join(MARKER), text).unwrap();
    }

    fn refusal(dir: &Path) -> String {
        let error = PendingFolder::open(dir).unwrap_err().to_string();
        error.replace(&format!("{}", dir.display()), "DIR")
    }

    #[test]
    fn a_data_set_has_its_name_only_when_it_is_whole() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("world");
        data_set(&dir, "old");
        let (pending, left_over) = PendingFolder::open(&dir).unwrap();
        assert!(!left_over);
        data_set(pending.path(), "half");
        drop(pending);
        assert_eq!(names(root.path()), ["world"]);
        assert_eq!(fs::read_to_string(dir.join(MARKER)).unwrap(), "old");
        let (pending, _) = PendingFolder::open(&dir).unwrap();
        data_set(pending.path(), "new");
        pending.publish().unwrap();
        assert_eq!(names(root.path()), ["world"]);
        assert_eq!(fs::read_to_string(dir.join(MARKER)).unwrap(), "new");
    }

    #[test]
    fn new_and_empty_folders_will_do() {
        let root = tempfile::tempdir().unwrap();
        let empty = root.path().join("empty");
        fs::create_dir(&empty).unwrap();
        for dir in [&empty, &root.path().join("a/b/new")] {
            let (pending, _) = PendingFolder::open(dir).unwrap();
            data_set(pending.path(), "new");
            pending.publish().unwrap();
            assert_eq!(names(dir), ["ground_truth"]);
        }
    }

    #[test]
    fn what_is_not_ours_is_never_replaced() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("photos");
        fs::create_dir(&dir).unwrap();
        fs::write(dir.join("image_0"), "").unwrap();
        let expected =
            "output folder: expected a new or empty folder, or one that `evigrid synth` wrote, found ";
        assert_eq!(refusal(&dir), format!("{expected}\"image_0\" in it: DIR"));
        fs::remove_file(dir.join("image_0")).unwrap();
        data_set(&dir, "old");
        fs::write(dir.join("notes.txt"), "mine").unwrap();
        assert_eq!(refusal(&dir), format!("{expected}\"notes.txt\" in it: DIR"));
        let file = root.path().join("file");
        fs::write(&file, "").unwrap();
        assert_eq!(refusal(&file), format!("{expected}a file: DIR"));
        assert!(refusal(Path::new("/")).contains("the name of a folder"));
        assert_eq!(names(root.path()), ["file", "photos"]);
    }

    #[test]
    fn what_a_killed_run_left_is_put_right() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("world");
        // Killed while writing.
        data_set(&root.path().join(".world.evigrid-partial"), "half");
        let (pending, left_over) = PendingFolder::open(&dir).unwrap();
        assert!(left_over && names(pending.path()).is_empty());
        drop(pending);
        // Killed between the two renames: the earlier data set comes back.
        data_set(&root.path().join(".world.evigrid-replaced"), "old");
        drop(PendingFolder::open(&dir).unwrap());
        assert_eq!(fs::read_to_string(dir.join(MARKER)).unwrap(), "old");
        // Killed after both.
        data_set(&root.path().join(".world.evigrid-replaced"), "older");
        drop(PendingFolder::open(&dir).unwrap());
        assert_eq!(fs::read_to_string(dir.join(MARKER)).unwrap(), "old");
        assert_eq!(names(root.path()), ["world"]);
    }

    #[test]
    fn a_second_run_into_the_same_folder_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path().join("world");
        let (first, _) = PendingFolder::open(&dir).unwrap();
        assert!(refusal(&dir).contains("no other run is writing to, found one at work"));
        first.publish().unwrap();
        assert!(PendingFolder::open(&dir).is_ok());
    }
}
