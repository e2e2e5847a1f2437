//! From the files of one frame to a checked `Frame`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use evigrid_core::{CoreError, Frame, GrayImage, LaserScan, Pose, StereoRig};

use crate::image_size::ImageSize;
use crate::laser_file::{read_origins, read_scan};
use crate::png::decode_grey;
use crate::text::read_bytes;
use crate::{ReplayError, SequenceInfo};

/// Places of the parts of one frame, and how they stand to each other.
pub(crate) struct FrameParts {
    pub index: usize,
    pub stamp_ns: i64,
    pub left: PathBuf,
    pub right: PathBuf,
    pub map_from_left: Pose,
    pub laser: Option<ScanFiles>,
}

/// Where the files of a scan lie, either of which may be missing, and the pose of the laser.
pub(crate) struct ScanFiles {
    pub points: PathBuf,
    /// Where the ray of each point started, if the layout knows of such a file.
    pub origins: Option<PathBuf>,
    pub map_from_laser: Pose,
}

impl FrameParts {
    /// Reads the files.
    pub fn read(self, rig: StereoRig) -> Result<Frame, ReplayError> {
        let (left, left_png) = self.image("left image", &self.left, &rig)?;
        let (right, _) = self.image("right image", &self.right, &rig)?;
        let laser = self.read_laser()?;
        let frame = Frame::new(self.index, self.stamp_ns, rig, left, right, self.map_from_left, laser);
        Ok(frame.map_err(|source| self.misfit(source, &self.left))?.with_left_png(left_png))
    }

    /// Reads the laser scan alone, if there is one.
    pub fn read_laser(&self) -> Result<Option<LaserScan>, ReplayError> {
        self.laser.as_ref().map_or(Ok(None), |files| self.scan(files))
    }

    fn image(
        &self,
        what: &'static str,
        path: &Path,
        rig: &StereoRig,
    ) -> Result<(GrayImage, Arc<[u8]>), ReplayError> {
        let bytes = read_bytes(what, path)?;
        let image = decode_grey(&bytes).map_err(|fault| fault.of(path))?;
        let expected = ImageSize { width: rig.width, height: rig.height };
        let found = ImageSize { width: image.width(), height: image.height() };
        found.require(what, expected).map_err(|source| self.misfit(source, path))?;
        Ok((image, bytes.into()))
    }

    fn scan(&self, files: &ScanFiles) -> Result<Option<LaserScan>, ReplayError> {
        let points = read_scan(&files.points)?;
        let origins = match &files.origins {
            Some(path) => read_origins(path, points.as_ref().map(Vec::len))?,
            None => None,
        };
        let Some(points) = points else { return Ok(None) };
        let scan = LaserScan::new(points, files.map_from_laser).and_then(|scan| match origins {
            Some(origins) => scan.with_origins(origins),
            None => Ok(scan),
        });
        scan.map(Some).map_err(|source| self.misfit(source, &files.points))
    }

    fn misfit(&self, source: CoreError, path: &Path) -> ReplayError {
        ReplayError::Frame { index: self.index, source, path: path.to_owned() }
    }
}

/// `Ok` if the recording has a frame of this number.
pub(crate) fn require_frame(info: &SequenceInfo, dir: &Path, index: usize) -> Result<(), ReplayError> {
    let frame_count = info.frame_count;
    if index < frame_count {
        return Ok(());
    }
    Err(ReplayError::NoSuchFrame { index, frame_count, path: dir.to_owned() })
}
