//! Time and memory of a run, from timing.csv.

use std::path::Path;

use anyhow::Result;

use super::table::Table;
use crate::files;
use crate::tables::TIMING_COLUMNS;

/// The costs of a run: method (empty for what all methods share), metric, value; in the order of a frame. The
/// time of a stage is its median over the frames, so that the first frame and a busy moment do not count.
#[derive(Debug)]
pub(super) struct Costs(pub(super) Vec<(String, String, f64)>);

impl Costs {
    /// Reads timing.csv; `None` if the folder has none.
    ///
    /// # Errors
    /// If it is damaged.
    pub(super) fn read(dir: &Path) -> Result<Option<Self>> {
        let path = dir.join(files::TIMING);
        if !path.is_file() {
            return Ok(None);
        }
        let table = Table::read(&path, &TIMING_COLUMNS)?;
        let mut stages: Vec<(String, String, Vec<f64>)> = Vec::new();
        let mut memory: Option<f64> = None;
        for row in &table.rows {
            memory = memory.into_iter().chain(table.number(row, "peak_memory_mib")?).reduce(f64::max);
            let (method, stage) = (table.text(row, "method")?, table.text(row, "stage")?);
            let Some(ms) = table.number(row, "ms")? else { continue };
            match stages.iter_mut().find(|(m, s, _)| m == method && s == stage) {
                Some((_, _, times)) => times.push(ms),
                None => stages.push((method.to_owned(), stage.to_owned(), vec![ms])),
            }
        }
        let times =
            stages.into_iter().map(|(method, stage, times)| (method, format!("{stage}_ms"), median(times)));
        let memory = memory.map(|m| (String::new(), "peak_memory_mib".to_owned(), m));
        Ok(Some(Self(times.chain(memory).collect())))
    }

    /// The value of a metric.
    pub(super) fn get(&self, method: &str, metric: &str) -> Option<f64> {
        self.0.iter().find(|(m, n, _)| m == method && n == metric).map(|(_, _, value)| *value)
    }
}

/// Median of at least one value.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { (values[half - 1] + values[half]) / 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0, 4.0]), 3.0);
    }
}
