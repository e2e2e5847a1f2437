//! Figs 8 and 9: maps of a real drive against the laser, as tables, pictures and recordings.

use anyhow::Result;
use evigrid_eval::{Config, Mapped, Recording, map_together};
use evigrid_metrics::{Counts, count};

use super::methods::{self, Reading};
use super::top_view::TopView;
use crate::chart::Sheet;
use crate::drive::{self, Drive};
use crate::job::Job;
use crate::recording::record;
use crate::table::{SCORE_COLUMNS, score_cells};

/// A map of the drive.
struct DriveMap {
    reading: Reading,
    counts: Counts,
    view: TopView,
}

pub fn fig8(job: &mut Job<'_, '_>) -> Result<()> {
    let mut readings = vec![methods::winner_take_all(3.0, "the best peak ratio")];
    readings.extend(methods::quick_whole_curve("more hits than winner-take-all, fewer mistakes"));
    make(job, &readings, "Fig. 8: winner-take-all with peak ratio 3, and the whole cost curve")
}

pub fn fig9(job: &mut Job<'_, '_>) -> Result<()> {
    let readings = [methods::winner_take_all(1.5, "many mistakes")];
    make(job, &readings, "Fig. 9: winner-take-all with peak ratio 1.5")
}

fn make(job: &mut Job<'_, '_>, readings: &[Reading], title: &str) -> Result<()> {
    let drive = drive::require(job)?;
    let (id, maps) = drive_maps(job, &drive, readings)?;
    let header = [&["dataset", "frames", "map", "settings"][..], &SCORE_COLUMNS, &["paper"]].concat();
    job.write_table(&header, maps.iter().map(|map| row(map, &id, &drive.frames)))?;
    let end_m = maps.iter().map(|map| map.view.end_m()).fold(1.0, f64::max);
    job.write_picture(&Sheet {
        title: format!("{title}: {id}, frames {}", drive.frames),
        notes: vec![
            "from above; green: most occupied cells of the column are occupied for the laser too, orange: \
             mistakes, grey: missed"
                .into(),
            format!("the paper, on other drives: {}", readings[0].paper_of(readings.last())),
        ],
        columns: 1,
        panel: (1100, 190),
        panels: maps.iter().map(|map| map.view.panel(map.caption(), end_m)).collect(),
    })?;
    let mut config = recorded(readings, &drive)?;
    config.run.dataset = drive.dir.display().to_string();
    record(job, config)
}

impl Reading {
    /// The paper's words on this method and another, in a line.
    fn paper_of(&self, other: Option<&Self>) -> String {
        let other = other.filter(|o| o.name != self.name);
        let other = other.map(|o| format!("; whole curve: {}", o.paper)).unwrap_or_default();
        format!("{}: {}{other}", self.name, self.paper)
    }
}

impl DriveMap {
    fn caption(&self) -> String {
        let Counts { hits, mistakes, .. } = self.counts;
        format!("{}: {hits} hits, {mistakes} mistakes, F1 {:.3}", self.reading.name, self.counts.f1())
    }
}

/// Name of the drive, and one map for each reading.
fn drive_maps(job: &mut Job<'_, '_>, drive: &Drive, readings: &[Reading]) -> Result<(String, Vec<DriveMap>)> {
    let recording = Recording::from(evigrid_replay::open(&drive.dir)?);
    let id = recording.sequence().info().id.clone();
    job.say(&format!("{} maps of {id}, frames {}", readings.len(), drive.frames));
    let base = [format!("run.frames={}", drive.frames)];
    let configs: Result<Vec<_>> = readings.iter().map(|reading| reading.config(&base)).collect();
    let look = |mapped: &Mapped<'_>| {
        let nothing = vec![false; mapped.info.spec.cell_count()];
        let (log_odds, truth) = (mapped.voxels()?.values(), mapped.truth.voxels());
        let occupied = truth.as_ref().map_or(&nothing[..], |truth| truth.occupied);
        let counts = truth.as_ref().map(|truth| count(log_odds, truth)).unwrap_or_default();
        Ok((counts, TopView::new(&mapped.info.spec, log_odds, occupied)))
    };
    let found = map_together(&recording, configs?, job.tools.clock, &look, &mut || {})?;
    let maps = readings.iter().cloned().zip(found);
    Ok((id, maps.map(|(reading, (counts, view))| DriveMap { reading, counts, view }).collect()))
}

fn row(map: &DriveMap, id: &str, frames: &str) -> Vec<String> {
    let reading = &map.reading;
    let mut row = vec![id.to_owned(), frames.to_owned(), reading.name.clone(), reading.sets.join(" ")];
    row.extend(score_cells(&map.counts));
    row.push(reading.paper.to_owned());
    row
}

/// One run of all methods, each as its first reading.
fn recorded(readings: &[Reading], drive: &Drive) -> Result<Config> {
    let mut methods: Vec<&str> = Vec::new();
    let mut sets = vec![format!("run.frames={}", drive.frames)];
    for reading in readings {
        if !methods.contains(&reading.method) {
            methods.push(reading.method);
            sets.extend(reading.sets.iter().cloned());
        }
    }
    let mut config = Config::load(None, &sets)?;
    config.run.methods = methods.iter().map(|m| (*m).to_owned()).collect();
    Ok(config)
}
