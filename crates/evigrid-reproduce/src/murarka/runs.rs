//! The maps that the items on rates share. All are made in one pass over the frames of each world, since frames
//! take longer to render and to match than to map.

use anyhow::{Context, Result};
use evigrid_grid::LayerKind;
use evigrid_metrics::SafetyTally;
use evigrid_results::MethodResult;

use super::journeys::follow;
use super::worlds::{Entry, WORLDS, mean_and_deviation};
use super::{fig6a, shift, steps, table2};
use crate::job::Job;

/// A score in a table: name of the column, name of the score, and factor to percent or to the unit.
pub type Score = (&'static str, &'static str, f64);

/// The results of all entries, world by world.
pub struct Runs {
    entries: Vec<Entry>,
    worlds: Vec<Vec<MethodResult>>,
}

/// Every map of every item, once.
fn all_entries() -> Vec<Entry> {
    let mut all: Vec<Entry> = Vec::new();
    for entry in [table2::entries(), fig6a::entries(), steps::entries(), shift::entries()].concat() {
        if !all.contains(&entry) {
            all.push(entry);
        }
    }
    all
}

impl Runs {
    /// Makes the maps, unless an item of the same command has made them.
    pub fn of(job: &mut Job<'_, '_>) -> Result<Self> {
        let entries = all_entries();
        let mut worlds = Vec::new();
        for world in WORLDS {
            if !job.results.contains_key(world) {
                let made = follow(job, world, &entries, None)?;
                job.results.insert(world.to_owned(), made);
            }
            worlds.push(job.results[world].clone());
        }
        Ok(Self { entries, worlds })
    }

    /// The results of an entry, one per world.
    pub fn results(&self, entry: &Entry) -> Result<Vec<&MethodResult>> {
        let number = self.entries.iter().position(|known| known == entry);
        let number = number.with_context(|| format!("no map of {entry:?} was made"))?;
        Ok(self.worlds.iter().map(|world| &world[number]).collect())
    }

    /// What was counted of the safety maps of an entry, one per world.
    pub fn tallies(&self, entry: &Entry) -> Result<Vec<&SafetyTally>> {
        let tally = |result: &'_ MethodResult| result.safety.is_some();
        let results = self.results(entry)?;
        let all = results.iter().all(|result| tally(result));
        all.then_some(()).context("a world without a true safety map")?;
        Ok(results.into_iter().filter_map(|result| result.safety.as_ref()).collect())
    }

    /// Scores of an entry: a row per world.
    pub fn values(&self, entry: &Entry, scores: &[Score]) -> Result<Vec<Vec<f64>>> {
        let row = |result: &MethodResult| {
            let own = result.scores.iter().find(|scores| scores.kind == LayerKind::Safety);
            let own = own.context("a world without a true safety map")?;
            let value = |&(_, name, factor): &Score| factor * own.get(name).unwrap_or(f64::NAN);
            Ok(scores.iter().map(value).collect())
        };
        self.results(entry)?.into_iter().map(row).collect()
    }
}

/// Mean and deviation of each column over the worlds that have a value.
pub fn summary(rows: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let columns = rows.first().map_or(0, Vec::len);
    let column = |n: usize| {
        let known: Vec<f64> = rows.iter().map(|row| row[n]).filter(|v| !v.is_nan()).collect();
        mean_and_deviation(&known)
    };
    (0..columns).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::super::journeys;
    use super::*;

    #[test]
    fn no_map_is_made_twice() {
        let all = all_entries();
        for (n, entry) in all.iter().enumerate() {
            assert!(!all[..n].contains(entry), "{entry:?}");
        }
        // decr 1 of the table is a point of the curve, the first of the steps and the grid in its place.
        let plain = Entry::plain("exact", "safety-map");
        assert!(table2::entries().contains(&plain) && fig6a::entries().contains(&plain));
        assert!(steps::entries().contains(&plain) && shift::entries().contains(&plain));
        // So that planes and fig7 have their maps from the same pass.
        assert!(journeys::entries().iter().all(|own| all.contains(own)));
    }

    #[test]
    fn worlds_without_a_value_are_left_out_of_the_mean() {
        let rows = [vec![1.0, f64::NAN], vec![3.0, 5.0]];
        assert_eq!(summary(&rows), [[2.0, 1.0], [5.0, 0.0]]);
    }
}
