//! `safety-map` in the making on a drive through a world, so that its 3-D model can be looked at after every frame.

use std::ops::Range;

use anyhow::{Context, Result};
use evigrid_core::{Frame, Matching, Mounting, Pose, View};
use evigrid_eval::{MatchSource, Recording};
use evigrid_grid::{GridSpec, Method};
use evigrid_replay::map_from_world;
use evigrid_safety_map::{Model, SafetyMapping, Stage};
use evigrid_synth::World;

use super::worlds::Entry;

/// A drive through a world.
pub struct Drive {
    pub world: World,
    pub map_from_world: Pose,
    pub mounting: Mounting,
    recording: Recording,
}

/// One map in the making, on the matches of one matcher.
pub struct Mapping {
    pub matcher: &'static str,
    pub mapper: SafetyMapping,
    source: MatchSource,
}

impl Drive {
    /// The drive of a built-in world with its robot, in the map frame of its first frame.
    pub fn new(name: &str) -> Result<Self> {
        let world = World::builtin(name)?;
        let recording = Recording::from(world.clone());
        let sequence = recording.sequence();
        let map_from_world = map_from_world(&sequence.world_from_left(0)?);
        let mounting = sequence.info().mounting.context("a world whose camera stands nowhere")?;
        Ok(Self { world, map_from_world, mounting, recording })
    }

    /// Numbers of all frames.
    pub fn frames(&self) -> Range<usize> {
        0..self.world.frame_count()
    }

    /// A frame in the map frame.
    pub fn frame(&self, index: usize) -> Result<Frame> {
        Ok(self.recording.sequence().frame(index, &self.map_from_world)?)
    }

    /// An empty map with the paper's settings (decr 1) on the world's grid.
    pub fn mapping(&self, matcher: &'static str) -> Result<Mapping> {
        let entry = Entry::plain(matcher, SafetyMapping::NAME);
        let config = entry.config(&self.world)?;
        let settings = config.methods.of::<SafetyMapping>()?;
        let mapper = SafetyMapping::new(GridSpec::new(&config.grid)?, settings)?;
        Ok(Mapping {
            matcher,
            mapper,
            source: MatchSource::new(&config, Some(self.mounting), Some(&self.world))?,
        })
    }

    /// Matches a frame and adds it to a map. `done` is told when a stage of the frame is done.
    ///
    /// Returned is whether the method has used the frame: it drops those of a standing robot.
    pub fn add(&self, frame: &Frame, to: &mut Mapping, done: &mut dyn FnMut(Option<Stage>)) -> Result<bool> {
        let mut is_used = false;
        let mut all = |stage: Option<Stage>| {
            is_used |= stage.is_some();
            done(stage);
        };
        self.add_and_look(frame, to, &mut all, &mut |_, _| Ok(()))?;
        Ok(is_used)
    }

    /// The same, and shows the map with what was matched.
    pub fn add_and_look(
        &self,
        frame: &Frame,
        to: &mut Mapping,
        done: &mut dyn FnMut(Option<Stage>),
        look: &mut dyn FnMut(&SafetyMapping, &Matching) -> Result<()>,
    ) -> Result<()> {
        let matching = to.source.run(frame, SafetyMapping::NEEDS)?;
        done(None);
        let view = View::new(frame, Some(self.mounting), &matching);
        to.mapper.integrate_by_stages(&view, &mut |stage| done(Some(stage)))?;
        look(&to.mapper, &matching)?;
        to.source.recycle(matching);
        Ok(())
    }
}

impl Mapping {
    /// The 3-D model, which is there from the first frame on.
    pub fn model(&self) -> Result<&Model> {
        self.mapper.model().context("a map before its first frame")
    }
}
