//! Evidence of voxels (section IV): for a voxel that a point falls in, against those that its ray passes.

use evigrid_grid::{GridSpec, RayBatch, RayWalk};
use multiversion::multiversion;

use crate::points::{RangePoint, voxel_behind};
use crate::scroll::scroll;
use crate::settings::SafetyMapSettings;

/// Rays that are walked side by side.
const RAYS: usize = 4;

/// Evidence of each voxel (LOP), 0 at first. However long the robot drives and whatever the settings are, it stops
/// at the ends of its type.
#[derive(Debug)]
pub(crate) struct Evidence {
    of_voxel: Vec<i32>,
    /// No voxel's evidence is farther from 0.
    bound: i64,
}

impl Evidence {
    /// Evidence of so many voxels.
    pub fn new(voxels: usize) -> Self {
        Self { of_voxel: vec![0; voxels], bound: 0 }
    }

    /// Evidence by flat index.
    pub fn of_voxel(&self) -> &[i32] {
        &self.of_voxel
    }

    /// Adds the evidence of a frame's points.
    ///
    /// Sums do not depend on their order as long as none can come to an end of the type, and then rays are walked
    /// side by side. Else they are walked one after the other, and each step stops at the end.
    pub fn add(
        &mut self,
        spec: &GridSpec,
        camera: [f64; 3],
        points: &[RangePoint],
        settings: &SafetyMapSettings,
    ) {
        if self.has_room(points.len(), settings) {
            for points in points.chunks(RAYS) {
                let mut free = RayBatch::default();
                for (lane, point) in points.iter().enumerate() {
                    free.set(lane, &self.add_surface(spec, camera, point, settings));
                }
                take_from_all(&mut free, settings.decrement, &mut self.of_voxel);
            }
        } else {
            for point in points {
                let free = self.add_surface(spec, camera, point, settings);
                free.for_each(|(flat, _)| self.add_to(flat, -settings.decrement));
            }
        }
    }

    /// Evidence for the voxel of a point and for the voxels before and behind it. Returns the walk over all others
    /// up to the camera.
    #[inline]
    fn add_surface(
        &mut self,
        spec: &GridSpec,
        camera: [f64; 3],
        point: &RangePoint,
        settings: &SafetyMapSettings,
    ) -> RayWalk {
        let mut towards_camera = RayWalk::in_cells(spec, point.at, camera);
        if let Some((hit, _)) = towards_camera.next() {
            self.add_to(hit, settings.increment_hit);
        }
        if let Some((fore, _)) = towards_camera.next() {
            self.add_to(fore, settings.increment_beside);
        }
        if let Some(aft) = voxel_behind(spec, camera, point.at) {
            self.add_to(aft, settings.increment_beside);
        }
        towards_camera
    }

    fn add_to(&mut self, voxel: usize, amount: i32) {
        self.of_voxel[voxel] = self.of_voxel[voxel].saturating_add(amount);
    }

    /// Whether the points of a frame cannot bring any voxel to an end of the type.
    fn has_room(&mut self, points: usize, settings: &SafetyMapSettings) -> bool {
        let amounts = [settings.increment_hit, settings.increment_beside, settings.decrement];
        let change = points as i64 * amounts.iter().map(|&n| i64::from(n).abs()).sum::<i64>();
        if self.bound + change > i64::from(i32::MAX) {
            self.bound = self.of_voxel.iter().map(|&n| i64::from(n).abs()).max().unwrap_or(0);
        }
        self.bound += change;
        self.bound <= i64::from(i32::MAX)
    }

    /// Moves the grid by whole voxels; there is no evidence of new voxels.
    pub fn scroll(&mut self, spec: &GridSpec, voxels: [i64; 3]) {
        scroll(spec, &mut self.of_voxel, voxels);
    }
}

