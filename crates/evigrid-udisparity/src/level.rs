//! Whole disparities as a level camera sees them.

use evigrid_core::{Disparity, DisparityPlane, GroundPlane, MatchFilter, NO_MATCH, StereoRig};
use nalgebra::{Rotation3, Vector3};
use rayon::prelude::*;

/// Whole disparities of obstacles and of the road in the image of a level camera, row by row; 0: none.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Pixels {
    /// Width of both, pixels.
    pub width: usize,
    /// Height of both, pixels.
    pub height: usize,
    /// Disparities of obstacles.
    pub obstacles: Vec<u16>,
    /// Disparities of the road.
    pub road: Vec<u16>,
}

/// The level camera that stands where the left camera stands and looks the same way: what a homography makes of the
/// left image (Perrollaz et al. 2012, 3.2.4).
///
/// Its image is as large as the camera's; its principal point is moved up or down so that the camera's optical axis
/// stays in its place. Every pixel takes the reading of the camera's pixel nearest to its ray. A reading is a point in
/// space, so its disparity becomes that of its depth before the level camera; all of this is exact for any pitch and
/// roll but for the rounding to pixels. A camera that is level keeps its image as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelView {
    /// The rig with the level camera's principal point.
    pub rig: StereoRig,
    /// Height of the camera over the ground, metres.
    pub height_m: f64,
    /// For each pixel the camera's pixel, and what its disparity is multiplied by; `None` for a level camera.
    table: Option<Vec<(u32, f32)>>,
    /// The camera, and its turn, unless it is level.
    turn: Option<(StereoRig, Rotation3<f64>)>,
}

/// A pixel of the level camera that the camera does not see.
const OUTSIDE: u32 = u32::MAX;

impl LevelView {
    /// The level camera over the ground that shows these disparities.
    ///
    /// # Errors
    /// If no ground shows such ones.
    pub fn new(rig: &StereoRig, ground: &DisparityPlane) -> Result<Self, evigrid_core::CoreError> {
        let ground = GroundPlane::of_disparities(rig, ground)?;
        let height_m = ground.height_m();
        if ground.is_level() {
            return Ok(Self { rig: *rig, height_m, table: None, turn: None });
        }
        let level_from_camera = ground.level_from_camera();
        let axis = level_from_camera * Vector3::z();
        let level = StereoRig { centre_y_px: rig.centre_y_px - rig.focal_px * axis.y / axis.z, ..*rig };
        let table = Some(table(rig, &level, &level_from_camera.inverse()));
        Ok(Self { rig: level, height_m, table, turn: Some((*rig, level_from_camera)) })
    }

    /// The pixel of the level camera on the ray of a pixel of the camera; it may lie outside the image.
    pub fn level_pixel(&self, column: usize, row: usize) -> Option<[f64; 2]> {
        let (column, row) = (column as f64, row as f64);
        match &self.turn {
            None => Some([column, row]),
            Some((rig, level_from_camera)) => {
                let ray = level_from_camera * rig.ray(column, row);
                self.rig.project(&ray.into()).map(|(column, row)| [column, row])
            }
        }
    }

    /// Takes the believed disparities of obstacles and road over, rounded to whole ones (halves up); those outside of
    /// `tried` are left out.
    pub fn fill(
        &self,
        believed: &MatchFilter<'_>,
        [obstacles, road]: [&Disparity; 2],
        tried: &std::ops::Range<usize>,
        pixels: &mut Pixels,
    ) {
        let (width, height) = (obstacles.width(), obstacles.height());
        (pixels.width, pixels.height) = (width, height);
        pixels.obstacles.resize(width * height, 0);
        pixels.road.resize(width * height, 0);
        let whole = |disparity: f32, factor: f32| {
            let rounded = (disparity * factor + 0.5).floor();
            // NaN becomes 0.
            let rounded = rounded as u32 as usize;
            if tried.contains(&rounded) { rounded.min(usize::from(u16::MAX)) as u16 } else { 0 }
        };
        let rows = pixels.obstacles.par_chunks_exact_mut(width).zip(pixels.road.par_chunks_exact_mut(width));
        rows.enumerate().with_min_len(16).for_each(|(y, (to_obstacles, to_road))| {
            for x in 0..width {
                let at = y * width + x;
                let (from, factor) = match &self.table {
                    None => (at, 1.0),
                    Some(table) if table[at].0 == OUTSIDE => {
                        (to_obstacles[x], to_road[x]) = (0, 0);
                        continue;
                    }
                    Some(table) => (table[at].0 as usize, table[at].1),
                };
                let is_believed = believed.at(from) != NO_MATCH;
                let take = |of: &Disparity| if is_believed { whole(of.values()[from], factor) } else { 0 };
                (to_obstacles[x], to_road[x]) = (take(obstacles), take(road));
            }
        });
    }
}

