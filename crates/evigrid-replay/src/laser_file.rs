//! Laser scans: little-endian 32-bit floats. Velodyne scans hold x, y, z (metres, laser frame) and
//! reflectance of each point; files of origins hold x, y, z of where the ray of each point started.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::ReplayError;
use crate::text::Fault;

/// Points that are read at a time: a buffer of a whole scan costs more than the parsing.
const BLOCK_POINTS: usize = 4096;

/// A kind of file: what it holds and how many bytes each point takes, of which the first twelve are x, y, z.
#[derive(Debug, Clone, Copy)]
struct Points {
    what: &'static str,
    bytes: usize,
}

/// x, y, z, reflectance, which is not used.
const SCAN: Points = Points { what: "laser scan", bytes: 16 };
const ORIGINS: Points = Points { what: "laser origins", bytes: 12 };

impl Points {
    /// Appends the points in the next bytes of a file: metres, laser's frame (x forward, y left, z up).
    fn parse(self, bytes: &[u8], points: &mut Vec<[f32; 3]>) -> Result<(), Fault> {
        let parsed_bytes = points.len() * self.bytes;
        let coordinate = |point: &[u8], at: usize| {
            f32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]])
        };
        for (index, bytes) in bytes.chunks_exact(self.bytes).enumerate() {
            let point = [0, 4, 8].map(|at| coordinate(bytes, at));
            if !point.iter().all(|v| v.is_finite()) {
                let found = format!("({}, {}, {})", point[0], point[1], point[2]);
                let fault = Fault::new(self.what, "finite coordinates", found);
                return Err(fault.at_byte(parsed_bytes + index * self.bytes));
            }
            points.push(point);
        }
        self.require_whole((parsed_bytes + bytes.len()) as u64)
    }

    /// `Ok` if a file of this length holds whole points.
    fn require_whole(self, length: u64) -> Result<(), Fault> {
        let of_one = self.bytes as u64;
        if length.is_multiple_of(of_one) {
            return Ok(());
        }
        let whole = length - length % of_one;
        let expected = format!("a multiple of {of_one} bytes");
        let fault = Fault::new(self.what, expected, format!("{length} bytes"));
        Err(fault.at_byte(usize::try_from(whole).unwrap_or(usize::MAX)))
    }

    /// The points of a file; `None` if there is no such file.
    fn read(self, path: &Path) -> Result<Option<Vec<[f32; 3]>>, ReplayError> {
        let failed = |source| ReplayError::Io { what: self.what, path: path.to_owned(), source };
        let file = match File::open(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            file => file.map_err(failed)?,
        };
        let block_bytes = BLOCK_POINTS * self.bytes;
        let mut points = Vec::new();
        let mut block = Vec::with_capacity(block_bytes);
        loop {
            block.clear();
            (&file).take(block_bytes as u64).read_to_end(&mut block).map_err(failed)?;
            self.parse(&block, &mut points).map_err(|fault| fault.of(path))?;
            if block.len() < block_bytes {
                return Ok(Some(points));
            }
        }
    }

    /// How many points a file holds, from its length; `None` if there is no such file.
    fn count(self, path: &Path) -> Result<Option<usize>, ReplayError> {
        let length = match std::fs::metadata(path) {
            Ok(file) => file.len(),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(ReplayError::Io { what: self.what, path: path.to_owned(), source }),
        };
        self.require_whole(length).map_err(|fault| fault.of(path))?;
        Ok(Some(usize::try_from(length).unwrap_or(usize::MAX) / self.bytes))
    }
}

/// The points of a scan file; `None` if there is no such file.
pub(crate) fn read_scan(path: &Path) -> Result<Option<Vec<[f32; 3]>>, ReplayError> {
    SCAN.read(path)
}

/// Where the rays of a scan of so many points started; `None` if there is no such file.
pub(crate) fn read_origins(path: &Path, points: Option<usize>) -> Result<Option<Vec<[f32; 3]>>, ReplayError> {
    let origins = ORIGINS.read(path)?;
    if let Some(origins) = &origins {
        require_origin_per_point(origins.len(), points).map_err(|fault| fault.of(path))?;
    }
    Ok(origins)
}

