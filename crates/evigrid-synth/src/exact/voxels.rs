//! Which voxels the surfaces of a world pass through.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use evigrid_core::Pose;
use evigrid_grid::GridSpec;
use nalgebra::Point3;
use rayon::prelude::*;

use super::air::has_air;
use super::placed::objects;
use super::touch::{Cube, Relation};
use crate::World;
use crate::scene::{Object, Scene};
use crate::thing::Thing;

/// The content of a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VoxelState {
    /// Nothing but air.
    #[default]
    Free,
    /// A surface that can be seen from some place.
    Occupied,
    /// Nothing but the inside of solids.
    Hidden,
}

/// Occupied, free and hidden voxels of a world.
///
/// A voxel is hidden if it is wholly inside the union of all solids, free if it touches none (and no open
/// mesh), and occupied otherwise: the boundary of the union passes through it, so a laser that sees
/// everything would mark it. The interface of two solids that abut is no boundary. A surface exactly on
/// the border of two voxels belongs to the upper one, as `floor` has it: every voxel is taken 1
/// micrometre lower than it lies.
///
/// All is decided by exact tests in double precision, except whether a voxel that several shapes
/// touch and none contains is wholly inside their union; there cracks below a fifth of a millimetre
/// count as closed, and pockets that curved faces or meshes take part in are looked for at
/// 12 x 12 x 12 points of the voxel only.
///
/// A voxel is occupied if it is so in any of the frames; else hidden if it is so in all frames; else free.
#[derive(Debug, Clone)]
pub struct VoxelTruth {
    spec: GridSpec,
    states: Vec<VoxelState>,
}

/// How much lower the voxels are taken, metres.
const SHIFT_M: f64 = 1e-6;

impl VoxelTruth {
    /// The truth for these frames of a world. Without any frame moving things do not count.
    pub fn new(world: &World, spec: GridSpec, map_from_world: &Pose, frames: &[usize]) -> Self {
        let still = Scene::new(objects(world, map_from_world, 0.0, |thing| !thing.moves()));
        let mut states = vec![VoxelState::Free; spec.cell_count()];
        let [_, ny, nz] = spec.shape();
        states.par_chunks_mut(ny * nz).enumerate().for_each(|(i, slab)| {
            let mut near = Vec::new();
            for (j, column) in slab.chunks_mut(nz).enumerate() {
                fill_column(&still, &spec, [i, j], column, &mut near);
            }
        });
        for (flat, tally) in tallies(world, &spec, map_from_world, frames) {
            states[flat] = tally.over(frames.len(), states[flat]);
        }
        Self { spec, states }
    }

    /// The grid's geometry.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// State of the voxel with this flat index; free outside the grid.
    pub fn state(&self, cell: usize) -> VoxelState {
        self.states.get(cell).copied().unwrap_or_default()
    }

    /// States of all voxels, by flat index.
    pub fn states(&self) -> &[VoxelState] {
        &self.states
    }

    /// Indices (i, j, k) of all occupied voxels, sorted.
    pub fn occupied(&self) -> Vec<[i32; 3]> {
        self.voxels(VoxelState::Occupied)
    }

    /// Indices (i, j, k) of all hidden voxels, sorted.
    pub fn hidden(&self) -> Vec<[i32; 3]> {
        self.voxels(VoxelState::Hidden)
    }

    fn voxels(&self, wanted: VoxelState) -> Vec<[i32; 3]> {
        let cells = self.states.iter().enumerate().filter(|&(_, &state)| state == wanted);
        cells.map(|(flat, _)| self.spec.voxel(flat).map(|v| v as i32)).collect()
    }
}

/// The voxel as it is asked about.
fn cube(spec: &GridSpec, voxel: [usize; 3]) -> Cube {
    let (origin, c) = (spec.origin_m(), spec.cell_size_m());
    let centre = std::array::from_fn(|a| origin[a] + (voxel[a] as f64 + 0.5) * c - SHIFT_M);
    Cube { centre: Point3::from(centre), half_m: 0.5 * c }
}

/// The voxels along one axis that may touch something between these coordinates.
fn reached(spec: &GridSpec, axis: usize, low: f64, high: f64) -> RangeInclusive<usize> {
    // Some more than what touches does no harm.
    const SLACK: f64 = 1e-6;
    let in_cells = |v: f64| (v + SHIFT_M - spec.origin_m()[axis]) / spec.cell_size_m();
    let first = (in_cells(low) - 1.0 - SLACK).ceil().max(0.0);
    let last = (in_cells(high) + SLACK).floor().min(spec.shape()[axis] as f64 - 1.0);
    if first > last {
        return RangeInclusive::new(1, 0);
    }
    first as usize..=last as usize
}

