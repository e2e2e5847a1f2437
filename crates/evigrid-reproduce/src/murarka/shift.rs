//! How much of the rates is the place of the cells: map and truth together on grids that are moved by half a cell,
//! and the exact truth itself against a truth that is half a cell off.

use anyhow::{Context, Result};
use evigrid_core::Mounting;
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_grid::{GridSpec, SafetyMap};
use evigrid_metrics::{PlanningDisc, SafetyCase, SafetyReference};
use evigrid_replay::{Sequence, map_from_world};
use evigrid_synth::{SafetyTruth, SyntheticSequence, World};

use super::runs::{Runs, Score};
use super::worlds::{Entry, WORLDS, mean_and_deviation};
use crate::job::Job;
use crate::table::rounded;

/// Moves of the grid along x and y, cells.
const SHIFTS: [[f64; 2]; 4] = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]];

const MATCHERS: [&str; 2] = ["multi-scale", "exact"];
const METHODS: [&str; 2] = ["safety-map", "safety-map-plus"];
const SCORES: [Score; 4] = [
    ("fn_percent", "safety_fn_rate", 100.0),
    ("fp_percent", "safety_fp_rate", 100.0),
    ("fn_off_borders_percent", "safety_fn_rate_off_borders", 100.0),
    ("fp_off_borders_percent", "safety_fp_rate_off_borders", 100.0),
];

fn entry(matcher: &'static str, method: &'static str, shift_cells: [f64; 2]) -> Entry {
    Entry { shift_cells, ..Entry::plain(matcher, method) }
}

/// The maps that are made of every world.
pub fn entries() -> Vec<Entry> {
    let of_matcher = |matcher| METHODS.into_iter().flat_map(move |method| of(matcher, method));
    MATCHERS.into_iter().flat_map(of_matcher).collect()
}

fn of(matcher: &'static str, method: &'static str) -> impl Iterator<Item = Entry> {
    SHIFTS.into_iter().map(move |shift| entry(matcher, method, shift))
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let mut rows = Vec::new();
    for matcher in MATCHERS {
        for method in METHODS {
            for shift in SHIFTS {
                let values = runs.values(&entry(matcher, method, shift), &SCORES)?;
                rows.extend(rows_of([matcher, method], shift, values));
            }
        }
    }
    for shift in SHIFTS {
        let values: Result<Vec<Vec<f64>>> =
            WORLDS.into_iter().map(|world| truth_moved(world, shift)).collect();
        rows.extend(rows_of(["", "the truth, half a cell off"], shift, values?));
    }
    let names = ["matcher", "method", "shift_x_cells", "shift_y_cells", "world"];
    let header: Vec<&str> = names.into_iter().chain(SCORES.map(|score| score.0)).collect();
    job.write_table(&header, rows)
}

/// A row per world, then the mean.
fn rows_of(names: [&str; 2], shift: [f64; 2], values: Vec<Vec<f64>>) -> Vec<Vec<String>> {
    let mean = |n: usize| mean_and_deviation(&values.iter().map(|row| row[n]).collect::<Vec<_>>())[0];
    let means = (0..SCORES.len()).map(mean).collect();
    let row = |(world, values): (&str, Vec<f64>)| {
        let names = names.map(str::to_owned).into_iter().chain(shift.map(|cells| cells.to_string()));
        let values = values.into_iter().map(|v| rounded(v, 2));
        names.chain([world.to_owned()]).chain(values).collect()
    };
    WORLDS.into_iter().zip(values).chain([("mean", means)]).map(row).collect()
}

/// Rates of a perfect map whose grid is moved, against the truth on the grid in its place, over all frames.
fn truth_moved(name: &str, shift_cells: [f64; 2]) -> Result<Vec<f64>> {
    let world = World::builtin(name)?;
    let (moved, truth) = (true_map(&world, shift_cells)?, true_map(&world, [0.0; 2])?);
    let truth = SafetyReference::new(truth);
    let sequence = SyntheticSequence::new(world);
    let mounting =
        sequence.info().mounting.with_context(|| format!("{name} does not stand on the ground"))?;
    let mut case = SafetyCase::default();
    for disc in discs(&sequence, mounting)? {
        case.add(&SafetyCase::new(&moved, &truth, Some(disc)));
    }
    let counts = [case.strict, case.beside_borders];
    let rates = counts.map(|c| [c.false_negative_rate(), c.false_positive_rate()].map(|rate| 100.0 * rate));
    Ok(rates.concat())
}

fn true_map(world: &World, shift_cells: [f64; 2]) -> Result<SafetyMap> {
    let spec = GridSpec::new(&entry("exact", METHODS[0], shift_cells).config(world)?.grid)?;
    let map_from_world = map_from_world(&world.true_world_from_left(0));
    Ok(SafetyTruth::new(world, spec, &map_from_world, 0, &SafetyRules::default())?.map())
}

/// The robot's planning disc at each frame of a world.
fn discs(sequence: &dyn Sequence, mounting: Mounting) -> Result<Vec<PlanningDisc>> {
    let map = map_from_world(&sequence.world_from_left(0)?);
    let radius_m = evigrid_eval::Config::load(None, &[])?.score.safety_radius_m;
    let disc = |frame| {
        let pose = map * sequence.world_from_left(frame)?;
        Ok(PlanningDisc { at_m: mounting.robot_m(&pose), radius_m })
    };
    (0..sequence.info().frame_count).map(disc).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_agrees_with_itself_and_errs_at_edges_when_moved() {
        let still = truth_moved("safety-4", [0.0; 2]).unwrap();
        assert_eq!(still, [0.0; 4]);
        let moved = truth_moved("safety-4", [0.5, 0.5]).unwrap();
        assert!(moved[0] + moved[1] > 0.0, "{moved:?}");
    }
}
