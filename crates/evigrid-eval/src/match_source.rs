use anyhow::{Context, Result};
use evigrid_core::{Frame, Matching};
use evigrid_grid::Needs;
use evigrid_replay::read_disparity_png;
use evigrid_stereo::{Extras, Matcher};

use crate::Config;

/// Computes or reads the matches of a frame, which all methods share.
#[derive(Debug)]
pub(crate) struct MatchSource {
    matcher: Matcher,
    disparity_dir: String,
    /// Buffers of the frame before.
    recycled: Option<Matching>,
}

impl MatchSource {
    /// The matcher of these settings.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(config: &Config) -> Result<Self> {
        let disparity_dir = config.input.disparity_dir.clone();
        Ok(Self { matcher: Matcher::new(config.stereo)?, disparity_dir, recycled: None })
    }

    /// The matches of a frame, with what methods need beside them.
    ///
    /// # Errors
    /// If the images cannot be matched, or the disparity image cannot be read or has another size.
    pub fn run(&mut self, frame: &Frame, needs: Needs) -> Result<Matching> {
        let wanted = Extras { costs: needs.costs, road: needs.road };
        if !self.disparity_dir.is_empty() {
            return read_matching(&self.disparity_dir, frame)
                .with_context(|| format!("frame {}", frame.index()));
        }
        self.matcher
            .run(frame.left(), frame.right(), wanted, self.recycled.take())
            .with_context(|| format!("frame {}", frame.index()))
    }

    /// Gives the buffers of a frame that is done back, so that the next one can fill them.
    pub fn recycle(&mut self, matching: Matching) {
        self.recycled = Some(matching);
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
