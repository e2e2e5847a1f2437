//! Runs of a tiny drive side by side, for comparisons.
#![allow(clippy::unwrap_used, dead_code, missing_docs)]

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use super::{TinyDrive, evigrid, names, path, stderr, stdout};

/// A drive that was run into the folder `base`.
pub struct Runs {
    pub drive: TinyDrive,
}

impl Runs {
    pub fn new() -> Self {
        let runs = Self { drive: TinyDrive::new(3) };
        runs.run("base", &[]);
        runs
    }

    pub fn folder(&self, name: &str) -> PathBuf {
        self.drive.root.path().join(name)
    }

    pub fn run(&self, name: &str, more: &[&str]) {
        let output = self.drive.run(&self.folder(name), more);
        assert!(output.status.success(), "{}", stderr(&output));
    }

    /// A copy of `base`, replacing whatever had the name.
    pub fn copy(&self, name: &str) {
        let _ = fs::remove_dir_all(self.folder(name));
        fs::create_dir(self.folder(name)).unwrap();
        for file in names(&self.folder("base")) {
            fs::copy(self.folder("base").join(&file), self.folder(name).join(&file)).unwrap();
        }
    }

    /// Replaces `from` in a file of a folder.
    pub fn edit(&self, name: &str, file: &str, from: &str, to: &str) {
        let file = self.folder(name).join(file);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{from:?} is not in {text}");
        fs::write(file, text.replace(from, to)).unwrap();
    }

    /// Changes a number in the only row of summary.csv.
    pub fn change(&self, name: &str, column: &str, change: impl Fn(f64) -> String) {
        let file = self.folder(name).join("summary.csv");
        let mut reader = csv::Reader::from_path(&file).unwrap();
        let header = reader.headers().unwrap().clone();
        let at = header.iter().position(|c| c == column).unwrap();
        let row = reader.into_records().next().unwrap().unwrap();
        let mut fields: Vec<String> = row.iter().map(str::to_owned).collect();
        fields[at] = change(fields[at].parse().unwrap());
        let mut writer = csv::Writer::from_path(&file).unwrap();
        writer.write_record(&header).unwrap();
        writer.write_record(&fields).unwrap();
    }

    /// Compares `base` with `new`.
    pub fn compare(&self, more: &[&str]) -> Output {
        let (base, new) = (self.folder("base"), self.folder("new"));
        evigrid(&[&["compare", path(&base), path(&new)], more].concat())
    }

    pub fn check(&self, more: &[&str], code: i32, parts: &[&str]) {
        let output = self.compare(more);
        let text = stdout(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {text}{}", stderr(&output));
        for part in parts {
            assert!(text.contains(part), "{more:?}: expected {part:?} in: {text}");
        }
    }

    pub fn check_refused(&self, parts: &[&str]) {
        check_refused(&self.compare(&[]), parts);
    }
}

/// One error line that holds all the parts, exit code 2, nothing on standard output.
pub fn check_refused(output: &Output, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{text}{}", stdout(output));
    assert!(text.starts_with("error: ") && text.trim_end().lines().count() == 1, "{text}");
    assert_eq!(stdout(output), "");
    for part in parts {
        assert!(text.contains(part), "expected {part:?} in: {text}");
    }
}
