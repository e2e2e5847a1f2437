use anyhow::Result;
use evigrid_core::{Frame, Matches};
use evigrid_eval::Step;
use evigrid_grid::{Layer, SafetyLabel, SafetyMap};
use evigrid_results::label_rgb;
use nalgebra::Point3;
use rerun::components::ImageFormat;
use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};
use rerun::{AnnotationContext, ChannelDatatype, SegmentationImage};

use crate::blueprint::Pane;
use crate::camera::IMAGE;
use crate::part::{Out, Part, Shown, Slot, Start};
use crate::safety::LEGEND;

/// Below it lie the labels of all methods, in pixels of the left image.
pub(crate) const LABELS: &str = "world/left/image/labels";

/// Matches whose winner in the right image points elsewhere by more than this have no label.
const CONSISTENT_PX: u16 = 1;
/// Points so far over a safe cell do not belong to its ground. Cells.
const GROUND_CELLS: f64 = 2.0;
/// The number of a pixel without a label.
const NO_LABEL: u8 = 0;

/// The safety map of one method drawn back into the left image: each pixel that was matched has the label of the
/// cell that it shows. Written as an image of labels that lies half transparent over the camera's image: that
/// costs no second image, and the viewer names the label of a pixel.
pub(crate) struct LabelledImagePart {
    number: usize,
    method: String,
}

impl LabelledImagePart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        Self { number, method: start.info.methods[number].name.clone() }
    }

    fn path(&self) -> String {
        format!("{LABELS}/{}", self.method)
    }
}

impl Part for LabelledImagePart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let nothing = (u16::from(NO_LABEL), "no label", Rgba32::from_unmultiplied_rgba(0, 0, 0, 0));
        let labels = SafetyLabel::ALL.map(|label| {
            let [r, g, b] = label_rgb(label);
            AnnotationInfo::from((u16::from(number(label)), label.name(), Rgba32::from_rgb(r, g, b)))
        });
        let all = std::iter::once(AnnotationInfo::from(nothing)).chain(labels).map(ClassDescription::from);
        out.always(self.path(), &AnnotationContext::new(all))?;
        out.always(self.path(), &SegmentationImage::update_fields().with_opacity(0.5))
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let layers = step.methods[self.number].layers;
        let Some(map) = layers.iter().find_map(Layer::safety) else { return Ok(()) };
        let Some(matching) = step.matching else { return Ok(()) };
        let size = [step.frame.rig().width as u32, step.frame.rig().height as u32];
        let format = ImageFormat::segmentation(size, ChannelDatatype::U8);
        let numbers = draw(step.frame, &matching.matches, map);
        out.log(self.path(), &SegmentationImage::update_fields().with_buffer(numbers).with_format(format))
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let pane = Pane::new("2D", format!("{} in the left image: {LEGEND}", self.method), IMAGE);
        let contents = vec!["+ $origin".into(), format!("+ /{}", self.path())];
        vec![(Slot::Image, Pane { contents, ..pane })]
    }
}

/// The number of a label in the image.
fn number(label: SafetyLabel) -> u8 {
    label as u8 + 1
}

/// The number of each pixel, row by row.
fn draw(frame: &Frame, matches: &Matches, map: &SafetyMap) -> Vec<u8> {
    let (rig, pose) = (frame.rig(), frame.map_from_left());
    let pixel = |(n, &disparity_px): (usize, &f32)| {
        if !(disparity_px > 0.0 && matches.left_right_difference_px[n] <= CONSISTENT_PX) {
            return NO_LABEL;
        }
        let ray = rig.ray((n % rig.width) as f64, (n / rig.width) as f64);
        let point = pose * Point3::from(ray * rig.depth_m(f64::from(disparity_px)));
        label_at(map, point).map_or(NO_LABEL, number)
    };
    matches.disparity.values().iter().enumerate().map(pixel).collect()
}

/// The label of a point of the map frame: that of its cell, unless nobody has examined it or the point hangs over
/// safe ground.
fn label_at(map: &SafetyMap, point: Point3<f64>) -> Option<SafetyLabel> {
    let cell = map.spec().cell_of([point.x, point.y])?;
    let label = map.labels()[cell];
    let ground_m = map.plane_of(cell).and_then(|plane| plane.height_m([point.x, point.y]));
    let hangs = ground_m.is_some_and(|z| point.z - z > GROUND_CELLS * map.spec().cell_size_m());
    match label {
        SafetyLabel::Unexamined => None,
        SafetyLabel::Level | SafetyLabel::Inclined if hangs => None,
        _ => Some(label),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use SafetyLabel::{Inclined, Level, NonGround, Unexamined, Unknown};
    use evigrid_core::{Disparity, GrayImage, Pose, StereoRig};
    use evigrid_grid::{PlanSpec, SafetyPlane};
    use nalgebra::Vector3;

    const RIG: StereoRig =
        StereoRig { width: 8, height: 6, focal_px: 7.0, centre_x_px: 3.5, centre_y_px: 2.5, baseline_m: 0.5 };
    /// The disparity at a depth of 7 m, where a pixel is as large as a cell.
    const AT_7_M: f32 = 0.5;

    /// A map of 1 m cells that the camera, whose axes are those of the map, sees one cell per pixel.
    fn map() -> SafetyMap {
        let mut map = SafetyMap::unknown(PlanSpec::of_area([-4.0, 4.0], [-3.0, 3.0], 1.0).unwrap());
        let ground = map.add_plane(SafetyPlane { normal: Vector3::z(), offset_m: 6.5 });
        let deep = map.add_plane(SafetyPlane { normal: Vector3::z(), offset_m: 4.5 });
        let mut set = |x: usize, y: usize, label, plane| map.set(6 * x + y, label, plane);
        set(0, 0, Level, Some(ground));
        set(1, 0, Inclined, Some(ground));
        set(7, 0, Level, Some(deep));
        set(7, 1, NonGround, Some(deep));
        set(2, 5, NonGround, None);
        set(3, 1, Unexamined, None);
        map
    }

    fn drawn(disparity: Vec<f32>, inconsistent: usize) -> Vec<Vec<u8>> {
        let image = || GrayImage::new(8, 6, vec![0; 48]).unwrap();
        let frame = Frame::new(0, 0, RIG, image(), image(), Pose::identity(), None).unwrap();
        let mut matches = Matches::from_disparity(Disparity::new(8, 6, disparity).unwrap());
        matches.left_right_difference_px[inconsistent] = CONSISTENT_PX + 1;
        draw(&frame, &matches, &map()).chunks(8).map(<[u8]>::to_vec).collect()
    }

    #[test]
    fn a_pixel_has_the_label_of_the_cell_that_it_shows() {
        let mut disparity = vec![AT_7_M; 48];
        // No match, infinitely far, and so far that the point lies beside the map.
        (disparity[8 + 5], disparity[8 + 6], disparity[16]) = (f32::NAN, 0.0, AT_7_M / 2.0);
        let [l, i, n, u] = [Level, Inclined, NonGround, Unknown].map(number);
        let expected = [
            [l, i, u, u, u, u, u, 0],
            [u, u, u, 0, u, 0, 0, n],
            [0, u, u, u, u, u, u, u],
            [u, u, u, u, u, u, u, u],
            [u, u, u, u, u, u, 0, u],
            [u, u, n, u, u, u, u, u],
        ];
        assert_eq!(drawn(disparity, 4 * 8 + 6), expected);
    }
}
