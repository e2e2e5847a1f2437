//! The findings of points on disk: `points/HASH/`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use evigrid_grid::LayerKind;
use evigrid_metrics::metric_of;
use evigrid_results::{Kept, RESULTS_FORMAT, ResultsFolder, ResultsWriter, files, summary_header};
use serde_json::Value;

use super::outcome::Outcome;
use super::passes::PointResult;
use super::point::Point;

/// The folders of all points of a sweep.
#[derive(Debug)]
pub(super) struct PointFolders<'a> {
    /// The folder `points`.
    pub dir: PathBuf,
    /// Description of the build and the machine in run.json.
    pub build: &'a Value,
    /// Whether maps and truth are kept too.
    pub maps: bool,
}

impl PointFolders<'_> {
    /// The folder of a point.
    pub fn path(&self, point: &Point) -> PathBuf {
        self.dir.join(point.hash())
    }

    /// Writes the finding of a point. Its run.json gets its name last: a folder without it is not whole.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, found: &PointResult<'_>) -> Result<()> {
        let (folder, _) = ResultsFolder::open(&self.path(found.point))?;
        let kept = Kept { frames: false, maps: self.maps };
        let writer = ResultsWriter::create(&folder, &found.point.job.info, self.build.clone(), kept)?;
        folder.publish(writer.finish(&found.run, std::slice::from_ref(&found.maps), found.truth.file())?)
    }

    /// The finding of a point, if its folder is whole and the same program wrote it.
    pub fn read<'a>(&self, point: &'a Point) -> Option<Outcome<'a>> {
        let dir = self.path(point);
        let run: Value = serde_json::from_slice(&std::fs::read(dir.join(files::RUN)).ok()?).ok()?;
        let same_build = ["version", "commit"].iter().all(|key| run["build"][key] == self.build[key]);
        if !same_build || run["format"] != RESULTS_FORMAT || run["settings_hash"] != point.hash() {
            return None;
        }
        let complete = !self.maps || evigrid_results::has_maps(&dir, &point.job.info);
        let row = point_row(&dir, point)?;
        complete.then_some(Outcome { point, row })
    }
}

/// Columns and cells of a point: the summaries of all kinds of layers that its method makes.
fn point_row(dir: &Path, point: &Point) -> Option<Row> {
    let layers = point.job.methods[0].layers;
    let read = |kind| summary_row(&dir.join(files::summary(kind)), &summary_header(&point.job.info, kind));
    let mut row = read(LayerKind::Voxels)?;
    if !layers.contains(&LayerKind::Voxels) {
        row.retain(|(column, _)| metric_of(column).is_none());
    }
    for &kind in layers.iter().filter(|kind| **kind != LayerKind::Voxels) {
        // There is no such table where there is no truth for it.
        if dir.join(files::summary(kind)).exists() {
            row.extend(read(kind)?.into_iter().filter(|(column, _)| metric_of(column).is_some()));
        }
    }
    Some(row)
}

type Row = Vec<(String, String)>;

/// The only row of a summary with this header.
fn summary_row(summary: &Path, header: &[String]) -> Option<Row> {
    let reader = csv::ReaderBuilder::new().has_headers(false).from_path(summary).ok()?;
    let rows: Vec<csv::StringRecord> = reader.into_records().collect::<Result<_, _>>().ok()?;
    let [head, row] = &rows[..] else { return None };
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
    (cells(head) == header).then(|| header.iter().cloned().zip(cells(row)).collect())
}
