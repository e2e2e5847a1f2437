use std::io::Write;

use anyhow::{Context, Result};
use evigrid_core::{Frame, GrayImage, Pose, StereoRig};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use nalgebra::Quaternion;
use rerun::components::MediaType;
use rerun::{EncodedImage, Pinhole, TimePoint, Transform3D};

use crate::rrd::{Rrd, Store};

/// The left camera in space.
pub(crate) const CAMERA: &str = "world/left";
/// What it sees.
pub(crate) const IMAGE: &str = "world/left/image";

/// Writes where the left camera is, how it projects, and what it sees.
#[derive(Debug, Default)]
pub(crate) struct CameraWriter {
    rig: Option<StereoRig>,
}

impl CameraWriter {
    pub fn frame<W: Write>(
        &mut self,
        rrd: &mut Rrd<W>,
        store: &mut Store,
        at: &TimePoint,
        frame: &Frame,
    ) -> Result<()> {
        rrd.log(store, CAMERA, at, &transform(frame.map_from_left()))?;
        if self.rig.as_ref() != Some(frame.rig()) {
            self.rig = Some(*frame.rig());
            rrd.log(store, IMAGE, at, &pinhole(frame.rig()))?;
        }
        let png = match frame.left_png() {
            Some(png) => png.to_vec(),
            None => encode_png(frame.left())?,
        };
        rrd.log(store, IMAGE, at, &EncodedImage::new(png).with_media_type(MediaType::PNG))
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
