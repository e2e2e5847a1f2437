//! The seven bars of the world `bars`, where they stand in a grid, and what else is there.

use anyhow::Result;
use evigrid_core::Pose;
use evigrid_grid::{GridSettings, GridSpec};
use evigrid_replay::map_from_world;
use evigrid_synth::{VoxelState, VoxelTruth, World};
use nalgebra::Point3;

pub const WORLD: &str = "bars";
/// Places of the bars along y in the world's frame, radius and height, metres (datasets/synth/bars.toml).
pub const BARS_Y_M: [f64; 7] = [-0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6];
pub const RADIUS_M: f64 = 0.02;
const HEIGHT_M: f64 = 2.0;
/// The lowest part of a bar shares its cells with the floor and does not count, metres.
pub const FOOT_M: f64 = 0.15;
/// The region around the bars, which is what the paper's pictures show: |x| and |y| up to this, metres.
const AROUND_M: [f64; 2] = [1.0, 1.1];

/// A grid over the world with its exact truth.
pub struct Bars {
    pub spec: GridSpec,
    pub truth: VoxelTruth,
    /// The cells of each bar, level by level.
    pub cells: Vec<Vec<Vec<usize>>>,
    world_from_map: Pose,
}

/// The grid in the map frame of frame 0, which looks at the bars from 3.2 m away: the bars, the wall behind
/// them and what lies before and behind.
pub fn grid(cell_size_m: f64) -> GridSettings {
    GridSettings { x_m: [0.0, 8.0], y_m: [-4.0, 4.0], z_m: [-1.2, 1.4], cell_size_m }
}

/// The grid around the bars as settings.
pub fn grid_sets(cell_size_m: f64) -> Vec<String> {
    let GridSettings { x_m, y_m, z_m, .. } = grid(cell_size_m);
    vec![
        format!("grid.x_m={x_m:?}"),
        format!("grid.y_m={y_m:?}"),
        format!("grid.z_m={z_m:?}"),
        format!("grid.cell_size_m={cell_size_m}"),
    ]
}

impl Bars {
    pub fn new(cell_size_m: f64) -> Result<Self> {
        let world = World::builtin(WORLD)?;
        let map_from_world = map_from_world(&world.true_world_from_left(0));
        let spec = GridSpec::new(&grid(cell_size_m))?;
        let truth = VoxelTruth::new(&world, spec, &map_from_world, &[]);
        let cells = BARS_Y_M.iter().map(|&y_m| bar_cells(&spec, &map_from_world, y_m)).collect();
        Ok(Self { spec, truth, cells, world_from_map: map_from_world.inverse() })
    }

    /// Centre of a cell in the world's frame, metres.
    pub fn in_world(&self, cell: usize) -> Point3<f64> {
        self.world_from_map * Point3::from(self.spec.centre_m(cell))
    }

    /// The corners of a cell's column in the world's frame, as (x, y).
    pub fn footprint(&self, cell: usize) -> [[f64; 2]; 4] {
        let (centre, half) = (self.spec.centre_m(cell), 0.5 * self.spec.cell_size_m());
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[i, j]| {
            let corner = Point3::new(centre[0] + i * half, centre[1] + j * half, centre[2]);
            let corner = self.world_from_map * corner;
            [corner.x, corner.y]
        })
    }

    /// Whether a cell is one of the region around the bars, above the floor.
    pub fn is_around(&self, cell: usize) -> bool {
        let place = self.in_world(cell);
        place.x.abs() <= AROUND_M[0] && place.y.abs() <= AROUND_M[1] && place.z >= FOOT_M
    }

    /// Whether nothing but air is within so many cells of a cell, along all three axes.
    pub fn is_far_from_surfaces(&self, cell: usize, cells: i64) -> bool {
        let at = self.spec.voxel(cell).map(|v| v as i64);
        let reach = || -cells..=cells;
        let mut near = reach().flat_map(|i| reach().flat_map(move |j| reach().map(move |k| [i, j, k])));
        near.all(|step| {
            let neighbour = self.spec.flat(std::array::from_fn(|a| at[a] + step[a]));
            neighbour.is_none_or(|flat| self.truth.state(flat) == VoxelState::Free)
        })
    }
}

/// The cells that a bar passes through, level by level from the foot on.
fn bar_cells(spec: &GridSpec, map_from_world: &Pose, y_m: f64) -> Vec<Vec<usize>> {
    let c = spec.cell_size_m();
    let axis = map_from_world * Point3::new(0.0, y_m, 0.0);
    let [low, high] = [axis.z + FOOT_M, axis.z + HEIGHT_M].map(|z| (z - spec.origin_m()[2]) / c);
    let at = spec.to_cells([axis.x, axis.y, axis.z]);
    let reach = (RADIUS_M / c).ceil() as i64;
    // Distance from the axis to the nearest place of the cell, in cells.
    let gap = |axis: f64, cell: i64| (cell as f64 - axis).max(axis - (cell + 1) as f64).max(0.0);
    let columns = |k: i64| {
        let near = |a: usize| (at[a].floor() as i64 - reach)..=(at[a].floor() as i64 + reach);
        let pairs = near(0).flat_map(move |i| near(1).map(move |j| (i, j)));
        let touched = pairs.filter(|&(i, j)| gap(at[0], i).hypot(gap(at[1], j)) <= RADIUS_M / c);
        touched.filter_map(|(i, j)| spec.flat([i, j, k])).collect::<Vec<_>>()
    };
    // Levels that lie wholly between foot and top.
    let levels = low.ceil() as i64..(high + 1e-9).floor() as i64;
    levels.map(columns).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_of_a_bar_is_occupied_in_truth_and_none_is_left_out() {
        let bars = Bars::new(0.1).unwrap();
        let mut cells: Vec<usize> = bars.cells.iter().flatten().flatten().copied().collect();
        assert!(cells.iter().all(|&cell| bars.truth.state(cell) == VoxelState::Occupied));
        assert!(bars.cells.iter().all(|bar| bar.len() >= 17 && bar.iter().all(|level| !level.is_empty())));
        cells.sort_unstable();
        // All occupied cells around the bars, at the levels that count, are theirs.
        let levels: std::collections::BTreeSet<usize> =
            cells.iter().map(|c| bars.spec.voxel(*c)[2]).collect();
        let all = (0..bars.spec.cell_count()).filter(|&cell| {
            bars.is_around(cell)
                && levels.contains(&bars.spec.voxel(cell)[2])
                && bars.truth.state(cell) == VoxelState::Occupied
        });
        assert_eq!(all.collect::<Vec<_>>(), cells);
    }
}
