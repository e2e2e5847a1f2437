#![allow(clippy::unwrap_used)]
use super::*;
use crate::fixtures::{gradient, write_png};
use nalgebra::Vector3;
use proptest::prelude::*;

const CALIB: &str = "cam0=[1758.23 0 953.34; 0 1758.23 552.29; 0 0 1]\n\
        cam1=[1758.23 0 953.34; 0 1758.23 552.29; 0 0 1]\n\
        doffs=0\nbaseline=111.53\nwidth=12\nheight=9\nndisp=290\n";

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
            "calibration key doffs: expected 0 (equal principal points of both images), found 124.3: \
             calib.txt",
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
    assert!(pair.frame(1, &Pose::identity()).unwrap_err().to_string().starts_with("frame 1 does not exist"));

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
