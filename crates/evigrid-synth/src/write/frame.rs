//! The files of one frame.

use std::path::{Path, PathBuf};

use evigrid_core::{Disparity, Frame, GrayImage, Pose};
use evigrid_replay::{Sequence, write_disparity_png};

use super::error::WriteError;
use super::files::{create_folder, point_bytes, write_file, write_grey_png, write_number_png};
use super::tables;
use crate::exact::boards;
use crate::view_truth::PixelTruth;
use crate::{LeftViewTruth, SyntheticSequence, World};

/// The largest disparity that KITTI's format holds, pixels.
const MAX_DISPARITY_PX: f32 = 65535.0 / 256.0;

/// Writes frames into a folder.
pub struct FrameWriter<'a> {
    pub sequence: &'a SyntheticSequence,
    pub world: &'a World,
    pub dir: &'a Path,
}

impl FrameWriter<'_> {
    /// Writes all files of a frame of the world under this number. Gives the rows that
    /// it has in the table of boards.
    pub fn write(&self, number: usize, frame: usize) -> Result<String, WriteError> {
        self.measured(number, &self.sequence.frame(frame, &Pose::identity())?)?;
        let view = LeftViewTruth::new(self.world, frame);
        self.exact(number, frame, &view)?;
        Ok(tables::boards(number, &boards(self.world, frame, &view)))
    }

    fn path(&self, folder: &str, number: usize, extension: &str) -> PathBuf {
        self.dir.join(folder).join(format!("{number:06}.{extension}"))
    }

    /// Images and laser scan.
    fn measured(&self, number: usize, frame: &Frame) -> Result<(), WriteError> {
        let image = |what, folder, image: &GrayImage| {
            let path = self.path(folder, number, "png");
            write_grey_png(what, &path, image.width(), image.height(), image.pixels())
        };
        image("left image", "image_0", frame.left())?;
        image("right image", "image_1", frame.right())?;
        let Some(scan) = frame.laser() else { return Ok(()) };
        // Reflectance is not simulated.
        let points = point_bytes(scan.points(), &[0.0]);
        write_file("laser scan", &self.path("velodyne", number, "bin"), &points)?;
        let Some(origins) = scan.origins() else { return Ok(()) };
        create_folder(&self.dir.join("velodyne_origins"))?;
        let path = self.path("velodyne_origins", number, "bin");
        write_file("laser origins", &path, &point_bytes(origins, &[]))
    }

    /// Disparity and what the right camera sees.
    fn exact(&self, number: usize, frame: usize, view: &LeftViewTruth) -> Result<(), WriteError> {
        let (width, height) = (view.width(), view.height());
        let disparities = view.pixels().iter().map(disparity).collect();
        let disparity = Disparity::new(width, height, disparities)
            .map_err(|source| WriteError::Truth { frame, source })?;
        write_disparity_png(&self.path("ground_truth/disparity", number, "png"), &disparity)?;
        let seen: Vec<u8> = view.pixels().iter().map(seen_by_right).collect();
        let path = self.path("ground_truth/occlusion", number, "png");
        write_grey_png("occlusion image", &path, width, height, &seen)?;
        let surfaces: Vec<u16> = view.pixels().iter().map(surface).collect();
        let path = self.path("ground_truth/surface", number, "png");
        write_number_png("surface image", &path, width, height, &surfaces)
    }
}

/// The disparity, NaN where the format cannot hold it.
fn disparity(pixel: &PixelTruth) -> f32 {
    if pixel.disparity_px > MAX_DISPARITY_PX { f32::NAN } else { pixel.disparity_px }
}

/// The number of the object, from 1 on; 0 for the sky.
fn surface(pixel: &PixelTruth) -> u16 {
    pixel.thing.map_or(0, |thing| u16::try_from(thing + 1).unwrap_or(u16::MAX))
}

fn seen_by_right(pixel: &PixelTruth) -> u8 {
    match (pixel.surface, pixel.seen_by_right) {
        (None, _) => 128,
        (Some(_), true) => 255,
        (Some(_), false) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(disparity_px: f32, surface: Option<(u32, u32)>, seen_by_right: bool) -> PixelTruth {
        PixelTruth { depth_m: 1.0, disparity_px, surface, thing: None, seen_by_right }
    }

    #[test]
    fn what_the_formats_cannot_hold_is_no_measurement() {
        assert_eq!(disparity(&pixel(MAX_DISPARITY_PX, None, true)), MAX_DISPARITY_PX);
        assert!(disparity(&pixel(256.0, None, true)).is_nan());
        assert_eq!(disparity(&pixel(0.0, None, false)), 0.0);
    }

    #[test]
    fn occlusion_has_three_values() {
        assert_eq!(seen_by_right(&pixel(1.0, Some((0, 0)), true)), 255);
        assert_eq!(seen_by_right(&pixel(1.0, Some((0, 0)), false)), 0);
        assert_eq!(seen_by_right(&pixel(0.0, None, false)), 128);
    }
}
