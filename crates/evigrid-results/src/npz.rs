//! The npz container: a zip file of npy arrays, written and read in memory.

use std::io::{self, Cursor, Read, Write};

use anyhow::{Context, Result, bail};
use npyz::WriterBuilder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Arrays larger than this are refused when read (a header may claim anything).
const MAX_ARRAY_BYTES: u64 = 1 << 30;

/// Builds an npz in memory, array by array: the zip writer itself never meets a full disk.
#[derive(Debug)]
pub struct NpzWriter {
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Default for NpzWriter {
    fn default() -> Self {
        Self { zip: ZipWriter::new(Cursor::new(Vec::new())) }
    }
}

impl NpzWriter {
    /// Adds an array in C order.
    ///
    /// # Errors
    /// If there are more or fewer values than the shape says, or the name stands already for another array.
    pub fn array<T: npyz::AutoSerialize + Copy>(
        &mut self,
        name: &str,
        shape: &[u64],
        values: &[T],
    ) -> io::Result<()> {
        let mut npy = Vec::with_capacity(128 + size_of_val(values));
        let mut writer =
            npyz::WriteOptions::new().default_dtype().shape(shape).writer(&mut npy).begin_nd()?;
        writer.extend(values.iter().copied())?;
        writer.finish()?;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(1));
        self.zip.start_file(format!("{name}.npy"), options)?;
        self.zip.write_all(&npy)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// Never for an npz of arrays that were all added.
    pub fn finish(self) -> io::Result<Vec<u8>> {
        Ok(self.zip.finish()?.into_inner())
    }
}

/// The arrays of an npz that has been read into memory.
#[derive(Debug)]
pub struct Npz<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
}

/// One array: shape, and values converted to f64 (exact for every 32-bit type and integers up to 2^53).
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Lengths along the axes; none for a single number.
    pub shape: Vec<u64>,
    /// Whether the file has integers.
    pub is_integer: bool,
    /// The values in C order.
    pub values: Vec<f64>,
}

impl<'a> Npz<'a> {
    /// Looks into the bytes of a file.
    ///
    /// # Errors
    /// If they are no zip file.
    pub fn new(bytes: &'a [u8]) -> Result<Self> {
        let zip =
            ZipArchive::new(Cursor::new(bytes)).context("expected an npz file (a zip of npy arrays)")?;
        Ok(Self { zip })
    }

    /// Reads an array of numbers.
    ///
    /// # Errors
    /// If there is no such array, or it is not one of plain numbers in C order.
    pub fn array(&mut self, name: &str) -> Result<Array> {
        let known = self
            .zip
            .file_names()
            .filter_map(|n| n.ok().map(|n| n.into_owned()))
            .collect::<Vec<_>>()
            .join(", ");
        let Ok(entry) = self.zip.by_name(&format!("{name}.npy")) else {
            bail!("expected an array `{name}`, found {known}");
        };
        let mut bytes = Vec::new();
        entry.take(MAX_ARRAY_BYTES).read_to_end(&mut bytes).with_context(|| format!("array `{name}`"))?;
        parse_npy(&bytes).with_context(|| format!("array `{name}`"))
    }
}

/// Parses one npy file of plain numbers in C order.
///
/// # Errors
/// If it is none, or shorter than its shape says.
pub fn parse_npy(bytes: &[u8]) -> Result<Array> {
    let npy = npyz::NpyFile::new(bytes).context("not in npy format")?;
    let shape = npy.shape().to_vec();
    let count = shape.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
    let npyz::DType::Plain(dtype) = npy.dtype() else { bail!("expected plain numbers, found a structure") };
    let size = dtype.num_bytes().unwrap_or(0) as u64;
    if !count.and_then(|n| n.checked_mul(size)).is_some_and(|total| size > 0 && total <= bytes.len() as u64) {
        bail!("shape {shape:?} of {size}-byte numbers does not fit into {} bytes", bytes.len());
    }
    if npy.order() != npyz::Order::C && shape.len() > 1 {
        bail!("expected C order, found Fortran order");
    }
    let text = dtype.to_string();
    let values: Vec<f64> = match text.trim_start_matches(['<', '>', '=', '|']) {
        "f4" => npy.into_vec::<f32>()?.into_iter().map(f64::from).collect(),
        "f8" => npy.into_vec::<f64>()?,
        "i1" => npy.into_vec::<i8>()?.into_iter().map(f64::from).collect(),
        "i2" => npy.into_vec::<i16>()?.into_iter().map(f64::from).collect(),
        "i4" => npy.into_vec::<i32>()?.into_iter().map(f64::from).collect(),
        "i8" => npy.into_vec::<i64>()?.into_iter().map(|v| v as f64).collect(),
        "u1" => npy.into_vec::<u8>()?.into_iter().map(f64::from).collect(),
        "u2" => npy.into_vec::<u16>()?.into_iter().map(f64::from).collect(),
        "u4" => npy.into_vec::<u32>()?.into_iter().map(f64::from).collect(),
        "u8" => npy.into_vec::<u64>()?.into_iter().map(|v| v as f64).collect(),
        _ => bail!("expected integers or floats, found type {text}"),
    };
    Ok(Array { shape, is_integer: !text.contains('f'), values })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn arrays_come_back() {
        let mut npz = NpzWriter::default();
        npz.array("cells", &[2, 3], &[1_i32, 2, 3, -4, 5, 6]).unwrap();
        npz.array("size", &[], &[0.25_f64]).unwrap();
        npz.array("none", &[0, 3], &[] as &[i32]).unwrap();
        assert!(npz.array("short", &[3], &[1.0_f32]).is_err());
        let bytes = npz.finish().unwrap();
        let mut npz = Npz::new(&bytes).unwrap();
        let cells = npz.array("cells").unwrap();
        assert_eq!((cells.shape, cells.is_integer), (vec![2, 3], true));
        assert_eq!(cells.values, [1.0, 2.0, 3.0, -4.0, 5.0, 6.0]);
        assert_eq!(npz.array("size").unwrap().values, [0.25]);
        assert_eq!(npz.array("none").unwrap().shape, [0, 3]);
        let error = npz.array("cell").unwrap_err().to_string();
        assert_eq!(error, "expected an array `cell`, found cells.npy, size.npy, none.npy");
    }

    proptest! {
        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse_npy(&bytes);
            let _ = Npz::new(&bytes).map(|mut npz| npz.array("x").is_ok());
        }
    }
}
