use evigrid_core::{CoreError, Disparity, LaserScan, Pose, StereoRig};
use nalgebra::Point3;

/// How far around a pixel nearer laser points are looked for, pixels: the rows of a 64-beam scanner lie about
/// that far apart in a KITTI image.
const REACH_PX: usize = 5;

/// A laser point counts as hidden if one near it in the image has a disparity larger by this much,
/// pixels, and by this share of its own: the scanner stands elsewhere and sees past the edges of what
/// hides the point from the camera.
const HIDDEN_PX: f32 = 2.0;
const HIDDEN_SHARE: f32 = 0.1;

/// The disparities that a laser scan has in the left image, NaN where it says nothing. Of several
/// points in a pixel the nearest counts; points that may be hidden from the camera are left out, so
/// pixels near depth edges stay unknown.
///
/// # Errors
/// If the rig has no pixels.
pub fn projected_disparity(
    scan: &LaserScan,
    rig: &StereoRig,
    map_from_left: &Pose,
) -> Result<Disparity, CoreError> {
    let left_from_laser = map_from_left.inverse() * scan.map_from_laser();
    let (width, height) = (rig.width, rig.height);
    let mut nearest = vec![f32::NAN; width * height];
    for point in scan.points() {
        let point = left_from_laser * Point3::from(point.map(f64::from));
        let Some((x, y)) = rig.project(&point) else { continue };
        let (x, y) = (x.round(), y.round());
        if x < 0.0 || y < 0.0 || x >= width as f64 || y >= height as f64 {
            continue;
        }
        let disparity = &mut nearest[y as usize * width + x as usize];
        // The larger of the two; the number where the other is NaN.
        *disparity = disparity.max(rig.disparity_px(point.z) as f32);
    }
    let hidden = |i: usize| {
        let (x, y, own) = (i % width, i / width, nearest[i]);
        let rows = y.saturating_sub(REACH_PX)..(y + REACH_PX + 1).min(height);
        let columns = x.saturating_sub(REACH_PX)..(x + REACH_PX + 1).min(width);
        let limit = own + HIDDEN_PX.max(HIDDEN_SHARE * own);
        rows.into_iter().any(|row| nearest[row * width..][columns.clone()].iter().any(|&d| d > limit))
    };
    let values =
        (0..nearest.len()).map(|i| if nearest[i].is_nan() || hidden(i) { f32::NAN } else { nearest[i] });
    Disparity::new(width, height, values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: StereoRig = StereoRig {
        width: 40,
        height: 20,
        focal_px: 20.0,
        centre_x_px: 20.0,
        centre_y_px: 10.0,
        baseline_m: 0.5,
    };

    /// Points in camera axes: the laser stands where the camera is.
    fn project(points: &[[f32; 3]]) -> Vec<(usize, f32)> {
        let scan = LaserScan::new(points.to_vec(), Pose::identity()).unwrap();
        let disparity = projected_disparity(&scan, &RIG, &Pose::identity()).unwrap();
        disparity.values().iter().copied().enumerate().filter(|(_, d)| !d.is_nan()).collect()
    }

    #[test]
    fn points_land_in_their_pixels_and_the_nearest_wins() {
        // Column 20 + 20 * 2 / 4 = 30, row 10 + 20 * 1 / 4 = 15; disparity 20 * 0.5 / 4.
        assert_eq!(project(&[[2.0, 1.0, 4.0], [2.02, 1.01, 4.04]]), [(15 * 40 + 30, 2.5)]);
        assert_eq!(project(&[[0.0, 0.0, -4.0], [9.0, 0.0, 4.0], [0.0, -9.0, 4.0]]), []);
    }

    #[test]
    fn what_shines_past_a_near_edge_is_left_out() {
        let near = [0.0, 0.0, 1.0];
        let beside = |columns: f32| [columns * 8.0 / 20.0, 0.0, 8.0];
        assert_eq!(project(&[near, beside(3.0)]).len(), 1);
        assert_eq!(project(&[near, beside(6.0)]).len(), 2);
    }
}
