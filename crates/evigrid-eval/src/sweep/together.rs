//! Many settings on one recording, for whoever wants the maps themselves and no files.

use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use evigrid_core::Frame;
use evigrid_grid::{Layer, LogOddsGrid};
use evigrid_results::{MethodResult, RunInfo};

use super::passes::{PointResult, run_pass, split_into_passes};
use super::point::Point;
use crate::pass::{Moment, Pass};
use crate::{Clock, Config, Recording, Truth};

/// The finding of one of many settings.
#[derive(Debug, Clone, Copy)]
pub struct Mapped<'a> {
    /// Description of a run with these settings.
    pub info: &'a RunInfo,
    /// Its scores.
    pub result: &'a MethodResult,
    /// Its layers.
    pub layers: &'a [Layer<'a>],
    /// The truth.
    pub truth: &'a Truth,
}

impl Mapped<'_> {
    /// The map of a method that shows voxels.
    ///
    /// # Errors
    /// If the method shows none.
    pub fn voxels(&self) -> Result<&LogOddsGrid> {
        let voxels = self.layers.iter().find_map(Layer::voxels);
        voxels.with_context(|| format!("expected voxels of {}, found none", self.result.method))
    }
}

/// Maps a recording under many settings, each with one method, reading and matching every frame as few times
/// as memory allows. Every map is that of a run of its settings. `look` sees each when it is complete, from
/// any thread; its results come back in the order of `configs`. `frame_done` is called after each frame of
/// each pass.
///
/// # Errors
/// If a setting is outside its domain, a frame cannot be read, or `look` fails.
pub fn map_together<T: Send>(
    recording: &Recording,
    configs: Vec<Config>,
    clock: &dyn Clock,
    look: &(dyn Fn(&Mapped<'_>) -> Result<T> + Sync),
    frame_done: &mut dyn FnMut(),
) -> Result<Vec<T>> {
    together(recording, configs, clock, look, &mut |_, _, _| {
        frame_done();
        Ok(())
    })
}

/// One of many maps after a frame.
#[derive(Debug, Clone, Copy)]
pub struct Followed<'a> {
    /// The frame.
    pub frame: &'a Frame,
    /// Its layers so far.
    pub layers: &'a [Layer<'a>],
    /// The truth so far.
    pub truth: &'a Truth,
}

