//! Disparity images in KITTI's format: 16-bit grey PNG, disparity = value / 256 px, 0 = no measurement.

use std::fs::{self, File};
use std::io::{Cursor, Write};
use std::path::Path;

use evigrid_core::Disparity;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};

use crate::ReplayError;
use crate::png::decode;
use crate::text::{Fault, read_bytes};

/// Steps per pixel of disparity.
const STEPS_PER_PX: f32 = 256.0;

/// Reads a disparity image: pixels, NaN where the file has 0.
///
/// # Errors
/// If the file cannot be read or is no 16-bit grey PNG.
pub fn read_disparity_png(path: &Path) -> Result<Disparity, ReplayError> {
    decode_disparity(&read_bytes("disparity image", path)?).map_err(|fault| fault.of(path))
}

/// Writes a disparity image, to a temporary name beside `path` first, so that the file is whole or not there.
///
/// Values are rounded to the nearest 1/256 px. Whatever rounds to 0 – the disparity 0 of points infinitely
/// far away among them – is written as 1/256 px, since 0 stands for no measurement; at KITTI's rig that is a
/// depth of 99 km.
///
/// # Errors
/// If a disparity is larger than the format holds (65535/256 = 255.996 px; a clipped one would be a wrong
/// depth), or if the file cannot be written.
pub fn write_disparity_png(path: &Path, disparity: &Disparity) -> Result<(), ReplayError> {
    let bytes = encode_disparity(disparity).map_err(|fault| fault.of(path))?;
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let partial = Path::new(&partial);
    let written = write_synced(partial, &bytes).and_then(|()| fs::rename(partial, path));
    written.map_err(|source| {
        // Nothing more can be done if the leftover cannot be removed either.
        let _ = fs::remove_file(partial);
        ReplayError::Write { what: "disparity image", path: path.to_owned(), source }
    })
}

fn write_synced(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

fn decode_disparity(bytes: &[u8]) -> Result<Disparity, Fault> {
    let steps = match decode(bytes)? {
        DynamicImage::ImageLuma16(steps) => steps,
        other => return Err(Fault::new("disparity image", "16-bit grey", format!("{:?}", other.color()))),
    };
    let (width, height) = (steps.width() as usize, steps.height() as usize);
    let pixels = |&v: &u16| if v == 0 { f32::NAN } else { f32::from(v) / STEPS_PER_PX };
    Disparity::new(width, height, steps.as_raw().iter().map(pixels).collect())
        .map_err(|error| Fault::new("disparity image", "disparities", error.to_string()))
}

fn encode_disparity(disparity: &Disparity) -> Result<Vec<u8>, Fault> {
    let steps = disparity.values().iter().map(|&d| steps(d)).collect::<Result<Vec<u16>, Fault>>()?;
    let unencodable = |found: String| Fault::new("disparity image", "an image that PNG can hold", found);
    let side = |n: usize| u32::try_from(n).map_err(|_| unencodable(format!("a side of {n} px")));
    let image =
        ImageBuffer::<Luma<u16>, _>::from_raw(side(disparity.width())?, side(disparity.height())?, steps)
            .ok_or_else(|| unencodable("another number of pixels".to_owned()))?;
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| unencodable(error.to_string()))?;
    Ok(bytes.into_inner())
}

fn steps(disparity_px: f32) -> Result<u16, Fault> {
    if disparity_px.is_nan() {
        return Ok(0);
    }
    let steps = (disparity_px * STEPS_PER_PX).round();
    if steps > f32::from(u16::MAX) {
        let found = format!("{disparity_px} px");
        return Err(Fault::new("disparity to write", "at most 65535/256 = 255.996 px", found));
    }
    Ok(steps.max(1.0) as u16)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::{gradient, png_bytes};
    use proptest::prelude::*;

    fn image(values: Vec<f32>) -> Disparity {
        Disparity::new(values.len(), 1, values).unwrap()
    }

    #[test]
    fn values_are_two_hundred_and_fifty_sixths_of_a_pixel() {
        let png = ImageBuffer::<Luma<u16>, _>::from_raw(4, 1, vec![0, 1, 256, 65535]).unwrap();
        let read = decode_disparity(&png_bytes(png.into())).unwrap();
        assert!(read.values()[0].is_nan());
        assert_eq!(read.values()[1..], [1.0 / 256.0, 1.0, 65535.0 / 256.0]);
    }

    #[test]
    fn values_are_rounded_and_infinitely_far_stays_a_measurement() {
        for (px, expected) in [
            (f32::NAN, 0),
            (0.0, 1),
            (0.001, 1),
            (1.0, 256),
            (10.0019, 2560),
            (10.0021, 2561),
            (255.997, 65535),
        ] {
            assert_eq!(steps(px), Ok(expected), "{px}");
        }
    }

    #[test]
    fn what_the_format_cannot_hold_is_refused_and_nothing_is_left_behind() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("d.png");
        let error = write_disparity_png(&path, &image(vec![1.0, 256.0])).unwrap_err().to_string();
        let expected = "disparity to write: expected at most 65535/256 = 255.996 px, found 256 px: ";
        assert_eq!(error, format!("{expected}{}", path.display()));
        let below = dir.path().join("missing").join("d.png");
        let error = write_disparity_png(&below, &image(vec![1.0])).unwrap_err().to_string();
        assert!(error.starts_with("cannot write disparity image: ") && error.ends_with("d.png"), "{error}");
        fs::create_dir(&path).unwrap();
        assert!(write_disparity_png(&path, &image(vec![1.0])).is_err());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn eight_bit_images_are_refused() {
        let fault = decode_disparity(&png_bytes(gradient(3, 2))).unwrap_err();
        let expected = "disparity image: expected 16-bit grey, found L8: x.png";
        assert_eq!(fault.of(Path::new("x.png")).to_string(), expected);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(steps in prop::collection::vec(0..=u16::MAX, 1..50)) {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("d.png");
            let px = |&v: &u16| if v == 0 { f32::NAN } else { f32::from(v) / 256.0 };
            let written = image(steps.iter().map(px).collect());
            write_disparity_png(&path, &written).unwrap();
            let read = read_disparity_png(&path).unwrap();
            prop_assert_eq!((read.width(), read.height()), (steps.len(), 1));
            let bits = |d: &Disparity| d.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&read), bits(&written));
        }

        #[test]
        fn any_bytes_are_decoded_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            prop_assert!(decode_disparity(&bytes).is_err());
        }
    }
}
