//! Middlebury stereo pairs (Scharstein & Szeliski, CVPR 2003; Scharstein et al., GCPR 2014).

use std::path::{Path, PathBuf};

use evigrid_core::{Disparity, Frame, Pose, StereoRig};

use crate::calibration::{checked, image_size, level_camera};
use crate::folder::{folder_name, resolve};
use crate::frame_parts::{FrameParts, require_frame};
use crate::png;
use crate::text::{Fault, KeyValues, numbers, read_bytes, read_text};
use crate::{ReplayError, Sequence, SequenceInfo};

/// Names of a left and a right image in the order they are looked for.
pub(crate) const PAIRS: [(&str, &str); 3] =
    [("left.png", "right.png"), ("im2.png", "im6.png"), ("im0.png", "im1.png")];
pub(crate) const CALIBRATION: &str = "calib.txt";
/// Files with the true disparity of the left image, and their steps per pixel.
const TRUTHS: [(&str, f32); 2] = [("gt.png", 1.0), ("disp2.png", 4.0)];
/// Focal length and baseline that the later (2005, 2006) sets of the same laboratory publish, 3740 px and 160 mm,
/// at a quarter of the full size.
const ASSUMED_FOCAL_PX: f64 = 3740.0 / 4.0;
const ASSUMED_BASELINE_M: f64 = 0.160;

/// One Middlebury pair as a recording of a single frame: a level camera at the origin, no laser. Colour images become
/// grey (ITU-R BT.601 luma).
///
/// With a `calib.txt` in the 2014 format the rig is the published one. The pairs of 2001 to 2003 come without
/// calibration; their rig is then assumed: focal length 935 px, baseline 0.160 m, principal point at the image
/// centre. **Metric depths of such a pair are nominal**; disparities are not affected.
#[derive(Debug)]
pub struct MiddleburyPair {
    dir: PathBuf,
    info: SequenceInfo,
    left: PathBuf,
    right: PathBuf,
    rig_is_assumed: bool,
}

impl MiddleburyPair {
    /// Opens a folder with `left.png` and `right.png`, or `im2.png` and `im6.png`, or `im0.png` and `im1.png`, and
    /// optionally `calib.txt`. Says so in the log if the rig is assumed.
    ///
    /// # Errors
    /// If there is no left image, or `calib.txt` is wrong or has `doffs` other than 0 (the principal points of the
    /// two images differ).
    pub fn open(dir: &Path) -> Result<Self, ReplayError> {
        let resolved = resolve(dir)?;
        let (left, right) = pair_paths(dir).ok_or_else(|| {
            let expected = PAIRS.map(|(left, _)| left).join(" or ");
            Fault::new("left image", expected, "none").of(dir)
        })?;
        let published = read_calibration(&dir.join(CALIBRATION))?;
        let rig_is_assumed = published.is_none();
        let rig = match published {
            Some(rig) => rig,
            None => assumed_rig(png::inspect(&left)?),
        };
        let id = folder_name(&resolved);
        if rig_is_assumed {
            let (focal, baseline) = (rig.focal_px, rig.baseline_m);
            log::warn!(
                "{id}: no calib.txt; assuming focal length {focal} px, baseline {baseline} m: metres are nominal"
            );
        }
        let info = SequenceInfo { id, layout: "middlebury", rig, frame_count: 1 };
        Ok(Self { dir: dir.to_owned(), info, left, right, rig_is_assumed })
    }

    /// Whether the rig is assumed, for want of a `calib.txt`: metric depths are nominal then.
    pub fn rig_is_assumed(&self) -> bool {
        self.rig_is_assumed
    }
}

impl Sequence for MiddleburyPair {
    fn info(&self) -> &SequenceInfo {
        &self.info
    }

    fn world_from_left(&self, index: usize) -> Result<Pose, ReplayError> {
        require_frame(&self.info, &self.dir, index)?;
        Ok(level_camera())
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        let map_from_left = map_from_world * self.world_from_left(index)?;
        let (left, right) = (self.left.clone(), self.right.clone());
        FrameParts { index, stamp_ns: 0, left, right, map_from_left, laser: None }.read(self.info.rig)
    }
}

