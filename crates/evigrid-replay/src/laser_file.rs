//! Velodyne scans: little-endian 32-bit floats x, y, z (metres, laser frame), reflectance.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::ReplayError;
use crate::text::Fault;

/// Bytes of one point.
const POINT_BYTES: usize = 16;
/// Bytes that are read at a time, a whole number of points: a buffer of a whole scan costs more than the parsing.
const BLOCK_BYTES: usize = 4096 * POINT_BYTES;

/// Appends the points in the next bytes of a scan: metres, in the laser's frame (x forward, y left, z up).
/// Reflectance is not used.
fn parse_points(bytes: &[u8], points: &mut Vec<[f32; 3]>) -> Result<(), Fault> {
    let parsed_bytes = points.len() * POINT_BYTES;
    let coordinate = |point: &[u8], at: usize| {
        f32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]])
    };
    for (index, bytes) in bytes.chunks_exact(POINT_BYTES).enumerate() {
        let point = [0, 4, 8].map(|at| coordinate(bytes, at));
        if !point.iter().all(|v| v.is_finite()) {
            let found = format!("({}, {}, {})", point[0], point[1], point[2]);
            let fault = Fault::new("laser scan", "finite coordinates", found);
            return Err(fault.at_byte(parsed_bytes + index * POINT_BYTES));
        }
        points.push(point);
    }
    require_whole_points((parsed_bytes + bytes.len()) as u64)
}

/// `Ok` if a file of this length holds whole points.
pub(crate) fn require_whole_points(length: u64) -> Result<(), Fault> {
    if length.is_multiple_of(POINT_BYTES as u64) {
        return Ok(());
    }
    let whole = length - length % POINT_BYTES as u64;
    let fault = Fault::new("laser scan", "a multiple of 16 bytes", format!("{length} bytes"));
    Err(fault.at_byte(usize::try_from(whole).unwrap_or(usize::MAX)))
}

/// The points of a scan file; `None` if there is no such file.
pub(crate) fn read_scan(path: &Path) -> Result<Option<Vec<[f32; 3]>>, ReplayError> {
    let failed = |source| ReplayError::Io { what: "laser scan", path: path.to_owned(), source };
    let file = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        file => file.map_err(failed)?,
    };
    let mut points = Vec::new();
    let mut block = Vec::with_capacity(BLOCK_BYTES);
    loop {
        block.clear();
        (&file).take(BLOCK_BYTES as u64).read_to_end(&mut block).map_err(failed)?;
        parse_points(&block, &mut points).map_err(|fault| fault.of(path))?;
        if block.len() < BLOCK_BYTES {
            return Ok(Some(points));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::scan_bytes;
    use proptest::prelude::*;

    fn parse_scan(bytes: &[u8]) -> Result<Vec<[f32; 3]>, Fault> {
        let mut points = Vec::new();
        parse_points(bytes, &mut points).map(|()| points)
    }

    #[test]
    fn a_scan_is_little_endian_xyz_and_reflectance() {
        // 1.0 = 0x3f800000, -2.0 = 0xc0000000, 0.5 = 0x3f000000.
        let bytes = [0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0x3f, 9, 9, 9, 9];
        assert_eq!(parse_scan(&bytes), Ok(vec![[1.0, -2.0, 0.5]]));
        assert_eq!(parse_scan(&[]), Ok(vec![]));
    }

    #[test]
    fn faults_name_file_and_byte() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scan.bin");
        assert!(read_scan(&path).unwrap().is_none());
        let mut bytes = scan_bytes(&[[1.0, 2.0, 3.0], [4.0, f32::NAN, 6.0]]);
        std::fs::write(&path, &bytes).unwrap();
        let expected = "laser scan: expected finite coordinates, found (4, NaN, 6): ";
        let error = read_scan(&path).unwrap_err().to_string();
        assert_eq!(error, format!("{expected}{} at byte 16", path.display()));
        bytes.pop();
        std::fs::write(&path, &bytes).unwrap();
        let expected = "laser scan: expected a multiple of 16 bytes, found 31 bytes: ";
        let error = read_scan(&path).unwrap_err().to_string();
        assert_eq!(error, format!("{expected}{} at byte 16", path.display()));
    }

    #[test]
    fn scans_longer_than_a_block_come_back_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scan.bin");
        for count in [4095, 4096, 4097, 9000] {
            let mut points: Vec<[f32; 3]> = (0..count).map(|i| [i as f32, 1.0, -1.0]).collect();
            std::fs::write(&path, scan_bytes(&points)).unwrap();
            assert_eq!(read_scan(&path).unwrap().unwrap(), points);
            points[count - 1][2] = f32::NAN;
            std::fs::write(&path, scan_bytes(&points)).unwrap();
            let error = read_scan(&path).unwrap_err().to_string();
            assert!(error.ends_with(&format!("scan.bin at byte {}", 16 * (count - 1))), "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            match parse_scan(&bytes) {
                Ok(points) => prop_assert!(points.len() * POINT_BYTES == bytes.len()),
                Err(fault) => prop_assert!(!fault.of(Path::new("x")).to_string().contains('\n')),
            }
        }

        #[test]
        fn finite_points_come_back(points in prop::collection::vec(prop::array::uniform3(-1e6_f32..1e6), 0..20)) {
            prop_assert_eq!(parse_scan(&scan_bytes(&points)), Ok(points));
        }
    }
}
