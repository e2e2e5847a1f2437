//! The 3-D model: evidence of every voxel and the points that fell in it (section IV).

use evigrid_core::{Pose, StereoRig};
use evigrid_grid::{GridSpec, Moments, ViewRays, cell_index};

use crate::columns::{Column, Columns};
use crate::evidence::Evidence;
use crate::points::{PointSelection, RangePoint};
use crate::robot::Robot;
use crate::scroll::scroll;
use crate::settings::SafetyMapSettings;

/// A point of the database, relative to its voxel.
#[derive(Debug, Clone, Copy)]
struct StoredPoint {
    /// Place in units of voxels from the voxel's lower corner.
    at: [f32; 3],
    /// Distance of the camera when it was seen, metres.
    distance_m: f32,
}

impl StoredPoint {
    /// Its place in the map frame, metres, if its voxel has this place in the grid.
    fn place_m(&self, spec: &GridSpec, voxel: [usize; 3]) -> [f64; 3] {
        let (origin, c) = (spec.origin_m(), spec.cell_size_m());
        [0, 1, 2].map(|a| origin[a] + (voxel[a] as f64 + f64::from(self.at[a])) * c)
    }
}

/// The points of a voxel, those seen from nearest first, and their sums in the map frame.
#[derive(Debug, Default)]
struct PointList {
    points: Vec<StoredPoint>,
    moments: Moments,
}

/// Voxels with their evidence, and for each voxel a bounded list of points, those seen from nearest first.
#[derive(Debug)]
pub struct Model {
    settings: SafetyMapSettings,
    /// The grid as it lay at first, and by how many voxels it has moved since.
    first: GridSpec,
    moved: [i64; 3],
    spec: GridSpec,
    evidence: Evidence,
    /// For each voxel the place of its list among the lists, plus 1; 0: it has none.
    list_of: Vec<u32>,
    lists: Vec<PointList>,
    /// Lists that belong to no voxel.
    spare: Vec<u32>,
    selection: PointSelection,
}

impl Model {
    /// An empty model over a grid.
    pub fn new(spec: GridSpec, settings: SafetyMapSettings) -> Self {
        let voxels = spec.cell_count();
        Self {
            settings,
            first: spec,
            moved: [0; 3],
            spec,
            evidence: Evidence::new(voxels),
            list_of: vec![0; voxels],
            lists: Vec::new(),
            spare: Vec::new(),
            selection: PointSelection::new(voxels),
        }
    }

    /// The grid, as it lies now.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Evidence of each voxel by flat index.
    pub fn evidence(&self) -> &[i32] {
        self.evidence.of_voxel()
    }

    /// Whether a voxel is occupied.
    pub fn is_occupied(&self, flat: usize) -> bool {
        self.evidence()[flat] >= self.settings.occupied_at
    }

    /// Whether a column was seen through at a height in the map frame, metres: the evidence against its voxel
    /// there is at least `hole_at`.
    pub fn is_free(&self, column: usize, height_m: f64) -> bool {
        let layer = layer_at(&self.spec, height_m);
        layer.is_some_and(|w| self.evidence()[column * self.spec.shape()[2] + w] <= -self.settings.hole_at)
    }

    /// The points of a voxel in the map frame, metres, those seen from nearest first.
    pub fn points(&self, flat: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
        let (spec, corner) = (self.spec, self.spec.voxel(flat));
        let points = self.list(flat).map_or(&[][..], |list| &list.points);
        points.iter().map(move |point| point.place_m(&spec, corner))
    }

    fn list(&self, flat: usize) -> Option<&PointList> {
        self.list_of[flat].checked_sub(1).map(|list| &self.lists[list as usize])
    }

    /// Adds the points of a frame: the first in each voxel. `disparities` are those of the left image, row by
    /// row; negative or NaN: no reading.
    pub fn update(&mut self, rig: &StereoRig, map_from_left: &Pose, disparities: &[f32]) {
        let spec = self.spec;
        let rays = self.rays(&spec, rig, map_from_left);
        let mut selection = std::mem::replace(&mut self.selection, PointSelection::new(0));
        let points = selection.select(&rays, disparities, self.settings.min_disparity_px);
        self.evidence.add(&spec, rays.origin, points, &self.settings);
        points.iter().for_each(|point| self.keep(point));
        self.selection = selection;
    }

    /// The rays of a camera. Places are taken from the grid as it lay at first, so that a point on the face of a
    /// voxel falls on the same side of it wherever the grid has moved to.
    fn rays<'a>(&self, spec: &'a GridSpec, rig: &'a StereoRig, map_from_left: &Pose) -> ViewRays<'a> {
        let mut rays = ViewRays::new(spec, rig, map_from_left, f64::INFINITY);
        let origin = self.first.to_cells(map_from_left.translation.vector.into());
        rays.origin = [0, 1, 2].map(|a| origin[a] - self.moved[a] as f64);
        rays.origin_cell = rays.origin.map(cell_index);
        rays
    }

