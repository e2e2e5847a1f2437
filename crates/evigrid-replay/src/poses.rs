//! Poses of KITTI odometry: one 3x4 matrix per line.

use evigrid_core::Pose;

use crate::calibration::pose_from_matrix;
use crate::text::{Fault, numbers};

/// Poses of the rectified left camera, one per frame, from lines of twelve numbers: the rows of [R | t], in
/// metres.
pub(crate) fn parse_poses(text: &str) -> Result<Vec<Pose>, Fault> {
    let parse = |line: &str| pose_from_matrix("pose", &numbers::<12>("pose", line)?);
    let lines = text.trim_end().lines().enumerate();
    lines.map(|(index, line)| parse(line).map_err(|fault| fault.on_line(index + 1))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;
    use std::path::Path;

    #[test]
    fn a_line_holds_rotation_and_translation_row_by_row() {
        // A quarter turn about y (z -> x -> -z), then a shift.
        let poses = parse_poses("1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 10 0 1 0 20 -1 0 0 30\n").unwrap();
        assert_eq!(poses[0], Pose::identity());
        let moved = poses[1] * Point3::new(1.0, 2.0, 3.0);
        assert!((moved - Point3::new(13.0, 22.0, 29.0)).norm() < 1e-12, "{moved}");
        assert!((poses[1].rotation * Vector3::z() - Vector3::x()).norm() < 1e-12);
    }

    #[test]
    fn faults_name_the_line() {
        let message = |text: &str| parse_poses(text).unwrap_err().of(Path::new("p.txt")).to_string();
        let good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
        assert_eq!(message(&format!("{good}1 0 0\n")), "pose: expected 12 numbers, found 3: p.txt:2");
        assert_eq!(
            message("1 0 0 0 0 1 0 0 0 0 2 0"),
            "pose: expected a rotation matrix, found rows that are 3.0e0 from orthonormal, \
             determinant 2.0000: p.txt:1"
        );
        assert!(message(&format!("{good}\n{good}")).ends_with("p.txt:2"));
        assert!(message("1 0 0 nan 0 1 0 0 0 0 1 0").contains("a finite number, found \"nan\""));
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_panic(text in "\\PC*|([-0-9e.]{1,5} ){12}|([01] ){12}\n") {
            let _ = parse_poses(&text);
        }
    }
}