/// The true disparity of the left image of a pair's folder, NaN where it is unknown: `gt.png` in whole pixels, or
/// `disp2.png` in quarters of a pixel as the sets of 2003 have it; 0 is unknown in both.
///
/// # Errors
/// If there is neither, or it cannot be read.
pub fn middlebury_truth(dir: &Path) -> Result<Disparity, ReplayError> {
    let known = TRUTHS.map(|(name, steps_per_px)| (dir.join(name), steps_per_px));
    let (path, steps_per_px) = known.into_iter().find(|(path, _)| path.is_file()).ok_or_else(|| {
        Fault::new("true disparity", TRUTHS.map(|(name, _)| name).join(" or "), "none").of(dir)
    })?;
    let image = png::decode_grey(&read_bytes("true disparity", &path)?).map_err(|fault| fault.of(&path))?;
    let value = |&v: &u8| if v == 0 { f32::NAN } else { f32::from(v) / steps_per_px };
    let values = image.pixels().iter().map(value).collect();
    Disparity::new(image.width(), image.height(), values)
        .map_err(|error| Fault::new("true disparity", "disparities", error.to_string()).of(&path))
}

/// The first pair of which a left or a right image is there.
pub(crate) fn pair_paths(dir: &Path) -> Option<(PathBuf, PathBuf)> {
    let mut pairs = PAIRS.iter().map(|(left, right)| (dir.join(left), dir.join(right)));
    pairs.find(|(left, right)| left.is_file() || right.is_file())
}

fn assumed_rig((width, height): (usize, usize)) -> StereoRig {
    StereoRig {
        width,
        height,
        focal_px: ASSUMED_FOCAL_PX,
        centre_x_px: (width as f64 - 1.0) / 2.0,
        centre_y_px: (height as f64 - 1.0) / 2.0,
        baseline_m: ASSUMED_BASELINE_M,
    }
}

/// The rig of a `calib.txt`; `None` if there is no such file.
fn read_calibration(path: &Path) -> Result<Option<StereoRig>, ReplayError> {
    if !path.exists() {
        return Ok(None);
    }
    parse_calibration(&read_text("calibration", path)?).map(Some).map_err(|fault| fault.of(path))
}

