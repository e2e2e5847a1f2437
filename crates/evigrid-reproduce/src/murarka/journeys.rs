//! Maps of the five worlds followed frame by frame, for the items that ask more of them than sums at the end.

use anyhow::{Context, Result};
use evigrid_eval::{Config, Followed, Recording, follow_together};
use evigrid_grid::Layer;
use evigrid_synth::World;

use super::worlds::{Entry, MATCHERS};
use crate::job::Job;
use crate::journey::{Journey, RobotAt, Shown};

pub const METHODS: [&str; 2] = ["safety-map", "safety-map-plus"];

/// The frame of each world that is shown: the robot stands where it sees what the world is for.
pub const SHOWN: [(&str, usize); 5] =
    [("safety-1", 165), ("safety-2", 110), ("safety-3", 150), ("safety-4", 150), ("safety-5", 165)];

/// The maps: every method on every matcher, with the paper's settings.
pub fn entries() -> Vec<Entry> {
    let of_matcher = |(matcher, _)| METHODS.map(|method| Entry::plain(matcher, method));
    MATCHERS.into_iter().flat_map(of_matcher).collect()
}

/// The journeys of [`entries`] through a world, over all its frames.
pub fn whole(job: &mut Job<'_, '_>, world: &str) -> Result<Vec<Journey>> {
    if let Some(known) = job.journeys.get(world) {
        return Ok(known.clone());
    }
    let made = follow(job, world, None)?;
    job.journeys.insert(world.to_owned(), made.clone());
    Ok(made)
}

/// The same up to the frame that is shown, unless an item of the same command has made the whole.
pub fn up_to_shown(job: &mut Job<'_, '_>, world: &str, shown: usize) -> Result<Vec<Journey>> {
    match job.journeys.get(world) {
        Some(known) => Ok(known.clone()),
        None => follow(job, world, Some(shown)),
    }
}

fn follow(job: &mut Job<'_, '_>, name: &str, last: Option<usize>) -> Result<Vec<Journey>> {
    let world = World::builtin(name)?;
    let frames = last.map_or(world.frame_count(), |last| last + 1);
    job.say(&format!("synth:{name}, {frames} frames"));
    let configs: Result<Vec<Config>> = entries().iter().map(|entry| entry.config(&world)).collect();
    let mut configs = configs?;
    configs.iter_mut().for_each(|config| config.run.frames = format!("0..{frames}"));
    let shown = SHOWN.iter().find(|(known, _)| *known == name).map(|&(_, frame)| frame);
    let recording = Recording::from(world);
    let mounting = recording.sequence().info().mounting;
    let mounting = mounting.with_context(|| format!("{name} does not stand on the ground"))?;
    let mut journeys = vec![Journey::default(); configs.len()];
    follow_together(&recording, configs, job.tools.clock, &mut |number, seen: &Followed<'_>| {
        let map = seen.layers.iter().find_map(Layer::safety).context("a method without a safety map")?;
        let truth = seen.truth.safety().context("a world without a true safety map")?;
        let Some(case) = seen.truth.safety_case(map) else { return Ok(()) };
        journeys[number].cases.push((seen.frame.index(), case));
        // If the robot stands still in the frame itself, its last map before is shown.
        if shown.is_some_and(|shown| seen.frame.index() <= shown) {
            let robot = RobotAt::of(seen.frame, mounting);
            let (map, truth) = (map.clone(), truth.clone());
            journeys[number].shown = Some(Shown { map, truth, case, robot });
        }
        Ok(())
    })?;
    Ok(journeys)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::murarka::worlds::WORLDS;

    #[test]
    fn every_world_has_a_frame_that_is_shown() {
        for (world, (shown, frame)) in WORLDS.into_iter().zip(SHOWN) {
            assert_eq!(world, shown);
            assert!(frame < World::builtin(world).unwrap().frame_count());
        }
        assert_eq!(entries().len(), 6);
    }
}
