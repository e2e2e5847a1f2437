//! Middlebury stereo pairs (Scharstein & Szeliski, CVPR 2003; Scharstein et al., GCPR 2014).

use std::path::{Path, PathBuf};

use evigrid_core::{Disparity, Frame, Pose, StereoRig};

use crate::calibration::{checked, level_pose};
use crate::check_folder::{CalibrationKey, Inspection};
use crate::folder::{folder_name, resolve};
use crate::frame_parts::{FrameParts, require_frame};
use crate::image_size::ImageSize;
use crate::layout::LayoutSpec;
use crate::png;
use crate::text::{Fault, KeyValues, numbers, read_bytes, read_text};
use crate::{ItemState, Layout, ReplayError, Sequence, SequenceInfo};

/// Names of a left and a right image in the order they are looked for.
const PAIRS: [(&str, &str); 3] = [("left.png", "right.png"), ("im2.png", "im6.png"), ("im0.png", "im1.png")];
const CALIBRATION: &str = "calib.txt";
/// Files with the true disparity of the left image, and their steps per pixel.
const TRUTHS: [(&str, f32); 2] = [("gt.png", 1.0), ("disp2.png", 4.0)];
/// Focal length and baseline that the later (2005, 2006) sets of this laboratory publish, 3740 px and 160 mm,
/// at a quarter of the full size.
const ASSUMED_FOCAL_PX: f64 = 3740.0 / 4.0;
const ASSUMED_BASELINE_M: f64 = 0.160;
/// Keys of the calibration that hold one plain number.
const KEYS: [CalibrationKey; 4] = [
    CalibrationKey::new("doffs", 1),
    CalibrationKey::new("baseline", 1),
    CalibrationKey::new("width", 1),
    CalibrationKey::new("height", 1),
];

impl Layout {
    /// Layout of a [`MiddleburyPair`].
    pub const MIDDLEBURY: Self = Self(&LayoutSpec {
        name: "middlebury",
        wants: "left.png and right.png, or im2.png and im6.png, or im0.png and im1.png, optionally calib.txt",
        fits: |dir| pair_paths(dir).is_some(),
        open: |dir| Ok(Box::new(MiddleburyPair::open(dir)?)),
        check,
    });
}

/// One Middlebury pair as a recording of a single frame: a level camera at the origin, no laser. Colour
/// images become grey (ITU-R BT.601 luma).
///
/// With a `calib.txt` in the 2014 format the rig is the published one. The pairs of 2001 to 2003 come without
/// calibration; their rig is then assumed: focal length 935 px, baseline 0.160 m, principal point at the
/// image centre. **Metric depths of such a pair are nominal**; disparities are not affected.
#[derive(Debug)]
pub struct MiddleburyPair {
    dir: PathBuf,
    info: SequenceInfo,
    left: PathBuf,
    right: PathBuf,
    rig_is_assumed: bool,
}

impl MiddleburyPair {
    /// Opens a folder with `left.png` and `right.png`, or `im2.png` and `im6.png`, or `im0.png` and
    /// `im1.png`, and optionally `calib.txt`. Says so in the log if the rig is assumed.
    ///
    /// # Errors
    /// If there is no left image, or `calib.txt` is wrong or has `doffs` other than 0 (the principal points
    /// of the two images differ).
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
                "{id}: no calib.txt; assuming focal length {focal} px, baseline {baseline} m: \
                 metres are nominal"
            );
        }
        let layout = Layout::MIDDLEBURY.name();
        let info = SequenceInfo { id, layout, rig, mounting: None, frame_count: 1 };
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
        Ok(level_pose())
    }

    fn frame(&self, index: usize, map_from_world: &Pose) -> Result<Frame, ReplayError> {
        let map_from_left = map_from_world * self.world_from_left(index)?;
        let (left, right) = (self.left.clone(), self.right.clone());
        FrameParts { index, stamp_ns: 0, left, right, map_from_left, laser: None }.read(self.info.rig)
    }
}

/// The true disparity of the left image of a pair's folder, NaN where it is unknown: `gt.png` in whole
/// pixels, or `disp2.png` in quarters of a pixel as the sets of 2003 have it; 0 is unknown in both.
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
fn pair_paths(dir: &Path) -> Option<(PathBuf, PathBuf)> {
    let mut pairs = PAIRS.iter().map(|(left, right)| (dir.join(left), dir.join(right)));
    pairs.find(|(left, right)| left.is_file() || right.is_file())
}

fn assumed_rig(ImageSize { width, height }: ImageSize) -> StereoRig {
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

/// The rig of a calibration in the 2014 format: `cam0=[f 0 cx; 0 f cy; 0 0 1]`, `doffs` in pixels, `baseline`
/// in millimetres, `width`, `height`.
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
    let ImageSize { width, height } =
        ImageSize::from_numbers("width and height", single("width")?, single("height")?)?;
    let baseline_m = single("baseline")? / 1000.0;
    checked("calibration", StereoRig { width, height, focal_px, centre_x_px, centre_y_px, baseline_m })
}

/// Looks through the folder of a pair.
fn check(inspection: &mut Inspection) {
    inspection.report.frame_count = 1;
    let path = inspection.dir.join(CALIBRATION);
    let published = path.is_file();
    inspection.report.rig_is_assumed = !published;
    if published {
        inspection.calibration(&path, '=', &KEYS);
    } else {
        inspection.item(CALIBRATION, "one file", "none", ItemState::Optional);
    }
    let Some((left, right)) = pair_paths(&inspection.dir) else { return };
    let good_left = inspection.image("left image", &left);
    let good_right = inspection.image("right image", &right);
    inspection.report.stereo_frames = usize::from(good_left && good_right);
}

#[cfg(test)]
mod tests;