/// Takes `decrement` from all voxels on the walks of a batch. No result depends on the choice of the processor's
/// instructions.
#[multiversion(targets("x86_64+avx2"))]
fn take_from_all(walks: &mut RayBatch<RAYS>, decrement: i32, evidence: &mut [i32]) {
    let cells = *walks.cells();
    let [fewest, most] = [cells.iter().min(), cells.iter().max()].map(|n| n.copied().unwrap_or(0));
    for _ in 0..fewest {
        let (flat, _) = walks.step();
        flat.iter().for_each(|&flat| evidence[flat as usize] -= decrement);
    }
    for step in fewest..most {
        let (flat, _) = walks.step();
        for lane in (0..RAYS).filter(|&lane| step < cells[lane]) {
            evidence[flat[lane] as usize] -= decrement;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::{GridSettings, cell_index};
    use proptest::prelude::*;

    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 9.0], y_m: [0.0, 7.0], z_m: [0.0, 5.0], cell_size_m: 1.0 };
        GridSpec::new(&settings).unwrap()
    }

    /// One ray after the other, one voxel after the other.
    fn twin(camera: [f64; 3], points: &[RangePoint], s: &SafetyMapSettings, evidence: &mut [i32]) {
        for point in points {
            for (n, (flat, _)) in RayWalk::in_cells(&spec(), point.at, camera).enumerate() {
                let amount = [s.increment_hit, s.increment_beside].get(n).copied().unwrap_or(-s.decrement);
                evidence[flat] = evidence[flat].saturating_add(amount);
            }
            if let Some(aft) = voxel_behind(&spec(), camera, point.at) {
                evidence[aft] = evidence[aft].saturating_add(s.increment_beside);
            }
        }
    }

    /// What the voxels hold at first: room for all, or one of the ends so near that some rays come to it.
    fn at_first() -> impl Strategy<Value = i32> {
        prop_oneof![-20..20, i32::MIN..i32::MIN + 60, i32::MAX - 60..i32::MAX]
    }

    proptest! {
        /// Cameras inside and outside of the grid; points on faces too.
        #[test]
        fn rays_side_by_side_as_one_after_the_other(
            camera in [-6.0..15.0_f64, -6.0..12.0, -4.0..9.0],
            places in prop::collection::vec([0.0..9.0_f64, 0.0..7.0, 0.0..5.0], 0..40),
            on_faces in any::<bool>(),
            first in at_first(),
        ) {
            let points: Vec<RangePoint> = places.iter().map(|place| {
                let at = place.map(|v| if on_faces { v.floor() } else { v });
                let voxel = spec().flat(at.map(cell_index)).unwrap() as u32;
                RangePoint { at, voxel, distance_m: 0.0 }
            }).collect();
            let settings = SafetyMapSettings { decrement: 3, ..SafetyMapSettings::default() };
            let mut evidence = Evidence { of_voxel: vec![first; spec().cell_count()], bound: i64::from(i32::MAX) };
            let mut expected = evidence.of_voxel.clone();
            for _ in 0..3 {
                evidence.add(&spec(), camera, &points, &settings);
                twin(camera, &points, &settings, &mut expected);
                prop_assert_eq!(&evidence.of_voxel, &expected);
            }
        }
    }

    /// The bound is a guess from above, which is made anew from the voxels when there seems to be no more room.
    #[test]
    fn room_ends_where_a_voxel_could_come_to_the_end() {
        let settings = SafetyMapSettings::default();
        let mut evidence = Evidence { of_voxel: vec![0, -7], bound: i64::from(i32::MAX) };
        assert!(evidence.has_room(2, &settings));
        assert_eq!(evidence.bound, 7 + 2 * (10 + 4 + 1));
        let mut full = Evidence { of_voxel: vec![0, i32::MIN + 15], bound: 0 };
        assert!(full.has_room(0, &settings));
        full.bound = i64::from(i32::MAX);
        assert!(!full.has_room(1, &settings));
        let mut nearly = Evidence { of_voxel: vec![i32::MAX - 15], bound: i64::from(i32::MAX) };
        assert!(nearly.has_room(1, &settings));
    }
}
