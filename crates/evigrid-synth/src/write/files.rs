//! Whole files from bytes in memory.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::error::WriteError;

/// Writes a file and waits until it is on the disk.
pub fn write_file(what: &'static str, path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let written = File::create(path).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.map_err(|source| WriteError::Io { what, path: path.to_owned(), source })
}

/// Creates a folder, and those above it; it may be there.
pub fn create_folder(path: &Path) -> Result<(), WriteError> {
    let failed = |source| WriteError::Io { what: "folder", path: path.to_owned(), source };
    std::fs::create_dir_all(path).map_err(failed)
}

/// Writes grey levels, row by row, as an 8-bit PNG.
pub fn write_grey_png(
    what: &'static str,
    path: &Path,
    width: usize,
    height: usize,
    pixels: &[u8],
) -> Result<(), WriteError> {
    let mut bytes = Vec::new();
    let (width, height) = (width as u32, height as u32);
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, ExtendedColorType::L8)
        .map_err(|error| WriteError::Io { what, path: path.to_owned(), source: io::Error::other(error) })?;
    write_file(what, path, &bytes)
}

/// Writes numbers, row by row, as a 16-bit PNG.
pub fn write_number_png(
    what: &'static str,
    path: &Path,
    width: usize,
    height: usize,
    pixels: &[u16],
) -> Result<(), WriteError> {
    let mut bytes = Vec::new();
    let values: Vec<u8> = pixels.iter().flat_map(|v| v.to_ne_bytes()).collect();
    PngEncoder::new(&mut bytes)
        .write_image(&values, width as u32, height as u32, ExtendedColorType::L16)
        .map_err(|error| WriteError::Io { what, path: path.to_owned(), source: io::Error::other(error) })?;
    write_file(what, path, &bytes)
}

/// The bytes of points: little-endian 32-bit floats, and `tail` after each x, y, z.
pub fn point_bytes(points: &[[f32; 3]], tail: &[f32]) -> Vec<u8> {
    let floats = points.iter().flat_map(|point| point.iter().chain(tail));
    floats.flat_map(|v| v.to_le_bytes()).collect()
}
