//! Rotations and projections as calibration files print them.

use evigrid_core::{CoreError, Pose, StereoRig, level_camera};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::image_size::ImageSize;
use crate::text::Fault;

/// How far the rows of a printed rotation may be from orthonormal. KITTI prints seven digits; poses from
/// elsewhere are often coarser.
const ROTATION_TOLERANCE: f64 = 1e-3;
/// How far two numbers of a rectified rig may differ, relative to the first, and still count as equal.
const EQUAL_TOLERANCE: f64 = 1e-6;
/// How far the cameras of a rectified pair may be displaced along y or z, metres.
const ROW_ALIGNMENT_TOLERANCE_M: f64 = 1e-3;

/// The rotation nearest to a printed 3x3 matrix (row by row): the digits that printing cut off are restored,
/// so that long chains of poses stay rigid.
pub(crate) fn rotation(what: &str, rows: &[f64; 9]) -> Result<UnitQuaternion<f64>, Fault> {
    let matrix = Matrix3::from_row_slice(rows);
    let deviation = (matrix * matrix.transpose() - Matrix3::identity()).amax();
    let proper = deviation <= ROTATION_TOLERANCE && matrix.determinant() > 0.0;
    if !proper {
        let found = format!(
            "rows that are {deviation:.1e} from orthonormal, determinant {:.4}",
            matrix.determinant()
        );
        return Err(Fault::new(what, "a rotation matrix", found));
    }
    let svd = matrix.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Err(Fault::new(what, "a rotation matrix", "a matrix without singular vectors"));
    };
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(u * v_t)))
}

/// A pose from a rotation (row by row) and a translation in metres.
pub(crate) fn pose(what: &str, rows: &[f64; 9], translation_m: &[f64; 3]) -> Result<Pose, Fault> {
    let [x, y, z] = *translation_m;
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation(what, rows)?))
}

/// A pose from the rows of a 3x4 matrix [R | t].
pub(crate) fn pose_from_matrix(what: &str, m: &[f64; 12]) -> Result<Pose, Fault> {
    pose(what, &[m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]], &[m[3], m[7], m[11]])
}

/// Pose of a level camera at the origin that looks along x.
pub(crate) fn level_pose() -> Pose {
    Isometry3::from_parts(Translation3::identity(), level_camera())
}

/// The projection [f 0 cx tx; 0 f cy ty; 0 0 1 tz] of a rectified camera, whose centre lies at
/// -K^-1 [tx ty tz].
pub(crate) struct ProjectionMatrix<'a> {
    /// Key of the calibration file that it stands under.
    name: &'a str,
    focal_px: f64,
    centre_x_px: f64,
    centre_y_px: f64,
    camera_from_rectified: Vector3<f64>,
}

impl<'a> ProjectionMatrix<'a> {
    /// Takes the numbers of a printed matrix, row by row.
    pub fn new(name: &'a str, rows: &[f64; 12]) -> Result<Self, Fault> {
        let [focal_px, skew, centre_x_px, tx, zero_4, focal_y_px, centre_y_px, ty, zero_8, zero_9, one, tz] =
            *rows;
        if !nearly_equal(focal_px, focal_y_px) || focal_px <= 0.0 {
            let found = format!("fx {focal_px} px, fy {focal_y_px} px");
            return Err(Fault::new(name, "equal focal lengths fx = fy > 0", found));
        }
        if [skew, zero_4, zero_8, zero_9, one] != [0.0, 0.0, 0.0, 0.0, 1.0] {
            let found = format!("[f {skew} cx tx; {zero_4} f cy ty; {zero_8} {zero_9} {one} tz]");
            return Err(Fault::new(name, "a rectified projection [f 0 cx tx; 0 f cy ty; 0 0 1 tz]", found));
        }
        let offset = Vector3::new((tx - centre_x_px * tz) / focal_px, (ty - centre_y_px * tz) / focal_px, tz);
        Ok(Self { name, focal_px, centre_x_px, centre_y_px, camera_from_rectified: offset })
    }
}

/// A rectified pair as two projection matrices describe it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RectifiedPair {
    pub rig: StereoRig,
    /// A pure displacement, from the rectified frame, which both matrices project from, to the left camera's.
    pub left_from_rectified: Pose,
}

/// The pair of a left and a right camera with images of one size. The baseline is the distance of their
/// centres along x.
pub(crate) fn rectified_pair(
    left: &ProjectionMatrix<'_>,
    right: &ProjectionMatrix<'_>,
    size: ImageSize,
) -> Result<RectifiedPair, Fault> {
    let (left_name, right_name) = (left.name, right.name);
    for (what, l, r) in [
        ("focal length", left.focal_px, right.focal_px),
        ("principal point x", left.centre_x_px, right.centre_x_px),
        ("principal point y", left.centre_y_px, right.centre_y_px),
    ] {
        if !nearly_equal(l, r) {
            let expected = format!("the {what} of {left_name}, {l} px");
            return Err(Fault::new(right_name, expected, format!("{r} px")));
        }
    }
    let displacement = left.camera_from_rectified - right.camera_from_rectified;
    let row_aligned = displacement.yz().amax() <= ROW_ALIGNMENT_TOLERANCE_M;
    if !row_aligned {
        let found = format!("y {} m, z {} m", displacement.y, displacement.z);
        return Err(Fault::new(
            right_name,
            format!("a camera displaced from {left_name} along x alone"),
            found,
        ));
    }
    let rig = StereoRig {
        width: size.width,
        height: size.height,
        focal_px: left.focal_px,
        centre_x_px: left.centre_x_px,
        centre_y_px: left.centre_y_px,
        baseline_m: displacement.x,
    };
    let rig = checked(&format!("{left_name} and {right_name}"), rig)?;
    Ok(RectifiedPair { rig, left_from_rectified: Translation3::from(left.camera_from_rectified).into() })
}

