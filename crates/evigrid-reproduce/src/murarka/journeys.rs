//! Maps of the five worlds followed frame by frame, for the items that ask more of them than sums at the end.

use anyhow::{Context, Result};
use evigrid_core::Mounting;
use evigrid_eval::{Config, Followed, Mapped, Recording, follow_together};
use evigrid_grid::Layer;
use evigrid_results::MethodResult;
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

/// The journeys of [`entries`] through a world, over all its frames, unless an item of the same command has made
/// them.
pub fn whole(job: &mut Job<'_, '_>, world: &str) -> Result<Vec<Journey>> {
    if !job.journeys.contains_key(world) {
        follow(job, world, &entries(), None)?;
    }
    Ok(job.journeys[world].clone())
}

/// The same at least up to the frame that is shown.
pub fn up_to_shown(job: &mut Job<'_, '_>, world: &str, shown: usize) -> Result<Vec<Journey>> {
    if let Some(known) = job.journeys.get(world) {
        return Ok(known.clone());
    }
    follow(job, world, &entries(), Some(shown))?;
    Ok(job.journeys.remove(world).unwrap_or_default())
}

/// Makes maps of a world in one pass, over its frames or up to one of them. Returned is what was counted over the
/// frames, one result per map; the journeys of those maps that are [`entries`] are kept with the job.
pub fn follow(
    job: &mut Job<'_, '_>,
    name: &str,
    maps: &[Entry],
    last: Option<usize>,
) -> Result<Vec<MethodResult>> {
    let world = World::builtin(name)?;
    let frames = last.map_or(world.frame_count(), |last| last + 1);
    job.say(&format!("synth:{name}, {frames} frames"));
    let configs: Result<Vec<Config>> = maps.iter().map(|entry| entry.config(&world)).collect();
    let mut configs = configs?;
    configs.iter_mut().for_each(|config| config.run.frames = format!("0..{frames}"));
    let kept = entries();
    let place = |entry: &Entry| kept.iter().position(|own| own == entry);
    let places: Vec<Option<usize>> = maps.iter().map(place).collect();
    let shown = SHOWN.iter().find(|(known, _)| *known == name).map_or(0, |&(_, frame)| frame);
    let recording = Recording::from(world);
    let mounting = recording.sequence().info().mounting;
    let mounting = mounting.with_context(|| format!("{name} does not stand on the ground"))?;
    let mut journeys = vec![Journey::default(); kept.len()];
    let look = |mapped: &Mapped<'_>| Ok(mapped.result.clone());
    let results = follow_together(&recording, configs, job.tools.clock, &look, &mut |number, seen| {
        places[number].map_or(Ok(()), |place| journeys[place].add(seen, mounting, shown))
    })?;
    job.journeys.insert(name.to_owned(), journeys);
    Ok(results)
}

impl Journey {
    /// Adds the map after a frame. Up to the frame that is shown the latest map is kept: if the robot stands still
    /// in that frame itself, it is the one before.
    fn add(&mut self, seen: &Followed<'_>, mounting: Mounting, shown: usize) -> Result<()> {
        let map = seen.layers.iter().find_map(Layer::safety).context("a method without a safety map")?;
        let truth = seen.truth.safety().context("a world without a true safety map")?;
        let Some(case) = seen.truth.safety_case(map) else { return Ok(()) };
        self.cases.push((seen.frame.index(), case));
        if seen.frame.index() <= shown {
            let robot = RobotAt::of(seen.frame, mounting);
            self.shown = Some(Shown { map: map.clone(), truth: truth.clone(), case, robot });
        }
        Ok(())
    }
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
