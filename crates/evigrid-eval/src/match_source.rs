use std::ops::Range;

use anyhow::{Context, Result};
use evigrid_core::{Disparity, Frame, GroundPlane, Matches, Matching, Mounting, RoadSplit};
use evigrid_grid::Needs;
use evigrid_replay::read_disparity_png;
use evigrid_stereo::{Extras, Matcher, MatcherKind, PairTask};
use evigrid_synth::{LeftViewTruth, PixelTruth, World};

use crate::Config;

/// Computes or reads the matches of a frame, which all methods share.
#[derive(Debug)]
pub struct MatchSource {
    origin: Origin,
    mounting: Option<Mounting>,
    /// Buffers of the frame before.
    recycled: Option<Matching>,
}

/// Where matches come from.
#[derive(Debug)]
enum Origin {
    Matcher(Box<Matcher>),
    /// A folder of disparity images.
    Folder(String),
    /// The shapes of a world.
    Exact(Box<Exact>),
}

/// Exact disparities of a world, and those that a matcher with the same settings would have tried.
#[derive(Debug)]
struct Exact {
    world: World,
    tried: Range<usize>,
}

/// Surfaces less than this above or below the ground are road, metres: kerbs and pavements count as road.
const ROAD_WITHIN_M: f64 = 0.15;

impl MatchSource {
    /// The matches of these settings; `world` is the world of a synthetic recording, `mounting` how the camera
    /// stands over the ground, where that is known.
    ///
    /// # Errors
    /// If a setting of the matcher is outside its domain, or the matcher needs a world and there is none.
    pub fn new(config: &Config, mounting: Option<Mounting>, world: Option<&World>) -> Result<Self> {
        let folder = &config.input.disparity_dir;
        let origin = match (config.stereo.matcher, world) {
            _ if !folder.is_empty() => Origin::Folder(folder.clone()),
            (MatcherKind::Exact, Some(world)) => {
                let stereo = &config.stereo;
                let tried = stereo.min_disparity..stereo.min_disparity + stereo.disparities;
                Origin::Exact(Box::new(Exact { world: world.clone(), tried }))
            }
            _ => Origin::Matcher(Box::new(Matcher::new(config.stereo)?)),
        };
        Ok(Self { origin, mounting, recycled: None })
    }

    /// The matches of a frame, with what methods need beside them.
    ///
    /// # Errors
    /// If the images cannot be matched, or the disparity image cannot be read or has another size.
    pub fn run(&mut self, frame: &Frame, needs: Needs) -> Result<Matching> {
        let wanted = Extras { costs: needs.costs, road: needs.road };
        let matching = match &mut self.origin {
            Origin::Folder(folder) => read_matching(folder, frame),
            Origin::Exact(exact) => exact.matching(frame, self.mounting.filter(|_| wanted.road)),
            Origin::Matcher(matcher) => {
                let ground = self.mounting.map(|m| GroundPlane::below(&m).disparities(frame.rig()));
                let (left, right, recycled) = (frame.left(), frame.right(), self.recycled.take());
                matcher.run(PairTask { left, right, wanted, ground, recycled }).map_err(Into::into)
            }
        };
        matching.with_context(|| format!("frame {}", frame.index()))
    }

    /// Gives the buffers of a frame that is done back, so that the next one can fill them.
    pub fn recycle(&mut self, matching: Matching) {
        self.recycled = Some(matching);
    }
}

impl Exact {
    /// The true disparities, where both cameras see the point; road and obstacles apart, by their true heights over
    /// the ground, if the mounting is given.
    fn matching(&self, frame: &Frame, mounting: Option<Mounting>) -> Result<Matching> {
        let view = LeftViewTruth::new(&self.world, frame.index());
        let (width, height) = (view.width(), view.height());
        let seen = |pixel: &PixelTruth| if pixel.seen_by_right { pixel.disparity_px } else { f32::NAN };
        let values: Vec<f32> = view.pixels().iter().map(seen).collect();
        let road = mounting.map(|mounting| self.split(frame, &GroundPlane::below(&mounting), &values));
        let matches = Matches::from_disparity(Disparity::new(width, height, values)?);
        Ok(Matching { road: road.transpose()?, ..Matching::from(matches) })
    }

    fn split(&self, frame: &Frame, ground: &GroundPlane, all: &[f32]) -> Result<RoadSplit> {
        let rig = frame.rig();
        let is_road = |pixel: usize| {
            let (column, row) = ((pixel % rig.width) as f64, (pixel / rig.width) as f64);
            let point = rig.ray(column, row) * rig.depth_m(f64::from(all[pixel]));
            ground.height_of_m(&point).abs() < ROAD_WITHIN_M
        };
        let part = |wanted: bool| {
            let value = |pixel: usize| if is_road(pixel) == wanted { all[pixel] } else { f32::NAN };
            Disparity::new(rig.width, rig.height, (0..all.len()).map(value).collect())
        };
        let tried = self.tried.clone();
        Ok(RoadSplit { road: part(true)?, obstacles: part(false)?, ground: ground.disparities(rig), tried })
    }
}

/// A disparity image that comes from elsewhere.
fn read_matching(dir: &str, frame: &Frame) -> Result<Matching> {
    let path = std::path::Path::new(dir).join(png_name(frame));
    let disparity = read_disparity_png(&path)?;
    let (rig, width, height) = (frame.rig(), disparity.width(), disparity.height());
    if (width, height) != (rig.width, rig.height) {
        anyhow::bail!(
            "disparity image: expected {}x{} like the left image, found {width}x{height}: {}",
            rig.width,
            rig.height,
            path.display()
        );
    }
    Ok(Matching::from_disparity(disparity))
}

/// Name of a frame's disparity image, as KITTI numbers its files.
pub(crate) fn png_name(frame: &Frame) -> String {
    format!("{:010}.png", frame.index())
}
