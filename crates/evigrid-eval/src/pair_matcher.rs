use anyhow::{Context, Result};
use evigrid_core::{Frame, Matches};
use evigrid_grid::View;
use evigrid_replay::read_disparity_png;
use evigrid_stereo::{Matcher, Matching};

use crate::Config;

/// Computes or reads the matches of a frame, which all methods share.
#[derive(Debug)]
pub(crate) struct PairMatcher {
    matcher: Matcher,
    disparity_dir: String,
    /// Buffers of the frame before.
    recycled: Option<Matching>,
}

impl PairMatcher {
    /// The matcher of these settings.
    pub fn new(config: &Config) -> Result<Self> {
        let disparity_dir = config.input.disparity_dir.clone();
        Ok(Self { matcher: Matcher::new(config.stereo)?, disparity_dir, recycled: None })
    }

    /// The matches of a frame, with the cost volume if it is wanted and there is one.
    pub fn run(&mut self, frame: &Frame, keep_volume: bool) -> Result<Matching> {
        if !self.disparity_dir.is_empty() {
            return read_matching(&self.disparity_dir, frame)
                .with_context(|| format!("frame {}", frame.index()));
        }
        self.matcher
            .run(frame.left(), frame.right(), keep_volume, self.recycled.take())
            .with_context(|| format!("frame {}", frame.index()))
    }

    /// Gives the buffers of a frame that is done back, so that the next one can fill them.
    pub fn recycle(&mut self, matching: Matching) {
        self.recycled = Some(matching);
    }
}

/// What mapping methods see of a frame.
pub(crate) fn view<'a>(frame: &'a Frame, matching: &'a Matching) -> View<'a> {
    View {
        rig: frame.rig(),
        map_from_left: frame.map_from_left(),
        left: frame.left(),
        right: frame.right(),
        matches: &matching.matches,
        volume: matching.volume.as_ref(),
    }
}

/// A disparity image that comes from elsewhere.
fn read_matching(dir: &str, frame: &Frame) -> Result<Matching> {
    let path = std::path::Path::new(dir).join(png_name(frame));
    let disparity = read_disparity_png(&path)?;
    let (width, height) = (disparity.width(), disparity.height());
    if (width, height) != (frame.rig().width, frame.rig().height) {
        let rig = frame.rig();
        anyhow::bail!(
            "disparity image: expected {}x{} like the left image, found {width}x{height}: {}",
            rig.width,
            rig.height,
            path.display()
        );
    }
    Ok(Matching { matches: Matches::from_disparity(disparity), volume: None })
}

/// Name of a frame's disparity image, as KITTI numbers its files.
pub(crate) fn png_name(frame: &Frame) -> String {
    format!("{:010}.png", frame.index())
}
