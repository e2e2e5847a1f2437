//! The test picture: the world `andert-posts`, its exact disparities and those that are matched.

use anyhow::Result;
use evigrid_core::{Disparity, Frame, Matching, Pose, View};
use evigrid_eval::Config;
use evigrid_grid::{GridSettings, GridSpec};
use evigrid_replay::{Sequence, map_from_world};
use evigrid_stereo::BlockMatcher;
use evigrid_synth::{LeftViewTruth, SyntheticSequence, World};

pub const WORLD: &str = "andert-posts";
/// Where the sensor's range ends, metres.
pub const RANGE_M: f64 = 25.0;
/// The paper's cells, metres.
pub const CELLS_M: [f64; 3] = [1.0, 0.5, 0.25];
/// The camera stands so high above the meadow, metres.
pub const CAMERA_M: f64 = 3.0;

/// The picture with what is known of it.
pub struct Scene {
    pub world: World,
    pub map_from_world: Pose,
    pub frame: Frame,
    /// The true disparities up to the sensor's range, none beyond: as many valid pixels as in the paper.
    pub exact: Matching,
    /// Those of block matching.
    pub matched: Matching,
}

impl Scene {
    pub fn new() -> Result<Self> {
        let world = World::builtin(WORLD)?;
        let map_from_world = map_from_world(&world.true_world_from_left(0));
        let frame = SyntheticSequence::new(world.clone()).frame(0, &map_from_world)?;
        let truth = LeftViewTruth::new(&world, 0);
        let near = |depth_m: f64, disparity: f32| if depth_m <= RANGE_M { disparity } else { f32::NAN };
        let values = truth.pixels().iter().map(|pixel| near(pixel.depth_m, pixel.disparity_px)).collect();
        let exact = Matching::from_disparity(Disparity::new(truth.width(), truth.height(), values)?);
        let mut matcher = BlockMatcher::new(Config::default().stereo.block())?;
        let matched = matcher.run(frame.left(), frame.right(), false, None)?;
        Ok(Self { world, map_from_world, frame, exact, matched })
    }

    /// The picture as methods see it.
    pub fn view<'a>(&'a self, matching: &'a Matching) -> View<'a> {
        View::new(&self.frame, None, matching)
    }
}

/// A grid that the sensor's box fits into; the camera stands at the corner of a cell and looks along x.
pub fn grid(cell_size_m: f64) -> Result<GridSpec> {
    let settings = GridSettings { x_m: [-1.0, 27.0], y_m: [-13.0, 13.0], z_m: [-10.0, 10.0], cell_size_m };
    Ok(GridSpec::new(&settings)?)
}
