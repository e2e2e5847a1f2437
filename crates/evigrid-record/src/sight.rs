use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::{Picture, PixelLabel};
use rerun::components::{ImageFormat, Radius};
use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};
use rerun::{AnnotationContext, ChannelDatatype, Color, ColorModel, Image, Points2D, SegmentationImage};

use crate::blueprint::Pane;
use crate::camera::IMAGE;
use crate::labelled_image::LABELS;
use crate::part::{Out, Part, Shown, Slot, Start};

/// Rows between two pictures.
const GAP: usize = 12;

/// What a method has made of the frame on the way to its map: pictures one below the other, and the left image with
/// what is free and what is occupied.
pub(crate) struct SightPart {
    number: usize,
    method: String,
    has_pictures: bool,
    has_labels: bool,
}

impl SightPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        let method = start.info.methods[number].name.clone();
        Self { number, method, has_pictures: false, has_labels: false }
    }

    fn path(&self) -> String {
        format!("on_the_way/{}", self.method)
    }

    fn label_path(&self) -> String {
        format!("{LABELS}/{}/sight", self.method)
    }
}

impl SightPart {
    /// Names and colours of the labels, before the first of them.
    fn write_classes(&self, out: &mut Out<'_>) -> Result<()> {
        let classes = [
            (PixelLabel::Unknown, "not known", Rgba32::from_unmultiplied_rgba(0, 0, 0, 0)),
            (PixelLabel::Free, "free", Rgba32::from_rgb(0, 114, 178)),
            (PixelLabel::Occupied, "occupied", Rgba32::from_rgb(213, 94, 0)),
        ];
        let classes = classes.map(|(label, name, colour)| {
            ClassDescription::from(AnnotationInfo::from((label as u16, name, colour)))
        });
        out.always(self.label_path(), &AnnotationContext::new(classes))?;
        out.always(self.label_path(), &SegmentationImage::update_fields().with_opacity(0.5))
    }
}

impl Part for SightPart {
    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let pictures = step.methods[self.number].pictures.get();
        if !pictures.list.is_empty() {
            self.has_pictures = true;
            let (size, pixels) = sheet(&pictures.list);
            let format = ImageFormat::from_color_model(size, ColorModel::L, ChannelDatatype::U8);
            out.log(self.path(), &Image::new(pixels, format))?;
            out.log(format!("{}/names", self.path()), &names(&pictures.list))?;
        }
        if !pictures.labels.is_empty() {
            if !self.has_labels {
                self.write_classes(out)?;
                self.has_labels = true;
            }
            let size = [step.frame.rig().width as u32, step.frame.rig().height as u32];
            let format = ImageFormat::segmentation(size, ChannelDatatype::U8);
            let numbers: Vec<u8> = pictures.labels.iter().map(|label| *label as u8).collect();
            let image = SegmentationImage::update_fields().with_buffer(numbers).with_format(format);
            out.log(self.label_path(), &image)?;
        }
        Ok(())
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let mut panes = Vec::new();
        if self.has_labels {
            let title = format!("{} in the left image: blue = free, orange = occupied", self.method);
            let pane = Pane::new("2D", title, IMAGE);
            let contents = vec!["+ $origin".into(), format!("+ /{}", self.label_path())];
            panes.push((Slot::Image, Pane { contents, ..pane }));
        }
        if self.has_pictures {
            let title = format!("{}: columns of the image over disparities, near is below", self.method);
            panes.push((Slot::Scores, Pane::new("2D", title, &self.path())));
        }
        panes
    }
}

/// All pictures, two beside each other, dark where they are large; size and pixels.
fn sheet(list: &[Picture]) -> ([u32; 2], Vec<u8>) {
    let (width, height) = cell(list);
    let (columns, rows) = (2, list.len().div_ceil(2));
    let size = [columns * width, rows * height];
    let mut pixels = vec![40; size[0] * size[1]];
    for (n, picture) in list.iter().enumerate() {
        let [x, y] = corner(list, n);
        for (row, shares) in picture.shares.chunks_exact(picture.width).enumerate() {
            let start = (y + row) * size[0] + x;
            let to = &mut pixels[start..start + picture.width];
            to.iter_mut().zip(shares).for_each(|(to, share)| *to = 255 - share);
        }
    }
    (size.map(|n| n as u32), pixels)
}

/// Room for one picture and the gap below and beside it.
fn cell(list: &[Picture]) -> (usize, usize) {
    let most = |of: fn(&Picture) -> usize| list.iter().map(of).max().unwrap_or(0);
    (most(|picture| picture.width) + GAP, most(|picture| picture.height) + GAP)
}

/// Where a picture begins.
fn corner(list: &[Picture], n: usize) -> [usize; 2] {
    let (width, height) = cell(list);
    [n % 2 * width, n / 2 * height + GAP]
}

/// The names of the pictures, above them.
fn names(list: &[Picture]) -> Points2D {
    let places = (0..list.len()).map(|n| {
        let [x, y] = corner(list, n);
        [(x + list[n].width / 2) as f32, y as f32 - GAP as f32]
    });
    Points2D::new(places)
        .with_labels(list.iter().map(|picture| picture.name))
        .with_show_labels(true)
        .with_colors([Color::from_rgb(200, 200, 200)])
        .with_radii([Radius::new_ui_points(0.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_two_by_two() {
        let picture = |share| Picture { name: "p", width: 3, height: 2, shares: vec![share; 6] };
        let list = [picture(255), picture(0), picture(100)];
        let ([width, height], pixels) = sheet(&list);
        assert_eq!([width, height], [30, 28]);
        let at = |x: usize, y: usize| pixels[y * 30 + x];
        assert_eq!([at(0, GAP), at(15, GAP), at(2, 14 + GAP), at(20, 20)], [0, 255, 155, 40]);
    }
}