    /// Puts a point into the list of its voxel.
    fn keep(&mut self, point: &RangePoint) {
        let voxel = point.voxel as usize;
        let (spec, corner) = (self.spec, self.spec.voxel(voxel));
        let at = [0, 1, 2].map(|a| (point.at[a] - corner[a] as f64) as f32);
        let limit = self.settings.points_per_voxel;
        let PointList { points, moments } = self.list_for(voxel);
        let place = points.partition_point(|known| known.distance_m <= point.distance_m);
        if place < limit {
            points.truncate(limit - 1);
            points.insert(place, StoredPoint { at, distance_m: point.distance_m });
            *moments = Moments::default();
            points.iter().for_each(|point| moments.add(point.place_m(&spec, corner)));
        }
    }

    /// The list of a voxel, which gets one if it has none.
    fn list_for(&mut self, voxel: usize) -> &mut PointList {
        if self.list_of[voxel] == 0 {
            let list = self.spare.pop().unwrap_or_else(|| {
                self.lists.push(PointList::default());
                (self.lists.len() - 1) as u32
            });
            self.list_of[voxel] = list + 1;
        }
        &mut self.lists[self.list_of[voxel] as usize - 1]
    }

    /// Moves the grid by whole voxels; what it leaves behind is forgotten.
    pub fn scroll(&mut self, voxels: [i64; 3]) {
        if voxels == [0; 3] {
            return;
        }
        self.forget_lists(voxels);
        self.evidence.scroll(&self.spec, voxels);
        scroll(&self.spec, &mut self.list_of, voxels);
        self.moved = [0, 1, 2].map(|a| self.moved[a] + voxels[a]);
        self.spec = self.first.moved(self.moved);
    }

    /// Frees the lists of the voxels that a move of the grid leaves behind.
    fn forget_lists(&mut self, voxels: [i64; 3]) {
        for flat in (0..self.list_of.len()).filter(|&flat| self.list_of[flat] != 0) {
            let cell = self.spec.voxel(flat);
            if self.spec.flat([0, 1, 2].map(|a| cell[a] as i64 - voxels[a])).is_none() {
                let list = self.list_of[flat] - 1;
                let freed = &mut self.lists[list as usize];
                freed.points.clear();
                freed.moments = Moments::default();
                self.spare.push(list);
            }
        }
    }

    /// What a point of an occupied voxel counts for in its plane.
    fn weight(&self, flat: usize) -> f64 {
        if !self.settings.weigh_points {
            return 1.0;
        }
        f64::from(self.evidence()[flat]) / f64::from(self.settings.occupied_at.max(1))
    }

    /// The columns within the planning radius: the height of each, and its points up to that height.
    pub fn columns(&self, robot: &Robot, columns: &mut Columns) {
        let layers = layers_below(&self.spec, robot.floor_m + self.settings.robot_height_m);
        columns.fill(self.spec.plan(), robot.at_m, self.settings.radius_m, |column| {
            let base = column * self.spec.shape()[2];
            let height = (0..layers).rev().find(|&w| self.is_occupied(base + w))?;
            let mut moments = Moments::default();
            for flat in (base..=base + height).filter(|&flat| self.is_occupied(flat)) {
                let own = self.list(flat).map_or_else(Moments::default, |list| list.moments);
                moments.append(&own.weighted(self.weight(flat)));
            }
            Some(Column { height: height as i32, moments })
        });
    }
}

/// How many layers of voxels, from the lowest, have their centre below a height in the map frame.
pub(crate) fn layers_below(spec: &GridSpec, height_m: f64) -> usize {
    let layers = ((height_m - spec.origin_m()[2]) / spec.cell_size_m() - 0.5).ceil();
    (layers.max(0.0) as usize).min(spec.shape()[2])
}

/// The layer that the floor lies in.
pub(crate) fn floor_layer(spec: &GridSpec, floor_m: f64) -> i32 {
    ((floor_m - spec.origin_m()[2]) / spec.cell_size_m() + 1e-6).floor() as i32
}

/// The layer that holds a height in the map frame; `None` outside of the grid.
pub(crate) fn layer_at(spec: &GridSpec, height_m: f64) -> Option<usize> {
    let layer = ((height_m - spec.origin_m()[2]) / spec.cell_size_m()).floor();
    (layer >= 0.0 && layer < spec.shape()[2] as f64).then_some(layer as usize)
}
