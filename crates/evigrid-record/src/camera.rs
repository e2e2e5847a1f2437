use anyhow::{Context, Result};
use evigrid_core::{GrayImage, Pose, StereoRig};
use evigrid_eval::Step;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use nalgebra::Quaternion;
use rerun::components::MediaType;
use rerun::{EncodedImage, Pinhole, Transform3D};

use crate::blueprint::Pane;
use crate::part::{Out, Part, Shown, Slot};

/// The left camera in space.
pub(crate) const CAMERA: &str = "world/left";
/// The image that the left camera takes.
pub(crate) const IMAGE: &str = "world/left/image";

/// Where the left camera is, how it projects, and the image that it takes.
#[derive(Debug, Default)]
pub(crate) struct CameraPart {
    rig: Option<StereoRig>,
}

impl Part for CameraPart {
    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let frame = step.frame;
        out.log(CAMERA, &transform(frame.map_from_left()))?;
        if self.rig.as_ref() != Some(frame.rig()) {
            self.rig = Some(*frame.rig());
            out.log(IMAGE, &pinhole(frame.rig()))?;
        }
        let png = match frame.left_png() {
            Some(png) => png.to_vec(),
            None => encode_png(frame.left())?,
        };
        out.log(IMAGE, &EncodedImage::new(png).with_media_type(MediaType::PNG))
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        // What lies over the image has views of its own.
        let contents = vec!["+ $origin".into()];
        vec![(Slot::Image, Pane { contents, ..Pane::new("2D", "left image", IMAGE) })]
    }
}

/// A pose as Rerun has it.
pub(crate) fn transform(pose: &Pose) -> Transform3D {
    let Quaternion { coords } = *pose.rotation.quaternion();
    let rotation: [f32; 4] = std::array::from_fn(|a| coords[a] as f32);
    let translation: [f64; 3] = pose.translation.vector.into();
    Transform3D::from_translation(translation.map(|v| v as f32))
        .with_quaternion(rerun::Quaternion::from_xyzw(rotation))
}

fn pinhole(rig: &StereoRig) -> Pinhole {
    let focal = rig.focal_px as f32;
    // Rerun's pixel (0, 0) is a corner of the first pixel, ours is its centre.
    let centre = [rig.centre_x_px as f32 + 0.5, rig.centre_y_px as f32 + 0.5];
    Pinhole::from_focal_length_and_resolution([focal; 2], [rig.width as f32, rig.height as f32])
        .with_principal_point(centre)
        .with_image_plane_distance(1.5)
        .with_color(rerun::Color::from_rgb(255, 255, 255))
}

fn encode_png(image: &GrayImage) -> Result<Vec<u8>> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Up)
        .write_image(image.pixels(), image.width() as u32, image.height() as u32, ExtendedColorType::L8)
        .context("cannot encode the left image for the recording")?;
    Ok(png)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn an_image_without_a_file_is_encoded_without_loss() {
        let pixels: Vec<u8> = (0..35).map(|v| v * 7).collect();
        let png = encode_png(&GrayImage::new(7, 5, pixels.clone()).unwrap()).unwrap();
        let decoded = image::load_from_memory(&png).unwrap().into_luma8();
        assert_eq!((decoded.dimensions(), decoded.into_raw()), ((7, 5), pixels));
    }
}