/// For each pixel of the level camera the pixel of the camera on the same ray, and depth before the camera over depth
/// before the level camera.
fn table(rig: &StereoRig, level: &StereoRig, camera_from_level: &Rotation3<f64>) -> Vec<(u32, f32)> {
    let mut table = vec![(OUTSIDE, 0.0); rig.width * rig.height];
    table.par_chunks_exact_mut(rig.width).enumerate().for_each(|(y, row)| {
        for (x, entry) in row.iter_mut().enumerate() {
            let ray = camera_from_level * level.ray(x as f64, y as f64);
            if let Some((column, line)) = rig.project(&ray.into()) {
                let (column, line) = ((column + 0.5).floor(), (line + 0.5).floor());
                if column >= 0.0 && line >= 0.0 && column < rig.width as f64 && line < rig.height as f64 {
                    *entry = ((line as usize * rig.width + column as usize) as u32, ray.z as f32);
                }
            }
        }
    });
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::{MatchLimits, Matches, Mounting};
    use nalgebra::Point3;

    const RIG: StereoRig = StereoRig {
        width: 160,
        height: 120,
        focal_px: 130.0,
        centre_x_px: 79.5,
        centre_y_px: 59.5,
        baseline_m: 0.5,
    };

    fn filled(view: &LevelView, obstacles: &Disparity, road: &Disparity) -> Pixels {
        let matches = Matches::from_disparity(obstacles.clone());
        let filter = MatchFilter::new(&matches, &MatchLimits::left_right(None));
        let mut pixels = Pixels::default();
        view.fill(&filter, [obstacles, road], &(0..64), &mut pixels);
        pixels
    }

    #[test]
    fn a_level_camera_keeps_its_image() {
        let ground = GroundPlane::below(&Mounting::over_middle(1.0, 0.0)).disparities(&RIG);
        let view = LevelView::new(&RIG, &ground).unwrap();
        let values: Vec<f32> =
            (0..160 * 120).map(|n| if n % 7 == 0 { f32::NAN } else { (n % 90) as f32 + 0.4 }).collect();
        let obstacles = Disparity::new(160, 120, values.clone()).unwrap();
        let pixels = filled(&view, &obstacles, &Disparity::new(160, 120, vec![f32::NAN; 160 * 120]).unwrap());
        for (value, found) in values.iter().zip(&pixels.obstacles) {
            let expected = if value.is_nan() || *value >= 63.5 { 0 } else { (value + 0.5).floor() as u16 };
            assert_eq!(*found, expected);
        }
        assert!(pixels.road.iter().all(|d| *d == 0));
    }

    /// A wall 8 m ahead of a camera that looks down by 10 degrees has one disparity before the level camera, and the
    /// ground that of its rows.
    #[test]
    fn walls_stand_upright_and_ground_is_level() {
        let ground = GroundPlane::below(&Mounting::over_middle(1.4, 10_f64.to_radians()));
        let plane = ground.disparities(&RIG);
        let level = ground.level_from_camera();
        let wall = |x: usize, y: usize| {
            // The depth at which the pixel's ray is 8 m ahead.
            let ray = RIG.ray(x as f64, y as f64);
            RIG.disparity_px(8.0 / (level * ray).z) as f32
        };
        let all = |of: &dyn Fn(usize, usize) -> f32| {
            Disparity::new(160, 120, (0..160 * 120).map(|i| of(i % 160, i / 160)).collect()).unwrap()
        };
        let walls = all(&wall);
        let grounds = all(&|x, y| plane.at(x as f64, y as f64).max(0.0) as f32);
        let view = LevelView::new(&RIG, &plane).unwrap();
        let pixels = filled(&view, &walls, &grounds);
        let expected = (RIG.disparity_px(8.0) + 0.5).floor() as u16;
        let shown = pixels.obstacles.iter().filter(|d| **d != 0);
        assert!(shown.clone().count() > 140 * 110 && shown.clone().all(|d| *d == expected));
        for (i, found) in pixels.road.iter().enumerate().filter(|(_, d)| **d != 0) {
            let row = (i / 160) as f64;
            let disparity = RIG.baseline_m / 1.4 * (row - view.rig.centre_y_px);
            // Rounded to a pixel of the camera and to a whole disparity.
            assert!((f64::from(*found) - disparity).abs() < 0.5 + RIG.baseline_m / 1.4, "{row} {found}");
        }
        // The camera's optical axis keeps its pixel.
        let (column, row) = view.rig.project(&Point3::from(level * RIG.ray(79.5, 59.5))).unwrap();
        assert!((column - 79.5).abs() < 1e-9 && (row - 59.5).abs() < 1e-9);
        let of_middle = view.level_pixel(80, 60).unwrap();
        assert!((of_middle[0] - 80.0).abs() < 0.1 && (of_middle[1] - 60.0).abs() < 0.1, "{of_middle:?}");
    }
}