/// As [`map_together`], and every map is seen after every frame too: `follow` gets the position of its settings in
/// `configs`.
///
/// # Errors
/// As [`map_together`], or if `follow` fails.
pub fn follow_together<T: Send>(
    recording: &Recording,
    configs: Vec<Config>,
    clock: &dyn Clock,
    look: &(dyn Fn(&Mapped<'_>) -> Result<T> + Sync),
    follow: &mut dyn FnMut(usize, &Followed<'_>) -> Result<()>,
) -> Result<Vec<T>> {
    together(recording, configs, clock, look, &mut |pass, numbers, moment| {
        numbers.iter().enumerate().try_for_each(|(own, &number)| {
            let (layers, truth) = (pass.layers(own), pass.truth(own));
            follow(number, &Followed { frame: moment.frame, layers: &layers, truth })
        })
    })
}

/// Sees the maps of a pass after every frame, and gets the positions of their settings among all.
type FollowMany<'a> = dyn FnMut(&Pass<'_>, &[usize], &Moment<'_>) -> Result<()> + 'a;

/// Maps in passes. `follow` gets the positions of the pass's settings in `configs`.
fn together<T: Send>(
    recording: &Recording,
    configs: Vec<Config>,
    clock: &dyn Clock,
    look: &(dyn Fn(&Mapped<'_>) -> Result<T> + Sync),
    follow: &mut FollowMany<'_>,
) -> Result<Vec<T>> {
    let points: Result<Vec<Point>> = configs.into_iter().map(|c| Point::of_run(c, recording)).collect();
    let points = points?;
    let seen: Mutex<Vec<Option<T>>> = Mutex::new(points.iter().map(|_| None).collect());
    let number_of = |own: &Point| points.iter().position(|p| std::ptr::eq(p, own));
    let write = |found: &PointResult<'_>| {
        let result = found.run.methods.first().context("a run without a method")?;
        let info = &found.point.job.info;
        let value = look(&Mapped { info, result, layers: &found.maps.layers, truth: found.truth })?;
        let number = number_of(found.point);
        let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(slot) = number.and_then(|number| seen.get_mut(number)) {
            *slot = Some(value);
        }
        Ok(())
    };
    for pass in split_into_passes(points.iter().collect()) {
        let numbers: Vec<usize> = pass.iter().filter_map(|&own| number_of(own)).collect();
        run_pass(recording, &pass, clock, &write, &mut |maps, moment| follow(maps, &numbers, moment))?;
    }
    let seen = seen.into_inner().unwrap_or_else(PoisonError::into_inner);
    seen.into_iter().map(|value| value.context("a point was left out of all passes")).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Observer, Plan, RealClock, evaluate};
    use evigrid_results::{MethodMaps, ResultsFolder, RunResult, SealedFile};

    /// Bits of the map at the end of a run.
    #[derive(Default)]
    struct Bits(Vec<u32>);

    impl Observer for Bits {
        fn end(&mut self, _: &RunResult, maps: &[MethodMaps<'_>], _: &Truth) -> Result<Vec<SealedFile>> {
            self.0 = bits(maps[0].layers[0].voxels().unwrap());
            Ok(Vec::new())
        }
    }

    fn bits(map: &LogOddsGrid) -> Vec<u32> {
        map.values().iter().map(|v| v.to_bits()).collect()
    }

    fn config(method: &str, set: &str) -> Config {
        let sets = ["run.frames=0..2", "grid.x_m=[0, 20]", "stereo.disparities=32", set].map(str::to_owned);
        let mut config = Config::load(None, &sets).unwrap();
        config.run.methods = vec![method.to_owned()];
        config
    }

    #[test]
    fn maps_are_those_of_single_runs_in_the_order_of_the_settings() {
        let configs = vec![
            config("cost-curve", "cost-curve.cost_unit=homogeneous"),
            config("winner-take-all", "winner-take-all.peak_ratio=3"),
            config("cost-curve", "stereo.window=9"),
            config("winner-take-all", "winner-take-all.peak_ratio=1.5"),
        ];
        let recording = Recording::open("synth:street").unwrap();
        let clock = RealClock::default();
        let look = |mapped: &Mapped<'_>| Ok(bits(mapped.voxels()?));
        let mut frames = 0;
        let together = map_together(&recording, configs.clone(), &clock, &look, &mut || frames += 1).unwrap();
        assert_eq!(frames, 2);
        for (config, together) in configs.into_iter().zip(together) {
            let dir = tempfile::tempdir().unwrap();
            let (folder, _) = ResultsFolder::open(dir.path()).unwrap();
            let mut single = Bits::default();
            evaluate(&Plan::new(config).unwrap(), &clock, &folder, &mut [&mut single]).unwrap();
            assert!(single.0 == together);
        }
    }

    /// After the last frame, what is followed is what is complete.
    #[test]
    fn every_map_is_followed_by_the_number_of_its_settings() {
        let checked = config("winner-take-all", "stereo.window=9");
        let configs =
            vec![config("cost-curve", "run.stride=1"), checked, config("cost-curve", "stereo.window=9")];
        let (recording, clock) = (Recording::open("synth:street").unwrap(), RealClock::default());
        let look = |mapped: &Mapped<'_>| Ok(bits(mapped.voxels()?));
        let (mut last, mut frames) = (vec![Vec::new(); 3], vec![Vec::new(); 3]);
        let complete = follow_together(&recording, configs, &clock, &look, &mut |number, seen| {
            frames[number].push(seen.frame.index());
            last[number] = bits(seen.layers[0].voxels().unwrap());
            Ok(())
        })
        .unwrap();
        assert_eq!(frames, [[0, 1], [0, 1], [0, 1]]);
        assert!(last == complete && last[0] != last[1] && last[1] != last[2]);
    }

    #[test]
    fn more_than_one_method_in_a_run_is_refused() {
        let mut config = config("cost-curve", "stereo.window=9");
        config.run.methods.push("winner-take-all".into());
        let recording = Recording::open("synth:street").unwrap();
        let look = |_: &Mapped<'_>| Ok(());
        let clock = RealClock::default();
        let error = map_together(&recording, vec![config], &clock, &look, &mut || {}).unwrap_err();
        assert!(error.to_string().contains("expected one method"), "{error}");
    }
}
