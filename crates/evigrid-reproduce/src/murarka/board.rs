//! How much of a board is in the occupancy grid (section VII-B).
//!
//! The paper counts a board as detected when N % of its width "is visible in the occupancy grid". Here a part of
//! the width is in the grid if it lies in a row of voxels, seen along the way, that holds an occupied voxel
//! - no more than one voxel before or behind the board's face,
//! - wholly above the floor's layer, and not above the board.
//!
//! The labels of the safety map play no part: they end at the planning radius of 4 m.

use evigrid_grid::GridSpec;
use evigrid_synth::{LeftViewTruth, Track, World, boards};

/// The face of a board that stands across the x axis of the map frame, towards the robot, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    pub x_m: f64,
    pub y_m: [f64; 2],
    pub z_m: [f64; 2],
}

/// A fraction of a voxel that rounding may take.
const ROUNDING: f64 = 1e-6;

impl Face {
    /// The face of a thing that the robot drives towards along x.
    pub fn of(thing: &Track) -> Self {
        let (centre, half) = (thing.centre_m, thing.lengths_m * 0.5);
        let around = |centre: f64, half: f64| [centre - half, centre + half];
        Self { x_m: centre.x - half.x, y_m: around(centre.y, half.y), z_m: around(centre.z, half.z) }
    }

    /// The share of the width that is in the grid; see the module.
    pub fn share_found(&self, spec: &GridSpec, is_occupied: impl Fn(usize) -> bool) -> f64 {
        let ([nx, ny, nz], [x0, y0, z0], c) = (spec.shape(), spec.origin_m(), spec.cell_size_m());
        let low = |origin: f64, n: usize| origin + n as f64 * c;
        let gap = |i: usize| (low(x0, i) - self.x_m).max(self.x_m - low(x0, i + 1)).max(0.0);
        let is_near = |i: &usize| gap(*i) <= c * (1.0 + ROUNDING);
        let is_at_height = |k: &usize| {
            let from = low(z0, *k);
            from >= self.z_m[0] - c * ROUNDING && from < self.z_m[1] - c * ROUNDING
        };
        let depths: Vec<usize> = (0..nx).filter(is_near).collect();
        let heights: Vec<usize> = (0..nz).filter(is_at_height).collect();
        let is_found =
            |j: usize| depths.iter().any(|i| heights.iter().any(|k| is_occupied((i * ny + j) * nz + k)));
        let part = |j: usize| low(y0, j + 1).min(self.y_m[1]) - low(y0, j).max(self.y_m[0]);
        let found: f64 = (0..ny).filter(|&j| part(j) > 0.0 && is_found(j)).map(part).sum();
        found / (self.y_m[1] - self.y_m[0])
    }
}

/// A board while the robot drives towards it.
#[derive(Debug, Clone, Copy)]
pub struct Visit {
    pub face: Face,
    /// The first and the last frame whose left image shows the board.
    pub first: usize,
    pub last: usize,
}

/// All boards of a world, those that are seen first coming first. `things` are the world's named things.
pub fn visits(world: &World, things: &[Track]) -> Vec<Visit> {
    let mut visits: Vec<(usize, Visit)> = Vec::new();
    for frame in 0..world.frame_count() {
        let seen = boards(world, frame, &LeftViewTruth::new(world, frame));
        for board in seen.iter().filter(|board| board.visible_left_m > 0.0) {
            if let Some((_, visit)) = visits.iter_mut().find(|(thing, _)| *thing == board.thing) {
                visit.last = frame;
            } else if let Some(track) = things.iter().find(|track| track.thing == board.thing) {
                visits.push((board.thing, Visit { face: Face::of(track), first: frame, last: frame }));
            }
        }
    }
    visits.into_iter().map(|(_, visit)| visit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::GridSettings;

    /// Voxels of 0.5 m; the floor lies in the middle of the lowest layer, at the height 0.25.
    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 4.0], y_m: [0.0, 3.0], z_m: [0.0, 2.0], cell_size_m: 0.5 };
        GridSpec::new(&settings).unwrap()
    }

    /// A board 1.25 m wide and as high as the layers 1 and 2, within the third voxel along x.
    const FACE: Face = Face { x_m: 1.25, y_m: [0.75, 2.0], z_m: [0.25, 1.5] };

    fn share(occupied: &[[i64; 3]]) -> f64 {
        let flat: Vec<usize> = occupied.iter().map(|&voxel| spec().flat(voxel).unwrap()).collect();
        FACE.share_found(&spec(), |voxel| flat.contains(&voxel))
    }

    #[test]
    fn parts_of_the_width_count_by_their_length_and_once() {
        // The row from y = 0.5 to 1 holds 0.25 m of the board, the next ones 0.5 m each.
        assert_eq!(share(&[[2, 1, 1]]), 0.25 / 1.25);
        assert_eq!(share(&[[2, 1, 1], [2, 2, 2], [1, 2, 1]]), 0.75 / 1.25);
        assert_eq!(share(&[[2, 1, 1], [2, 2, 1], [2, 3, 1]]), 1.0);
    }

    #[test]
    fn floor_air_above_the_board_neighbours_and_far_voxels_do_not_count() {
        for other in [[2, 1, 0], [2, 1, 3], [2, 0, 1], [2, 4, 1], [0, 2, 1], [4, 2, 1]] {
            assert_eq!(share(&[other]), 0.0, "{other:?}");
        }
        for own in [[1, 2, 1], [3, 2, 2]] {
            assert_eq!(share(&[own]), 0.4, "{own:?}");
        }
    }

    #[test]
    fn a_face_between_two_voxels_has_two_on_either_side() {
        let face = Face { x_m: 1.5, ..FACE };
        let share = |i: i64| face.share_found(&spec(), |flat| Some(flat) == spec().flat([i, 2, 1]));
        assert_eq!([0, 1, 2, 3, 4, 5].map(share), [0.0, 0.4, 0.4, 0.4, 0.4, 0.0]);
    }
}