/// The rig of a calibration in the 2014 format: `cam0=[f 0 cx; 0 f cy; 0 0 1]`, `doffs` in pixels, `baseline` in
/// millimetres, `width`, `height`.
fn parse_calibration(text: &str) -> Result<StereoRig, Fault> {
    let table = KeyValues::parse(text, '=');
    let (matrix, line) = table.get("cam0")?;
    let entries = matrix.replace(['[', ']', ';', ','], " ");
    let [focal_px, skew, centre_x_px, zero, focal_y_px, centre_y_px, ..] =
        numbers::<9>("calibration key cam0", &entries).map_err(|fault| fault.on_line(line))?;
    if focal_px != focal_y_px || [skew, zero] != [0.0, 0.0] {
        let found = format!("[{focal_px} {skew} {centre_x_px}; {zero} {focal_y_px} {centre_y_px}; ...]");
        return Err(Fault::new("calibration key cam0", "[f 0 cx; 0 f cy; 0 0 1]", found).on_line(line));
    }
    let single = |key: &str| table.numbers::<1>(key).map(|[value]| value);
    let doffs = single("doffs")?;
    if doffs != 0.0 {
        let expected = "0 (equal principal points of both images)";
        return Err(Fault::new("calibration key doffs", expected, doffs.to_string()));
    }
    let (width, height) = image_size("width and height", [single("width")?, single("height")?])?;
    let baseline_m = single("baseline")? / 1000.0;
    checked("calibration", StereoRig { width, height, focal_px, centre_x_px, centre_y_px, baseline_m })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::{gradient, write_png};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    const CALIB: &str = "cam0=[1758.23 0 953.34; 0 1758.23 552.29; 0 0 1]\n\
        cam1=[1758.23 0 953.34; 0 1758.23 552.29; 0 0 1]\ndoffs=0\nbaseline=111.53\nwidth=12\nheight=9\nndisp=290\n";

    #[test]
    fn the_2014_format_gives_the_rig() {
        let rig = parse_calibration(CALIB).unwrap();
        assert_eq!((rig.width, rig.height, rig.focal_px), (12, 9, 1758.23));
        assert_eq!((rig.centre_x_px, rig.centre_y_px), (953.34, 552.29));
        assert!((rig.baseline_m - 0.11153).abs() < 1e-12);
    }

    #[test]
    fn rigs_that_do_not_fit_are_refused() {
        let message = |from: &str, to: &str| {
            parse_calibration(&CALIB.replace(from, to)).unwrap_err().of(Path::new("calib.txt")).to_string()
        };
        for (from, to, expected) in [
            (
                "doffs=0",
                "doffs=124.3",
                "calibration key doffs: expected 0 (equal principal points of both images), found 124.3: calib.txt",
            ),
            (
                "baseline=111.53\n",
                "",
                "calibration key baseline: expected a line \"baseline= ...\", found none: calib.txt",
            ),
            (
                "cam0=[1758.23 0",
                "cam0=[1758.23 1",
                "calibration key cam0: expected [f 0 cx; 0 f cy; 0 0 1], \
                 found [1758.23 1 953.34; 0 1758.23 552.29; ...]: calib.txt:1",
            ),
            (
                "width=12",
                "width=1.5",
                "width and height: expected whole numbers of pixels from 1 to 16384, found 1.5 x 9: calib.txt",
            ),
            (
                "baseline=111.53",
                "baseline=-1",
                "calibration: baseline: expected a positive number of metres, found -0.001: calib.txt",
            ),
        ] {
            assert_eq!(message(from, to), expected);
        }
    }

    #[test]
    fn a_pair_is_one_frame_of_a_level_camera() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["im2.png", "im6.png"] {
            write_png(&dir.path().join(name), gradient(12, 9));
        }
        let pair = MiddleburyPair::open(dir.path()).unwrap();
        assert!(pair.rig_is_assumed());
        // Pixel centres are at integers: 12 columns reach from -0.5 to 11.5.
        assert_eq!((pair.info().rig.centre_x_px, pair.info().rig.centre_y_px), (5.5, 4.0));
        let frame = pair.frame(0, &Pose::identity()).unwrap();
        assert!(frame.laser().is_none() && frame.left_png().is_some());
        let forward = frame.map_from_left().rotation * Vector3::z();
        assert!((forward - Vector3::x()).norm() < 1e-12);
        assert!(
            pair.frame(1, &Pose::identity()).unwrap_err().to_string().starts_with("frame 1 does not exist")
        );

        std::fs::write(dir.path().join("calib.txt"), CALIB).unwrap();
        let pair = MiddleburyPair::open(dir.path()).unwrap();
        assert!(!pair.rig_is_assumed() && pair.info().rig.focal_px == 1758.23);
    }

    #[test]
    fn a_lone_left_image_is_an_error_that_names_the_right_one() {
        let dir = tempfile::tempdir().unwrap();
        write_png(&dir.path().join("left.png"), gradient(12, 9));
        let pair = MiddleburyPair::open(dir.path()).unwrap();
        let error = pair.frame(0, &Pose::identity()).unwrap_err().to_string();
        assert!(error.starts_with("cannot read right image: ") && error.ends_with("right.png"), "{error}");
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_panic(text in "\\PC*|(cam0|doffs|width|baseline)=[-0-9e.; \\[\\]]{0,40}\n") {
            prop_assert!(parse_calibration(&text).is_err());
            let _ = parse_calibration(&format!("{CALIB}{text}"));
            let _ = parse_calibration(&format!("{text}\n{CALIB}"));
        }
    }
}