/// `Ok` if the length of a scan file, which must be there, fits whole points.
pub(crate) fn check_scan(path: &Path) -> Result<(), ReplayError> {
    SCAN.count(path).map(|_| ())
}

/// `Ok` if the length of a file of origins, which must be there, fits that of its scan.
pub(crate) fn check_origins(path: &Path, scan: &Path) -> Result<(), ReplayError> {
    // A scan that is no good has a fault of its own.
    let points = SCAN.count(scan).or_else(|_| ORIGINS.count(path))?;
    let origins = ORIGINS.count(path)?.unwrap_or(0);
    require_origin_per_point(origins, points).map_err(|fault| fault.of(path))
}

fn require_origin_per_point(origins: usize, points: Option<usize>) -> Result<(), Fault> {
    match points {
        Some(points) if points == origins => Ok(()),
        Some(points) => {
            let expected = format!("one for each of {points} points");
            Err(Fault::new(ORIGINS.what, expected, origins.to_string()))
        }
        None => Err(Fault::new(ORIGINS.what, "the scan that they belong to", "none")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::{origin_bytes, scan_bytes};
    use proptest::prelude::*;

    fn parse_scan(bytes: &[u8]) -> Result<Vec<[f32; 3]>, Fault> {
        let mut points = Vec::new();
        SCAN.parse(bytes, &mut points).map(|()| points)
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

    #[test]
    fn origins_are_twelve_bytes_for_each_point() {
        let dir = tempfile::tempdir().unwrap();
        let (path, scan) = (dir.path().join("origins.bin"), dir.path().join("scan.bin"));
        let check = |bytes: &[u8], points| {
            std::fs::write(&path, bytes).unwrap();
            let read = read_origins(&path, points).map_err(|error| error.to_string());
            read.map_err(|message| message.replace(&path.display().to_string(), "PATH"))
        };
        assert!(read_origins(&path, Some(1)).unwrap().is_none());
        let bytes = origin_bytes(&[[1.0, -2.0, 0.5], [0.0, 3.0, 0.0]]);
        assert_eq!(check(&bytes, Some(2)), Ok(Some(vec![[1.0, -2.0, 0.5], [0.0, 3.0, 0.0]])));
        for (bytes, points, expected) in [
            (&bytes[..], Some(3), "expected one for each of 3 points, found 2: PATH"),
            (&bytes, None, "expected the scan that they belong to, found none: PATH"),
            (&bytes[..23], Some(2), "expected a multiple of 12 bytes, found 23 bytes: PATH at byte 12"),
            (
                &origin_bytes(&[[0.0; 3], [f32::INFINITY; 3]]),
                Some(2),
                "expected finite coordinates, found (inf, inf, inf): PATH at byte 12",
            ),
        ] {
            assert_eq!(check(bytes, points).unwrap_err(), format!("laser origins: {expected}"));
        }
        std::fs::write(&path, &bytes).unwrap();
        assert!(
            check_origins(&path, &scan).unwrap_err().to_string().contains("the scan that they belong to")
        );
        std::fs::write(&scan, scan_bytes(&[[1.0; 3]; 2])).unwrap();
        check_origins(&path, &scan).unwrap();
        std::fs::write(&scan, scan_bytes(&[[1.0; 3]; 3])).unwrap();
        assert!(check_origins(&path, &scan).unwrap_err().to_string().contains("each of 3 points, found 2"));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            match parse_scan(&bytes) {
                Ok(points) => prop_assert!(points.len() * SCAN.bytes == bytes.len()),
                Err(fault) => prop_assert!(!fault.of(Path::new("x")).to_string().contains('\n')),
            }
        }

        #[test]
        fn finite_points_come_back(
            points in prop::collection::vec(prop::array::uniform3(-1e6_f32..1e6), 0..20)
        ) {
            prop_assert_eq!(parse_scan(&scan_bytes(&points)), Ok(points));
        }
    }
}
