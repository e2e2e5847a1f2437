//! PNG files: 8-bit images as grey values, and the size in a file's header.

use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use evigrid_core::GrayImage;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};

use crate::ReplayError;
use crate::image_size::{ImageSize, MAX_SIDE_PX};
use crate::text::{Fault, read_bytes};

/// Most memory that decoding one image may take.
const MAX_ALLOC_BYTES: u64 = 512 << 20;
/// Signature and header chunk of every PNG file.
const HEADER_BYTES: usize = 33;
/// The chunk that ends every whole PNG file.
const END: [u8; 12] = [0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82];

/// The picture in the bytes of a PNG file.
pub(crate) fn decode(bytes: &[u8]) -> Result<DynamicImage, Fault> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    limits.max_alloc = Some(MAX_ALLOC_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.limits(limits);
    reader.decode().map_err(|error| Fault::new("image", "a whole PNG file", error.to_string()))
}

/// The grey values of an 8-bit PNG file. Colour becomes luma by ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B,
/// rounded); transparency is dropped.
pub(crate) fn decode_grey(bytes: &[u8]) -> Result<GrayImage, Fault> {
    let picture = decode(bytes)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = match picture {
        DynamicImage::ImageLuma8(grey) => grey.into_raw(),
        DynamicImage::ImageLumaA8(grey) => grey.as_raw().chunks_exact(2).map(|p| p[0]).collect(),
        DynamicImage::ImageRgb8(colour) => colour.as_raw().chunks_exact(3).map(luma).collect(),
        DynamicImage::ImageRgba8(colour) => colour.as_raw().chunks_exact(4).map(luma).collect(),
        other => return Err(Fault::new("image", "8 bits per channel", format!("{:?}", other.color()))),
    };
    GrayImage::new(width, height, pixels).map_err(|error| Fault::new("image", "pixels", error.to_string()))
}

fn luma(colour: &[u8]) -> u8 {
    let [r, g, b] = [0, 1, 2].map(|channel| u32::from(colour[channel]));
    ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8
}

/// Size in the first bytes of a PNG file.
pub(crate) fn header_size(bytes: &[u8]) -> Result<ImageSize, Fault> {
    let header = bytes
        .first_chunk::<HEADER_BYTES>()
        .filter(|h| h.starts_with(b"\x89PNG\r\n\x1a\n") && &h[12..16] == b"IHDR");
    let Some(header) = header else {
        return Err(Fault::new("image", "the header of a PNG file", format!("{} other bytes", bytes.len())));
    };
    let side = |at: usize| u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let (width, height) = (side(16), side(20));
    if [width, height].iter().any(|side| !(1..=MAX_SIDE_PX).contains(side)) {
        let expected = format!("sides from 1 to {MAX_SIDE_PX} px");
        return Err(Fault::new("image", expected, format!("{width}x{height}")));
    }
    Ok(ImageSize { width: width as usize, height: height as usize })
}

/// Size of the picture in a PNG file, without decoding it: header and end are looked at, and only a file with
/// an unusual end is decoded to tell whether it is whole.
pub(crate) fn inspect(path: &Path) -> Result<ImageSize, ReplayError> {
    let (header, end) = header_and_end(path).map_err(|source| ReplayError::Io {
        what: "image",
        path: path.to_owned(),
        source,
    })?;
    let size = header_size(&header).map_err(|fault| fault.of(path))?;
    if end != END {
        decode(&read_bytes("image", path)?).map_err(|fault| fault.of(path))?;
    }
    Ok(size)
}

fn header_and_end(path: &Path) -> std::io::Result<(Vec<u8>, Vec<u8>)> {
    let mut file = File::open(path)?;
    let mut header = Vec::new();
    Read::by_ref(&mut file).take(HEADER_BYTES as u64).read_to_end(&mut header)?;
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(END.len() as u64)))?;
    let mut end = Vec::new();
    file.take(END.len() as u64).read_to_end(&mut end)?;
    Ok((header, end))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::png_bytes;
    use image::{GrayAlphaImage, GrayImage as Gray8, RgbImage, Rgba, RgbaImage};
    use proptest::prelude::*;

    #[test]
    fn colour_becomes_luma() {
        // 0.299 * 255 = 76.2, 0.587 * 255 = 149.7, 0.114 * 255 = 29.07.
        let rgb = RgbImage::from_raw(4, 1, vec![255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]).unwrap();
        let grey = decode_grey(&png_bytes(rgb.into())).unwrap();
        assert_eq!(grey.pixels(), [76, 150, 29, 255]);
        let rgba = RgbaImage::from_pixel(1, 1, Rgba([255, 0, 0, 7]));
        assert_eq!(decode_grey(&png_bytes(rgba.into())).unwrap().pixels(), [76]);
        let grey_alpha = GrayAlphaImage::from_raw(2, 1, vec![10, 0, 20, 255]).unwrap();
        assert_eq!(decode_grey(&png_bytes(grey_alpha.into())).unwrap().pixels(), [10, 20]);
    }

    #[test]
    fn grey_values_and_size_come_back() {
        let bytes = png_bytes(Gray8::from_raw(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap().into());
        let grey = decode_grey(&bytes).unwrap();
        assert_eq!((grey.width(), grey.height(), grey.row(1)), (3, 2, &[4, 5, 6][..]));
        assert_eq!(header_size(&bytes), Ok(ImageSize { width: 3, height: 2 }));
        assert!(bytes.ends_with(&END));
    }

    #[test]
    fn cut_files_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("cut.png");
        let bytes = png_bytes(Gray8::from_fn(40, 30, |x, y| image::Luma([(x * y) as u8])).into());
        for length in [0, 7, 20, 40, bytes.len() / 2] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let error = inspect(&path).unwrap_err().to_string();
            assert!(error.starts_with("image: expected ") && error.ends_with("cut.png"), "{length}: {error}");
            assert!(!error.contains('\n') && decode_grey(&bytes[..length]).is_err(), "{length}: {error}");
        }
        std::fs::write(&path, [&bytes[..], b"something after the end"].concat()).unwrap();
        assert_eq!(inspect(&path).unwrap(), ImageSize { width: 40, height: 30 });
    }

    #[test]
    fn headers_cannot_ask_for_any_amount_of_memory() {
        let mut bytes = png_bytes(Gray8::new(2, 2).into());
        bytes[16..20].copy_from_slice(&u32::MAX.to_be_bytes());
        assert!(header_size(&bytes).is_err() && decode_grey(&bytes).is_err());
    }

    proptest! {
        #[test]
        fn any_bytes_are_decoded_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = header_size(&bytes);
            prop_assert!(decode_grey(&bytes).is_err());
        }

        #[test]
        fn damaged_files_are_decoded_without_panic(at in 0..90_usize, value: u8) {
            let mut bytes = png_bytes(Gray8::from_fn(9, 7, |x, y| image::Luma([(x * y) as u8])).into());
            let at = at.min(bytes.len() - 1);
            bytes[at] = value;
            let _ = (header_size(&bytes), decode_grey(&bytes));
        }
    }
}