/// The rig, once its numbers are known to be possible.
pub(crate) fn checked(what: &str, rig: StereoRig) -> Result<StereoRig, Fault> {
    rig.checked().map_err(|error| match error {
        CoreError::Domain { what: quantity, expected, found } => {
            Fault::new(format!("{what}: {quantity}"), expected, found.to_string())
        }
        other => Fault::new(what, "a possible rig", other.to_string()),
    })
}

fn nearly_equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= EQUAL_TOLERANCE * a.abs().max(1.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;
    use std::path::Path;

    const P0: [f64; 12] = [700.0, 0.0, 600.0, 0.0, 0.0, 700.0, 180.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    const P1: [f64; 12] = [700.0, 0.0, 600.0, -350.0, 0.0, 700.0, 180.0, 0.0, 0.0, 0.0, 1.0, 0.0];

    fn pair(left: [f64; 12], right: [f64; 12]) -> Result<RectifiedPair, String> {
        let size = ImageSize { width: 1200, height: 370 };
        ProjectionMatrix::new("P0", &left)
            .and_then(|left| rectified_pair(&left, &ProjectionMatrix::new("P1", &right)?, size))
            .map_err(|fault| fault.of(Path::new("calib.txt")).to_string())
    }

    fn with(mut p: [f64; 12], index: usize, value: f64) -> [f64; 12] {
        p[index] = value;
        p
    }

    #[test]
    fn the_baseline_is_the_distance_of_the_camera_centres() {
        let found = pair(P0, P1).unwrap();
        assert_eq!(found.rig.baseline_m, 0.5);
        assert_eq!((found.rig.centre_x_px, found.rig.centre_y_px), (600.0, 180.0));
        assert_eq!(found.left_from_rectified, Pose::identity());
        // KITTI's colour cameras: the left one stands 70 / 700 = 0.1 m left of the rectified origin.
        let colour = pair(with(P0, 3, 70.0), with(P1, 3, -280.0)).unwrap();
        assert_eq!(colour.rig.baseline_m, 0.5);
        let left = colour.left_from_rectified * Point3::new(0.0, 0.0, 7.0);
        assert!((left - Point3::new(0.1, 0.0, 7.0)).norm() < 1e-12, "{left}");
        // P projects [0 0 7 1] to (600 * 7 + 70) / 7 = 610, as the left camera must.
        assert!((colour.rig.project(&left).unwrap().0 - 610.0).abs() < 1e-9);
    }

    #[test]
    fn impossible_pairs_are_refused() {
        for (left, right, expected) in [
            (
                with(P0, 5, 710.0),
                P1,
                "P0: expected equal focal lengths fx = fy > 0, found fx 700 px, fy 710 px: calib.txt",
            ),
            (
                P0,
                with(with(P1, 0, 701.0), 5, 701.0),
                "P1: expected the focal length of P0, 700 px, found 701 px: calib.txt",
            ),
            (
                P0,
                with(P1, 2, 620.0),
                "P1: expected the principal point x of P0, 600 px, found 620 px: calib.txt",
            ),
            (
                P0,
                with(P1, 7, 70.0),
                "P1: expected a camera displaced from P0 along x alone, found y -0.1 m, z 0 m: calib.txt",
            ),
            (
                P0,
                with(P1, 3, 350.0),
                "P0 and P1: baseline: expected a positive number of metres, found -0.5: calib.txt",
            ),
            (
                with(P0, 1, 2.0),
                P1,
                "P0: expected a rectified projection [f 0 cx tx; 0 f cy ty; 0 0 1 tz], \
                 found [f 2 cx tx; 0 f cy ty; 0 0 1 tz]: calib.txt",
            ),
        ] {
            assert_eq!(pair(left, right).unwrap_err(), expected);
        }
    }

    #[test]
    fn printed_rotations_become_rigid_again() {
        // A quarter turn about z, with digits cut off.
        let quarter =
            rotation("R", &[1e-8, -0.999_999_9, 0.0, 1.0, 0.0, 2e-8, 0.0, 0.0, 0.999_999_9]).unwrap();
        let turned = quarter * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-6 && (turned.norm() - 1.0).abs() < 1e-15);
        for bad in [
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.01],
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0],
            [0.0; 9],
            [1e300; 9],
        ] {
            assert!(rotation("R", &bad).is_err(), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn any_numbers_are_taken_without_panic(
            a in prop::array::uniform12(prop::num::f64::ANY),
            b in prop::array::uniform12(prop::num::f64::ANY),
        ) {
            let _ = pair(a, b);
            let _ = pose_from_matrix("pose", &a);
            let _ = ImageSize::from_numbers("size", a[0], b[0]);
        }
    }
}
