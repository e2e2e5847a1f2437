//! Table I: what the four algorithms do for one image, and how long it takes them.

use anyhow::Result;

use super::claims::{Claim, claims};
use super::scene::{CELLS_M, Scene, WORLD};
use super::timed::{EXACT, MATCHED, Timed, measure};
use crate::chart::{Axis, BLUE, Corner, GREY, Marks, Panel, Series, Sheet, rectangle};
use crate::job::Job;
use crate::table::rounded;

/// Timed runs, after one that is not.
const REPETITIONS: usize = 9;

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let scene = Scene::new()?;
    let rows = measure(job, &scene, REPETITIONS)?;
    let header = [
        "image",
        "cell_size_m",
        "algorithm",
        "valid_pixels",
        "coordinate_transfers",
        "used_pixels",
        "lines",
        "cells_drawn",
        "different_cells",
        "touched_cells",
        "median_ms",
        "fastest_ms",
        "identities",
        "paper_coordinate_transfers",
        "paper_used_pixels",
        "paper_cells_drawn",
        "paper_different_cells",
        "paper_ms_one_core_of_1.8_ghz",
    ];
    job.write_table(&header, rows.iter().map(Timed::row))?;
    let exact: Vec<&Timed> = rows.iter().filter(|row| row.image == EXACT).collect();
    let groups = [EXACT, MATCHED].into_iter().flat_map(|image| CELLS_M.map(|c| (image, c)));
    let all: Vec<Claim> = groups
        .flat_map(|(image, c)| {
            let group: Vec<&Timed> = rows.iter().filter(|r| r.image == image && r.cell_size_m == c).collect();
            claims(&group)
        })
        .collect();
    let claim_rows = all.iter().map(|claim| {
        let [ours, paper] = [claim.ours, claim.paper].map(|v| rounded(v, 3));
        let met = if claim.is_met { "yes" } else { "no" };
        [
            claim.image.to_owned(),
            claim.cell_size_m.to_string(),
            claim.text.to_owned(),
            ours,
            paper,
            met.to_owned(),
        ]
    });
    job.write_more("claims", &["image", "cell_size_m", "ratio", "ours", "paper", "met"], claim_rows)?;
    job.write_picture(&picture(&exact))
}

/// Per cell size the time and the cells drawn, ours and the paper's, as powers of ten.
fn picture(rows: &[&Timed]) -> Sheet {
    let mut panels = Vec::new();
    for cell_size_m in CELLS_M {
        let here: Vec<&Timed> = rows.iter().copied().filter(|r| r.cell_size_m == cell_size_m).collect();
        let time = here.iter().map(|r| [r.fastest_ms, r.paper.ms]).collect();
        panels.push(bars(
            &here,
            format!("time, cells of {cell_size_m} m"),
            "milliseconds, power of ten",
            [-2.0, 5.5],
            time,
        ));
        let cells =
            here.iter().map(|r| [r.counters.cells_drawn as f64, r.paper.cells_drawn as f64]).collect();
        panels.push(bars(
            &here,
            format!("cells drawn, cells of {cell_size_m} m"),
            "cells, power of ten",
            [3.0, 9.0],
            cells,
        ));
    }
    Sheet {
        title: "Table I: what four algorithms do for one image of 640x480".into(),
        notes: vec![
            format!("the world {WORLD}, true disparities up to 25 m; one thread, fastest of {REPETITIONS}"),
            "the paper: another picture of the same kind, 1.8 GHz; one mark to the right is ten times as \
             much"
                .into(),
        ],
        columns: 2,
        panel: (720, 280),
        panels,
    }
}

fn bars(rows: &[&Timed], title: String, label: &str, range: [f64; 2], values: Vec<[f64; 2]>) -> Panel {
    let mut areas: [Vec<Vec<(f64, f64)>>; 2] = Default::default();
    for (at, pair) in values.iter().rev().enumerate() {
        for (k, value) in pair.iter().enumerate() {
            let top = at as f64 + 0.36 - 0.36 * k as f64;
            areas[k].push(rectangle([range[0], value.log10()], [top - 0.32, top]));
        }
    }
    let [ours, paper] = areas;
    Panel {
        title,
        x: Axis::new(label, range[0], range[1]),
        y: Axis {
            label: String::new(),
            range: [-0.5, rows.len() as f64 - 0.5],
            names: rows.iter().rev().map(|r| r.algorithm.name().to_owned()).collect(),
        },
        series: vec![
            Series::new("here", BLUE, Marks::Areas(ours)),
            Series::new("the paper", GREY, Marks::Areas(paper)),
        ],
        legend: Some(Corner::UpperRight),
    }
}
