use evigrid_core::{LaserScan, Pose, SettingError, StereoRig};
use evigrid_grid::{FrameEvidence, GridSpec, LogOddsGrid, RayWalk};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::TruthSettings;

/// Rays per task: enough to hide the cost of starting it.
const RAYS_PER_TASK: usize = 4096;
/// Cells per task, likewise.
const CELLS_PER_TASK: usize = 1 << 14;

/// An occupancy grid of all laser scans so far.
///
/// Per scan each voxel counts once, and a ray that ends in it wins over those that cross it. A cell is
/// occupied if its log-odds EVER exceeded the threshold, so moving obstacles count as occupied; it is
/// observed if any ray touched it.
#[derive(Debug)]
pub struct LaserTruth {
    settings: TruthSettings,
    evidence: FrameEvidence,
    log_odds: LogOddsGrid,
    occupied: Vec<bool>,
    observed: Vec<bool>,
    in_view: Vec<bool>,
    scans: usize,
}

impl LaserTruth {
    /// A reference without any scan.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: TruthSettings) -> Result<Self, SettingError> {
        Ok(Self {
            settings: settings.checked()?,
            evidence: FrameEvidence::new(spec.cell_count()),
            log_odds: LogOddsGrid::unknown(spec),
            occupied: vec![false; spec.cell_count()],
            observed: vec![false; spec.cell_count()],
            in_view: vec![false; spec.cell_count()],
            scans: 0,
        })
    }

    /// Adds one scan.
    pub fn add_scan(&mut self, scan: &LaserScan) {
        let spec = *self.log_odds.spec();
        let pose = scan.map_from_laser();
        let rotation = pose.rotation.to_rotation_matrix();
        let laser = pose.translation.vector;
        let points = scan.points().par_iter().enumerate().with_min_len(RAYS_PER_TASK);
        points.for_each(|(index, point)| {
            let single = |p: [f32; 3]| Vector3::from(p.map(f64::from));
            let start = scan.origins().map_or(Vector3::zeros(), |origins| single(origins[index]));
            let Some((ray, key)) = self.cut(single(*point) - start) else { return };
            let origin = spec.to_cells((laser + rotation * start).into());
            let end = rotation * ray / spec.cell_size_m();
            let end = std::array::from_fn(|a| origin[a] + end[a]);
            self.draw(&spec, origin, end, key);
        });
        self.evidence.fuse_into(&mut self.log_odds, self.settings.clamp());
        let above = self.settings.occupied_above;
        let marks = self.occupied.par_iter_mut().zip(self.observed.par_iter_mut());
        marks.zip(self.log_odds.values()).with_min_len(CELLS_PER_TASK).for_each(
            |((occupied, observed), l)| {
                *occupied |= *l > above;
                *observed = !l.is_nan();
            },
        );
        self.scans += 1;
    }

    /// The ray within the range limits, and the evidence for the cell in which it ends.
    fn cut(&self, ray: Vector3<f64>) -> Option<(Vector3<f64>, i32)> {
        let range = ray.norm();
        if range < self.settings.min_range_m {
            return None;
        }
        if range > self.settings.max_range_m {
            let cut = ray * (self.settings.max_range_m / range);
            return Some((cut, FrameEvidence::key(self.settings.miss_log_odds)));
        }
        Some((ray, FrameEvidence::key(self.settings.hit_log_odds)))
    }

    fn draw(&self, spec: &GridSpec, origin: [f64; 3], end: [f64; 3], end_key: i32) {
        let miss = FrameEvidence::key(self.settings.miss_log_odds);
        for (cell, steps_to_end) in RayWalk::in_cells(spec, origin, end) {
            self.evidence.offer(cell, if steps_to_end == 0 { end_key } else { miss });
        }
    }

    /// The grid's geometry.
    pub fn spec(&self) -> &GridSpec {
        self.log_odds.spec()
    }

    /// Whether each cell was ever occupied, by flat index.
    pub fn occupied(&self) -> &[bool] {
        &self.occupied
    }

    /// The fused log-odds; NaN where no ray has been.
    pub fn log_odds(&self) -> &LogOddsGrid {
        &self.log_odds
    }

    /// Whether any ray has touched each cell, by flat index.
    pub fn observed(&self) -> &[bool] {
        &self.observed
    }

    /// Marks the cells that hold a return of a scan which the left camera of its frame could see: one that projects
    /// into the left image, nearer and farther than the limits of depth. What stands before it is not asked.
    pub fn add_view(&mut self, scan: &LaserScan, rig: &StereoRig, map_from_left: &Pose) {
        let spec = *self.log_odds.spec();
        let [near_m, far_m] = self.settings.view_depth_m;
        let left_from_map = map_from_left.inverse();
        let is_in = |place: f64, size: usize| place >= -0.5 && place < size as f64 - 0.5;
        for point in scan.points() {
            let in_map = scan.map_from_laser() * Point3::from(point.map(f64::from));
            let in_left = left_from_map * in_map;
            if in_left.z <= near_m || in_left.z > far_m {
                continue;
            }
            let Some((x, y)) = rig.project(&in_left) else { continue };
            if let (true, Some(cell)) =
                (is_in(x, rig.width) && is_in(y, rig.height), spec.cell_of(in_map.coords.into()))
            {
                self.in_view[cell] = true;
            }
        }
    }

    /// Whether each cell holds a return that a left camera could see ([`Self::add_view`]), by flat index.
    pub fn in_view(&self) -> &[bool] {
        &self.in_view
    }

    /// How many scans have been added.
    pub fn scans(&self) -> usize {
        self.scans
    }
}
