//! Figs 5 and 6: the bars from the whole cost curve, and from winner-take-all under several peak ratios.

use anyhow::Result;

use super::bar_maps::{BarMap, BarRun, FULL, bar_maps};
use super::bar_picture::PANEL;
use super::methods::{self, Reading};
use crate::chart::Sheet;
use crate::job::Job;
use crate::table::rounded;

pub fn whole_curve(job: &mut Job<'_, '_>) -> Result<()> {
    make(
        job,
        FULL,
        methods::whole_curve("7 whole bars, no outliers"),
        "Fig. 5: the bars from the whole cost curve",
    )
}

pub fn winner_take_all(job: &mut Job<'_, '_>) -> Result<()> {
    make(job, FULL, baselines(), "Fig. 6: the bars from winner-take-all, filtered by the peak ratio")
}

/// The paper's three, and what the project adds.
fn baselines() -> Vec<Reading> {
    let ratios = [(1.4, "outliers"), (1.5, "holes and outliers"), (1.6, "holes")];
    let mut all: Vec<Reading> =
        ratios.iter().map(|&(ratio, paper)| methods::winner_take_all(ratio, paper)).collect();
    all.push(methods::winner_take_all(1.0, ""));
    all.push(methods::winner_take_all(1.1, ""));
    all.push(methods::winner_take_all(1.5, "").checked());
    all
}

fn make(job: &mut Job<'_, '_>, run: BarRun, readings: Vec<Reading>, title: &str) -> Result<()> {
    let maps = bar_maps(job, readings, run)?;
    let header = [
        "map",
        "settings",
        "bar_cells",
        "bar_cells_found_percent",
        "levels_held_percent",
        "worst_bar_levels_held_percent",
        "gaps",
        "longest_gap_m",
        "occupied_cells",
        "in_air_cells",
        "outlier_cells",
        "outlier_cells_around_bars",
        "complete",
        "no_outliers",
        "paper",
    ];
    job.write_table(&header, maps.iter().map(|map| row(map, run.cell_size_m)))?;
    let columns = maps.len().min(3);
    let mut panels = Vec::new();
    for group in maps.chunks(columns) {
        panels.extend(group.iter().map(BarMap::front));
        panels.extend(group.iter().map(BarMap::above));
    }
    job.write_picture(&Sheet {
        title: format!("{title}, 20 frames, cells of {} m", run.cell_size_m),
        notes: vec![
            "blue: occupied at a true surface or one cell beside it; orange: outliers, in the air; grey, \
             circles: the true bars; the camera goes round them from below"
                .into(),
            format!("the paper: {}", paper(&maps)),
        ],
        columns,
        panel: PANEL,
        panels,
    })
}

/// The paper's words on the maps that it has.
fn paper(maps: &[BarMap]) -> String {
    let said = maps.iter().filter(|m| !m.reading.paper.is_empty());
    let mut said: Vec<_> = said.map(|m| (m.reading.name.as_str(), m.reading.paper)).collect();
    if said.windows(2).all(|pair| pair[0].1 == pair[1].1) {
        said.truncate(1);
        return said.iter().map(|(_, paper)| (*paper).to_owned()).collect();
    }
    said.iter().map(|(name, paper)| format!("{name}: {paper}")).collect::<Vec<_>>().join("; ")
}

fn row(map: &BarMap, cell_size_m: f64) -> [String; 15] {
    let score = &map.score;
    let percent = |share: f64| rounded(100.0 * share, 2);
    let yes = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    [
        map.reading.name.clone(),
        map.reading.sets.join(" "),
        score.bar_cells.to_string(),
        percent(score.bar_cells_found as f64 / score.bar_cells as f64),
        percent(score.held.iter().sum::<f64>() / score.held.len() as f64),
        percent(score.worst_bar()),
        score.gaps.to_string(),
        rounded(score.longest_gap as f64 * cell_size_m, 2),
        score.occupied.to_string(),
        score.in_air.to_string(),
        score.outliers.to_string(),
        score.outliers_around.to_string(),
        yes(score.is_complete()),
        yes(score.is_clean()),
        map.reading.paper.to_owned(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Folders, Tools};
    use evigrid_eval::RealClock;

    #[test]
    fn two_frames_from_end_to_end() {
        let out = tempfile::tempdir().unwrap();
        let folders = Folders { data: out.path().to_owned(), out: out.path().to_owned() };
        let clock = RealClock::default();
        let mut tools = Tools { report: &mut |_| {}, clock: &clock, recorder: &|_| Ok(None) };
        let mut job = Job::new("brandao", &folders, &mut tools);
        job.begin("fig6");
        let readings = vec![methods::winner_take_all(1.0, "holes"), methods::winner_take_all(1.6, "")];
        make(&mut job, BarRun { frames: "9..11", cell_size_m: 0.1 }, readings, "Fig. 6").unwrap();
        let mut table = csv::Reader::from_path(out.path().join("brandao/fig6.csv")).unwrap();
        let rows: Vec<std::collections::HashMap<String, String>> =
            table.deserialize().map(Result::unwrap).collect();
        assert_eq!((rows.len(), rows[0]["paper"].as_str()), (2, "holes"));
        let number = |row: usize, column: &str| rows[row][column].parse::<f64>().unwrap();
        // What a stricter filter leaves was there before: fewer occupied cells, more gaps.
        assert!(number(1, "occupied_cells") < number(0, "occupied_cells"));
        assert!(number(0, "occupied_cells") > 0.0 && number(0, "bar_cells") > 0.0);
        assert!(number(0, "outlier_cells") <= number(0, "in_air_cells"));
        assert!(out.path().join("brandao/fig6.svg").is_file());
    }
}
