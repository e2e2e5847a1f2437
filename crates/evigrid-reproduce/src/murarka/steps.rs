//! What each addition of `safety-map-plus` gains, world by world: they are switched on one after the other.

use anyhow::Result;

use super::runs::{Runs, Score, summary};
use super::worlds::{Entry, WORLDS};
use crate::job::Job;
use crate::table::rounded;

/// The additions in their order, as settings of `safety-map`. With all of them it is `safety-map-plus`.
const ADDITIONS: [(&str, &str); 6] = [
    ("merge_m", "merge_m=0.01"),
    ("weigh_points", "weigh_points=true"),
    ("reassign_cells", "reassign_cells=true"),
    ("hole_at", "hole_at=10"),
    ("edges_unsafe", "edges_unsafe=true"),
    ("enclosed_unsafe", "enclosed_unsafe=true"),
];

const MATCHERS: [&str; 2] = ["multi-scale", "exact"];

const SCORES: [Score; 6] = [
    ("fn_percent", "safety_fn_rate", 100.0),
    ("fp_percent", "safety_fp_rate", 100.0),
    ("unclassified_percent", "safety_unclassified", 100.0),
    ("unsafe_found_percent", "safety_unsafe_found", 100.0),
    ("inclined_found_percent", "safety_inclined_found", 100.0),
    ("inclined_plane_angle_deg", "safety_inclined_plane_angle_deg", 1.0),
];

/// `safety-map` with the first additions.
fn entry(matcher: &'static str, additions: usize) -> Entry {
    let mut entry = Entry::plain(matcher, "safety-map");
    entry.sets.extend(ADDITIONS[..additions].iter().map(|(_, set)| (*set).to_owned()));
    entry
}

/// The maps that are made of every world.
pub fn entries() -> Vec<Entry> {
    MATCHERS.into_iter().flat_map(|matcher| (0..=ADDITIONS.len()).map(move |n| entry(matcher, n))).collect()
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let mut rows = Vec::new();
    for matcher in MATCHERS {
        for additions in 0..=ADDITIONS.len() {
            let step = additions.checked_sub(1).map_or("none", |last| ADDITIONS[last].0);
            let values = runs.values(&entry(matcher, additions), &SCORES)?;
            let means = summary(&values).into_iter().map(|column| column[0]).collect();
            for (world, values) in WORLDS.into_iter().zip(values).chain([("mean", means)]) {
                let names = [matcher, step, world].map(str::to_owned);
                rows.push(
                    names.into_iter().chain(values.into_iter().map(|v| rounded(v, 2))).collect::<Vec<_>>(),
                );
            }
        }
    }
    let header: Vec<&str> =
        ["matcher", "added", "world"].into_iter().chain(SCORES.map(|score| score.0)).collect();
    job.write_table(&header, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_eval::Config;

    #[test]
    fn all_additions_together_are_the_method_of_its_own() {
        let sets = ADDITIONS.map(|(_, set)| format!("safety-map.{set}"));
        let methods = Config::load(None, &sets).unwrap().methods;
        assert_eq!(methods.table("safety-map"), methods.table("safety-map-plus"));
        for (name, set) in ADDITIONS {
            assert!(set.starts_with(&format!("{name}=")));
        }
    }
}
