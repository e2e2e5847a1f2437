use anyhow::Result;
use evigrid_core::Matches;
use evigrid_eval::{Step, turbo};
use rerun::components::ImageFormat;
use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};
use rerun::{AnnotationContext, ChannelDatatype, SegmentationImage};

use crate::blueprint::Pane;
use crate::part::{Out, Part, Shown, Slot, Start};

/// The disparity as a picture.
const DISPARITY: &str = "disparity";

/// Colours from far to near, one per number of the picture; number 0 is no disparity.
const LEVELS: u8 = 255;
/// Matches whose winner in the right image points elsewhere by more than this are left out of the picture.
const CONSISTENT_PX: u16 = 1;

/// Disparities at half the size of the image, in colours from blue (far) to red (near), black where nothing
/// was matched. Written as an image of labels: that costs no encoding, and the viewer names the disparity of
/// a pixel.
#[derive(Debug)]
pub(crate) struct DisparityPart {
    /// The disparity that is shown as nearest, pixels.
    nearest_px: f32,
}

impl Part for DisparityPart {
    /// Colours and names of the levels.
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let nothing = (0, "no consistent match", Rgba32::from_rgb(0, 0, 0));
        let levels = (1..=LEVELS).map(|level| {
            let share = f32::from(level - 1) / f32::from(LEVELS - 1);
            let [r, g, b] = turbo(share);
            let name = format!("{:.1} px", share * share * self.nearest_px);
            AnnotationInfo::from((u16::from(level), name.as_str(), Rgba32::from_rgb(r, g, b)))
        });
        let levels = std::iter::once(AnnotationInfo::from(nothing)).chain(levels).map(ClassDescription::from);
        out.always(DISPARITY, &AnnotationContext::new(levels))
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let Some(matching) = step.matching else { return Ok(()) };
        let (size, levels) = self.draw(&matching.matches);
        let format = ImageFormat::segmentation(size, ChannelDatatype::U8);
        out.log(DISPARITY, &SegmentationImage::new(levels, format))
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        vec![(Slot::Image, Pane::new("2D", "disparity: blue far, red near", DISPARITY))]
    }
}

impl DisparityPart {
    pub fn new(start: Start<'_>) -> Self {
        let stereo = &start.config.stereo;
        Self::up_to((stereo.min_disparity + stereo.disparities) as f32)
    }

    /// `nearest_px` is the largest disparity that can occur.
    fn up_to(nearest_px: f32) -> Self {
        Self { nearest_px: nearest_px.max(1.0) }
    }

    /// Width and height, and the level of each pixel: that of the first match of the 2 x 2 pixels it stands
    /// for.
    fn draw(&self, matches: &Matches) -> ([u32; 2], Vec<u8>) {
        let disparity = &matches.disparity;
        let full = disparity.width();
        let (width, height) = (full.div_ceil(2), disparity.height().div_ceil(2));
        let mut levels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let right = usize::from(2 * x + 1 < full);
                let below = if 2 * y + 1 < disparity.height() { full } else { 0 };
                let at = 2 * y * full + 2 * x;
                let known = [at, at + right, at + below, at + below + right].into_iter().find(|&i| {
                    !disparity.values()[i].is_nan() && matches.left_right_difference_px[i] <= CONSISTENT_PX
                });
                levels.push(known.map_or(0, |i| self.level(disparity.values()[i])));
            }
        }
        ([width as u32, height as u32], levels)
    }

    /// The root of the disparity sets the colour: much of a road lies far away.
    fn level(&self, disparity_px: f32) -> u8 {
        let share = (disparity_px / self.nearest_px).clamp(0.0, 1.0).sqrt();
        1 + (share * f32::from(LEVELS - 1)).round() as u8
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_core::Disparity;

    #[test]
    fn a_pixel_stands_for_the_first_consistent_match_of_four() {
        let nan = f32::NAN;
        let values = vec![nan, nan, 64.0, nan, 0.0, nan, nan, nan, nan];
        let mut matches = Matches::from_disparity(Disparity::new(3, 3, values).unwrap());
        let writer = DisparityPart::up_to(64.0);
        assert_eq!(writer.draw(&matches), ([2, 2], vec![1, LEVELS, 0, 0]));
        matches.left_right_difference_px[2] = 2;
        assert_eq!(writer.draw(&matches).1, [1, 0, 0, 0]);
    }

    #[test]
    fn near_has_a_higher_level_than_far() {
        let writer = DisparityPart::up_to(64.0);
        assert!(writer.level(1.0) < writer.level(2.0) && writer.level(999.0) == LEVELS);
    }
}
