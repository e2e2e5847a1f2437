//! What each point has found, on disk: `points/HASH/`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use serde_json::Value;

use super::outcome::Outcome;
use super::pass::PointResult;
use super::point::Point;
use crate::ResultsFolder;
use crate::tables::{RESULTS_FORMAT, summary_header, write_point};

/// The folders of all points of a sweep.
#[derive(Debug)]
pub(super) struct PointFolders<'a> {
    /// The folder `points`.
    pub dir: PathBuf,
    /// What run.json says of the build and the machine.
    pub build: &'a Value,
    /// Whether map and reference are kept too.
    pub maps: bool,
}

impl PointFolders<'_> {
    /// The folder of a point.
    pub fn path(&self, point: &Point) -> PathBuf {
        self.dir.join(&point.hash)
    }

    /// Writes what a point has found. Its run.json gets its name last: a folder without it is not whole.
    pub fn write(&self, result: &PointResult<'_>) -> Result<()> {
        let (folder, _) = ResultsFolder::open(&self.path(result.point))?;
        let map = self.maps.then_some(result.map.as_ref());
        let truth = result.truth.filter(|_| self.maps);
        folder.publish(write_point(&folder, &result.point.info, &result.run, map, truth, self.build)?)
    }

    /// What a point has found, if its folder is whole and the same program wrote it.
    pub fn read<'a>(&self, point: &'a Point) -> Option<Outcome<'a>> {
        let dir = self.path(point);
        let run: Value = serde_json::from_slice(&std::fs::read(dir.join("run.json")).ok()?).ok()?;
        let same_build = ["version", "commit"].iter().all(|key| run["build"][key] == self.build[key]);
        if !same_build || run["format"] != RESULTS_FORMAT || run["settings_hash"] != point.hash.as_str() {
            return None;
        }
        let name = point.method.name();
        let complete = !self.maps || dir.join(format!("map.{name}.npz")).is_file();
        let row = summary_row(&dir, &summary_header(&point.info))?;
        complete.then_some(Outcome { point, row })
    }
}

/// The only row of a summary.csv with this header.
fn summary_row(dir: &Path, header: &[String]) -> Option<Vec<(String, String)>> {
    let reader = csv::ReaderBuilder::new().has_headers(false).from_path(dir.join("summary.csv")).ok()?;
    let rows: Vec<csv::StringRecord> = reader.into_records().collect::<Result<_, _>>().ok()?;
    let [head, row] = &rows[..] else { return None };
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
    (cells(head) == header).then(|| header.iter().cloned().zip(cells(row)).collect())
}
