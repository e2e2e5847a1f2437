//! Items made into a temporary folder, and what is in their tables.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

use std::collections::HashMap;
use std::path::Path;

use evigrid_eval::RealClock;
use evigrid_reproduce::{Folders, Tools, reproduce};

pub type Row = HashMap<String, String>;

/// The tables that an item wrote.
pub struct Item {
    pub header: Vec<String>,
    pub rows: Vec<Row>,
    /// Its other tables.
    pub more: HashMap<String, Vec<Row>>,
}

/// Makes GROUP/ITEM without any data; `more` names tables that it writes beside the first.
pub fn make(name: &str, more: &[&str]) -> anyhow::Result<Item> {
    let out = tempfile::tempdir()?;
    let folders = Folders { data: "/nonexistent".into(), out: out.path().to_owned() };
    let clock = RealClock::default();
    let mut tools = Tools { report: &mut |_| {}, clock: &clock, recorder: &|_| Ok(None) };
    let files = reproduce(name, &folders, &mut tools)?;
    let path = |ending: &str| out.path().join(format!("{name}.{ending}"));
    assert!(files.contains(&path("csv")) && files.contains(&path("svg")), "{files:?}");
    let svg = std::fs::read_to_string(path("svg"))?;
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    let (header, rows) = table(&path("csv"))?;
    let more = more.iter().map(|&part| Ok((part.to_owned(), table(&path(&format!("{part}.csv")))?.1)));
    Ok(Item { header, rows, more: more.collect::<anyhow::Result<_>>()? })
}

fn table(path: &Path) -> anyhow::Result<(Vec<String>, Vec<Row>)> {
    let mut table = csv::Reader::from_path(path)?;
    let header = table.headers()?.iter().map(str::to_owned).collect();
    Ok((header, table.deserialize().collect::<Result<_, _>>()?))
}

pub fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}