fn fill_column(
    scene: &Scene,
    spec: &GridSpec,
    [i, j]: [usize; 2],
    column: &mut [VoxelState],
    near: &mut Vec<usize>,
) {
    let [low, _] = cube(spec, [i, j, 0]).bounds();
    let [_, high] = cube(spec, [i, j, column.len() - 1]).bounds();
    scene.near(&low, &high, near);
    let reach = |&index: &usize| {
        let object = scene.object(index);
        let [low, high] = object.bounds();
        (object, reached(spec, 2, low.z, high.z))
    };
    let near: Vec<(&Object, RangeInclusive<usize>)> = near.iter().map(reach).collect();
    for (k, state) in column.iter_mut().enumerate() {
        let here = near.iter().filter(|(_, range)| range.contains(&k)).map(|(object, _)| *object);
        *state = classify(&cube(spec, [i, j, k]), here);
    }
}

/// The content of a cube, given all objects that may touch it.
fn classify<'a>(cube: &Cube, objects: impl Iterator<Item = &'a Object>) -> VoxelState {
    let mut cutting: Vec<&Object> = Vec::new();
    for object in objects {
        match cube.relation(object) {
            Relation::Apart => {}
            Relation::Cut => cutting.push(object),
            Relation::Inside => return VoxelState::Hidden,
        }
    }
    let has_surface = match cutting[..] {
        [] => return VoxelState::Free,
        [_] => true,
        _ => has_air(cube, &cutting),
    };
    if has_surface { VoxelState::Occupied } else { VoxelState::Hidden }
}

/// States of a voxel in the frames in which a moving thing came near.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    frames: usize,
    hidden: usize,
    is_occupied: bool,
}

impl Tally {
    fn add(&mut self, state: VoxelState) {
        self.frames += 1;
        self.hidden += usize::from(state == VoxelState::Hidden);
        self.is_occupied |= state == VoxelState::Occupied;
    }

    /// The state over all frames, given the state without anything that moves.
    fn over(mut self, frames: usize, still: VoxelState) -> VoxelState {
        let others = frames - self.frames;
        if others > 0 {
            self.add(still);
        }
        if self.is_occupied {
            VoxelState::Occupied
        } else if self.hidden == self.frames {
            VoxelState::Hidden
        } else {
            VoxelState::Free
        }
    }
}

/// The voxels that moving things come near to, by flat index.
fn tallies(
    world: &World,
    spec: &GridSpec,
    map_from_world: &Pose,
    frames: &[usize],
) -> BTreeMap<usize, Tally> {
    let mut tallies: BTreeMap<usize, Tally> = BTreeMap::new();
    if !world.contents.things.iter().any(Thing::moves) {
        return tallies;
    }
    for &frame in frames {
        let time_s = world.time_s(frame);
        let scene = Scene::new(objects(world, map_from_world, time_s, |_| true));
        let moving = scene.objects().iter().filter(|object| world.contents.things[object.thing].moves());
        let mut cells: Vec<usize> = moving.flat_map(|object| cells_near(spec, object)).collect();
        cells.sort_unstable();
        cells.dedup();
        let state = |&flat: &usize| (flat, state_in(&scene, spec, flat));
        let states: Vec<(usize, VoxelState)> = cells.par_iter().map(state).collect();
        for (flat, state) in states {
            tallies.entry(flat).or_default().add(state);
        }
    }
    tallies
}

fn cells_near(spec: &GridSpec, object: &Object) -> Vec<usize> {
    let [low, high] = object.bounds();
    let [is, js, ks] = [0, 1, 2].map(|a| reached(spec, a, low[a], high[a]));
    let strides = spec.strides();
    let row = |i: usize, j: usize| ks.clone().map(move |k| i * strides[0] + j * strides[1] + k);
    is.flat_map(|i| js.clone().flat_map(move |j| row(i, j))).collect()
}

fn state_in(scene: &Scene, spec: &GridSpec, flat: usize) -> VoxelState {
    let cube = cube(spec, spec.voxel(flat));
    let [low, high] = cube.bounds();
    let mut near = Vec::new();
    scene.near(&low, &high, &mut near);
    classify(&cube, near.into_iter().map(|index| scene.object(index)))
}

#[cfg(test)]
#[path = "voxels_tests.rs"]
mod tests;
