use anyhow::{Context, Result};
use evigrid_core::{Disparity, Frame, Matching};
use evigrid_grid::Needs;
use evigrid_replay::read_disparity_png;
use evigrid_stereo::{Extras, Matcher, MatcherKind};
use evigrid_synth::{LeftViewTruth, PixelTruth, World};

use crate::Config;

/// Computes or reads the matches of a frame, which all methods share.
#[derive(Debug)]
pub struct MatchSource {
    origin: Origin,
    /// Buffers of the frame before.
    recycled: Option<Matching>,
}

/// Where matches come from.
#[derive(Debug)]
enum Origin {
    Matcher(Matcher),
    /// A folder of disparity images.
    Folder(String),
    /// The shapes of a world.
    Exact(Box<World>),
}

impl MatchSource {
    /// The matches of these settings; `world` is the world of a synthetic recording.
    ///
    /// # Errors
    /// If a setting of the matcher is outside its domain, or the matcher needs a world and there is none.
    pub fn new(config: &Config, world: Option<&World>) -> Result<Self> {
        let folder = &config.input.disparity_dir;
        let origin = match (config.stereo.matcher, world) {
            _ if !folder.is_empty() => Origin::Folder(folder.clone()),
            (MatcherKind::Exact, Some(world)) => Origin::Exact(Box::new(world.clone())),
            _ => Origin::Matcher(Matcher::new(config.stereo)?),
        };
        Ok(Self { origin, recycled: None })
    }

    /// The matches of a frame, with what methods need beside them.
    ///
    /// # Errors
    /// If the images cannot be matched, or the disparity image cannot be read or has another size.
    pub fn run(&mut self, frame: &Frame, needs: Needs) -> Result<Matching> {
        let wanted = Extras { costs: needs.costs, road: needs.road };
        let matching = match &mut self.origin {
            Origin::Folder(folder) => read_matching(folder, frame),
            Origin::Exact(world) => exact_matching(world, frame.index()),
            Origin::Matcher(matcher) => {
                let recycled = self.recycled.take();
                matcher.run(frame.left(), frame.right(), wanted, recycled).map_err(Into::into)
            }
        };
        matching.with_context(|| format!("frame {}", frame.index()))
    }

    /// Gives the buffers of a frame that is done back, so that the next one can fill them.
    pub fn recycle(&mut self, matching: Matching) {
        self.recycled = Some(matching);
    }
}

/// The true disparities of a world, where both cameras see the point.
fn exact_matching(world: &World, frame: usize) -> Result<Matching> {
    let view = LeftViewTruth::new(world, frame);
    let seen = |pixel: &PixelTruth| if pixel.seen_by_right { pixel.disparity_px } else { f32::NAN };
    let values = view.pixels().iter().map(seen).collect();
    Ok(Matching::from_disparity(Disparity::new(view.width(), view.height(), values)?))
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
