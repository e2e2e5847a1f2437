//! One drive past a ramp and a drop-off, with all that the method holds inside: Figs 2 to 4.

use anyhow::{Context, Result};
use evigrid_core::{Frame, Matching, Mounting};
use evigrid_eval::Config;
use evigrid_grid::{HybridModel, Mapper, Method};
use evigrid_safety_map::{Model, SafetyMapping};
use evigrid_synth::World;
use plotters::prelude::RGBColor;

use super::mapping::Drive;
use super::worlds::Entry;
use crate::cells::blend;
use crate::chart::Key;
use crate::job::Job;
use crate::journey::RobotAt;

/// The world after the paper's data set 1, which its Figs 1 to 4 show.
pub const WORLD: &str = "safety-1";
/// The frame of Figs 3 and 4: the robot stands before the railing, with the ramp ahead on its right and the drop-off
/// on its left.
pub const FRAME: usize = 165;

/// The paper's kind of matcher.
const MATCHER: &str = "multi-scale";

/// The settings of the drive.
pub fn config(world: &World) -> Result<Config> {
    Entry::plain(MATCHER, SafetyMapping::NAME).config(world)
}

/// A frame that is shown, and what the method has made so far.
pub struct Sight<'a> {
    pub frame: &'a Frame,
    pub matching: &'a Matching,
    pub mapper: &'a SafetyMapping,
    pub robot: RobotAt,
    /// Height of the robot's floor in the map frame, metres.
    pub floor_m: f64,
}

impl<'a> Sight<'a> {
    fn of(frame: &'a Frame, matching: &'a Matching, mapper: &'a SafetyMapping, mounting: Mounting) -> Self {
        let floor_m = frame.map_from_left().translation.z - mounting.height_m;
        Self { frame, matching, mapper, robot: RobotAt::of(frame, mounting), floor_m }
    }

    pub fn model(&self) -> Result<&'a Model> {
        self.mapper.model().context("no frame has been mapped")
    }

    pub fn hybrid(&self) -> Result<HybridModel> {
        self.mapper.hybrid_model().context("no frame has been mapped")
    }
}

/// Maps the drive up to the last of some frames, in rising order, and shows each of these.
pub fn drive(
    job: &mut Job<'_, '_>,
    shown: &[usize],
    look: &mut dyn FnMut(&Sight<'_>) -> Result<()>,
) -> Result<()> {
    let frames = shown.last().map_or(0, |last| last + 1);
    job.say(&format!("synth:{WORLD}, {frames} frames"));
    let drive = Drive::new(WORLD)?;
    let mut map = drive.mapping(MATCHER)?;
    for number in 0..frames {
        let frame = drive.frame(number)?;
        drive.add_and_look(&frame, &mut map, &mut |_| {}, &mut |mapper, matching| {
            let is_shown = shown.contains(&number);
            if is_shown { look(&Sight::of(&frame, matching, mapper, drive.mounting)) } else { Ok(()) }
        })?;
    }
    Ok(())
}

/// Heights over the robot's floor in colours: the lowest and the highest one that are told apart, metres.
#[derive(Debug, Clone, Copy)]
pub struct Heights(pub [f64; 2]);

/// Blue is below the floor, orange above it.
const BELOW: RGBColor = RGBColor(0, 70, 140);
const AT_FLOOR: RGBColor = RGBColor(222, 222, 222);
const ABOVE: RGBColor = RGBColor(190, 70, 0);

impl Heights {
    /// Where a height lies between the ends: 0.5 is the floor.
    pub fn share(self, height_m: f64) -> f64 {
        let end_m = if height_m < 0.0 { self.0[0].abs() } else { self.0[1] };
        (0.5 + 0.5 * height_m / end_m).clamp(0.0, 1.0)
    }

    /// What the colours mean.
    pub fn key(self) -> Vec<Key> {
        let [lowest_m, highest_m] = self.0;
        let heights = [lowest_m, 0.5 * lowest_m, 0.0, 0.5 * highest_m, highest_m];
        let text = |height_m: f64| match height_m {
            0.0 => "at the robot's floor".to_owned(),
            _ => format!("{height_m:+.1} m"),
        };
        heights.map(|h| (text(h), height_colour(self.share(h)))).into()
    }
}

/// The colour of a share.
pub fn height_colour(share: f64) -> RGBColor {
    if share < 0.5 { blend(BELOW, AT_FLOOR, 2.0 * share) } else { blend(AT_FLOOR, ABOVE, 2.0 * share - 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_is_grey_and_the_ends_are_reached() {
        let heights = Heights([-0.6, 1.2]);
        assert_eq!([0.0, -0.3, 0.6].map(|h| heights.share(h)), [0.5, 0.25, 0.75]);
        let colours = [0.0, -2.0, 1.2].map(|h| height_colour(heights.share(h)));
        assert_eq!(colours, [AT_FLOOR, BELOW, ABOVE]);
        assert_eq!(heights.key()[1], ("-0.3 m".to_owned(), height_colour(0.25)));
    }
}
